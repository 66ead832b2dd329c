//! A car that moves, turns or is parked: no trail, and its shape.

use std::collections::BTreeSet;

use occlabel_core::{OccupancyLabels, PointLabel, Pose};
use occlabel_pipeline::Rules;
use occlabel_testkit::assert_golden;

use crate::scenes::{
    Body, CAR, Stage, UNOBSERVED, directions, look, same_but_flow, small, upright,
};
use crate::{above, beside, instances_above_ground, picture, road_with};

const SEEN_CAR: PointLabel = PointLabel::Class(CAR);
const CAR_HALF_M: [f64; 3] = [2.1, 0.95, 0.5];
/// Ten sweeps a second, half a second to both sides.
const SWEEPS_S: [f64; 11] = [-0.5, -0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
/// Two annotations a second.
const ANNOTATED_S: [f64; 3] = [-0.5, 0.0, 0.5];

/// A car whose floor is 5 cm above the road: less than boxes grow, but not downwards.
fn car_at(x_m: f64, y_m: f64, yaw_rad: f64) -> Body {
    let place = upright([x_m, y_m, 0.05 + CAR_HALF_M[2]], yaw_rad);
    Body::new(CAR, place, CAR_HALF_M.into()).tracked(1)
}

fn ego_at(time: f64) -> Pose {
    upright([2.0 * time, 0.0, 0.0], 0.1 * time)
}

fn drive_by<'a>(world: &'a dyn Fn(f64) -> Vec<Body>) -> Stage<'a> {
    Stage {
        world,
        map_from_ego: &ego_at,
        sweeps_s: &SWEEPS_S,
        annotated_s: &[&ANNOTATED_S],
        step_deg: 1.5,
    }
}

#[test]
fn a_car_at_constant_speed_leaves_no_trail_and_keeps_its_shape() {
    let world = |time: f64| road_with(&[car_at(5.0 + 4.0 * time, 1.9, 0.0)]);
    let labels = moving_car_is_sharp(&drive_by(&world));
    let title = "A car at 4 m/s, in 11 sweeps over a second; the ego drives 2 m/s and turns.";
    let views = [above(&labels, 2), above(&labels, 3), beside(&labels, 11)];
    assert_golden("geometry/car.txt", &picture(title, &views));
}

#[test]
fn a_turning_car_leaves_no_trail_and_keeps_its_shape() {
    let world =
        |time: f64| road_with(&[car_at(5.5 + 3.0 * time, 0.4 + 2.0 * time, 0.5 + 0.9 * time)]);
    let labels = moving_car_is_sharp(&drive_by(&world));
    let title = "A car at 3.6 m/s that turns with 0.9 rad/s, in 11 sweeps over a second.";
    let views = [above(&labels, 2), above(&labels, 3)];
    assert_golden("geometry/turning-car.txt", &picture(title, &views));
}

/// Labels a stage at time 0 and judges its one car.
#[track_caller]
fn moving_car_is_sharp(stage: &Stage) -> OccupancyLabels {
    let rules = small(&[]);
    let drive = stage.drive(&[0.0]);
    let labels = drive.label(&rules);
    let occupied = stage.check_no_trail(&labels, &rules, 0.0);
    let passed = stage.free_on_the_way(&labels, &rules, 0.0);
    let boxed: usize =
        drive.aggregate(&rules, |_| true).objects.iter().map(|o| o.cloud.len()).sum();
    let of_car =
        drive.clouds.iter().flat_map(|cloud| &cloud.labels).filter(|label| **label == SEEN_CAR);
    assert_eq!(boxed, of_car.count(), "the box holds the car's points and none of the road's");
    let shape = voxels_of_car(stage, &rules);
    assert_eq!(
        instances_above_ground(&labels, 1),
        shape,
        "the car's surface, as all sweeps saw it"
    );
    let inside = interior(stage, &rules);
    let crossed = |labels: &OccupancyLabels| {
        inside.iter().filter(|&&voxel| *labels.evidence().state.at(voxel) != UNOBSERVED).count()
    };
    assert_eq!(crossed(&labels), 0, "nobody looked into the car");
    let other_air = drive.label(&small(&["raycast.same_time_s=10"]));
    assert!(crossed(&other_air) > inside.len() / 2, "other sweeps looked through where it is now");
    let sizes = (occupied, passed, shape.len(), inside.len());
    assert!(occupied > 300 && passed > 30 && shape.len() > 40 && inside.len() > 10, "{sizes:?}");
    labels
}

/// Voxels above the ground's layer that hold what the sweeps saw of the car, moved to where it
/// stands at time 0.
fn voxels_of_car(stage: &Stage, rules: &Rules) -> BTreeSet<[usize; 3]> {
    let car = |time: f64| (stage.world)(time).pop().expect("the car comes last");
    let mut voxels = BTreeSet::new();
    for &time in stage.sweeps_s {
        let map_from_lidar = stage.map_from_lidar(time);
        let now_from_lidar =
            car(0.0).map_from_body * car(time).map_from_body.inverse() * map_from_lidar;
        let cloud = look(&(stage.world)(time), &map_from_lidar, &directions(stage.step_deg));
        let seen = cloud.positions.iter().zip(&cloud.labels);
        for (p, _) in seen.filter(|(_, label)| **label == SEEN_CAR) {
            let flat = rules.spec.flat_of(&(now_from_lidar * p));
            voxels.extend(flat.map(|flat| rules.spec.voxel_at(flat).0.map(|i| i as usize)));
        }
    }
    voxels.retain(|voxel| voxel[2] >= 2);
    voxels
}

/// Voxels that lie wholly inside the car at time 0.
fn interior(stage: &Stage, rules: &Rules) -> Vec<[usize; 3]> {
    let car = (stage.world)(0.0).pop().expect("the car comes last").grown(-0.002);
    let voxels = stage.voxels(rules, 0.0).into_iter();
    let inside =
        voxels.filter(|(_, voxel)| voxel.corners().iter().all(|corner| car.contains(corner)));
    inside.map(|(voxel, _)| voxel).collect()
}

#[test]
fn a_parked_car_is_a_car_of_speed_zero() {
    let world = |_| road_with(&[car_at(5.0, 1.9, 0.2)]);
    let rules = small(&["boxes.extrapolate_s=1.0"]);
    let drive_annotated_at =
        |annotated_s: &[&[f64]]| (Stage { annotated_s, ..drive_by(&world) }).drive(&[0.0]);
    let annotated_at = |times: &[f64]| drive_annotated_at(&[times]).label(&rules);
    let parked = annotated_at(&ANNOTATED_S);
    same_but_flow(&annotated_at(&SWEEPS_S), &parked, "annotated in every sweep");
    let is_still = |v: &[f32; 3]| v.iter().all(|c| c.abs() < 1e-6);
    assert!(parked.evidence().flow.values().iter().all(is_still));

    let lone = annotated_at(&[0.0]);
    same_but_flow(&lone, &parked, "one annotation is held still");
    assert!(lone.evidence().flow.values().iter().any(|v| v[0].is_nan()), "but tells no velocity");

    let any_time = small(&["raycast.same_time_s=10"]);
    let house = drive_annotated_at(&[]).label(&any_time);
    let parked_any_time = drive_annotated_at(&[&ANNOTATED_S]).label(&any_time);
    assert!(house.evidence().hits == parked.evidence().hits, "hits, as if it were a house");
    assert!(house.semantics == parked.semantics, "classes, as if it were a house");
    assert!(
        house.evidence().state == parked_any_time.evidence().state,
        "states, as if it were a house"
    );
    let shape = instances_above_ground(&parked, 1).len();
    assert!(shape > 30, "{shape} voxels");
}
