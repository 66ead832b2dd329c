//! Scenes whose answer is geometry: a wall's shadow, a pillar's wedge, a car that leaves no trail.
//!
//! A lidar without noise looks at a known world of boxes; the whole pipeline labels what it saw. The
//! labels are judged twice: by sight lines in that world, which know no grid, and by pictures in
//! `tests/fixtures/goldens/geometry`, in which a change can be seen.

mod scenes;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};
use occlabel_core::{OccupancyLabels, PointLabel, Pose};
use occlabel_pipeline::Rules;
use occlabel_testkit::assert_golden;
use scenes::{
    Body, CAR, Drive, LEGEND, MANMADE, PEDESTRIAN, Stage, TERRAIN, UNOBSERVED, camera, class_at,
    directions, from_above, from_the_left, look, looking_ahead, road_in_a_hall, same_but_flow,
    slab, small, upright, world_from_map,
};

const SHAPE: [usize; 3] = [24, 16, 6];
const STILL: &dyn Fn(f64) -> Pose = &|_| Pose::identity();
/// Where the lidar stands over the ego, x and y.
const LIDAR_XY: [f64; 2] = [0.11, 0.13];

/// The world of a road with more in it.
fn road_with(bodies: &[Body]) -> Vec<Body> {
    [road_in_a_hall(), bodies.to_vec()].concat()
}

fn picture(title: &str, views: &[String]) -> String {
    format!("{title}\n{LEGEND}{}", views.concat())
}

fn above(labels: &OccupancyLabels, z: usize) -> String {
    from_above(SHAPE, z, |voxel| class_at(labels, voxel))
}

fn beside(labels: &OccupancyLabels, y: usize) -> String {
    from_the_left(SHAPE, y, |voxel| class_at(labels, voxel))
}

/// Lower and upper corner of a voxel of the small grid in x and y, metres.
fn corners_xy(x: usize, y: usize) -> [[f64; 2]; 4] {
    let (x, y) = (x as f64 * 0.5 - 2.0, y as f64 * 0.5 - 4.0);
    [[x, y], [x + 0.5, y], [x, y + 0.5], [x + 0.5, y + 0.5]]
}

// ---- What stands still -------------------------------------------------------------------------

#[test]
fn a_wall_throws_a_shadow() {
    let wall = slab(MANMADE, [5.1, -1.3, 0.0], [5.4, 1.3, 4.0]);
    let world = |_| road_with(std::slice::from_ref(&wall));
    let stage = Stage {
        world: &world,
        map_from_ego: STILL,
        sweeps_s: &[0.0],
        annotated_s: &[],
        step_deg: 0.5,
    };
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let [dark, lit, occupied] = stage.check_still(&labels, &rules);
    assert!(
        dark > 500 && lit > 900 && occupied > 300,
        "{dark} dark, {lit} lit, {occupied} occupied"
    );
    shadow_is_the_wedge(&labels, |[x, y]| {
        let reach = (x - LIDAR_XY[0]) / (5.1 - LIDAR_XY[0]);
        let aside = y - LIDAR_XY[1];
        x > 5.4 && (-1.3 - LIDAR_XY[1]) * reach < aside && aside < (1.3 - LIDAR_XY[1]) * reach
    });
    let views = [above(&labels, 3), beside(&labels, 8)];
    assert_golden("geometry/wall.txt", &picture("A wall and its shadow.", &views));
}

/// Columns within the wedge are unobserved in the layers above the ground, columns without are not.
#[track_caller]
fn shadow_is_the_wedge(labels: &OccupancyLabels, is_dark: impl Fn([f64; 2]) -> bool) {
    let (mut within, mut without) = (0, 0);
    for (x, y, z) in voxels_above_ground() {
        let dark = corners_xy(x, y).into_iter().filter(|&corner| is_dark(corner)).count();
        let state = *labels.evidence.state.at([x, y, z]);
        assert!(dark < 4 || state == UNOBSERVED, "{:?} is dark, found {state}", [x, y, z]);
        assert!(dark > 0 || state != UNOBSERVED, "{:?} is lit", [x, y, z]);
        within += usize::from(dark == 4);
        without += usize::from(dark == 0);
    }
    assert!(within > 50 && without > 500, "{within} within the wedge, {without} without");
}

fn voxels_above_ground() -> impl Iterator<Item = (usize, usize, usize)> {
    let [nx, ny, nz] = SHAPE;
    (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (2..nz).map(move |z| (x, y, z))))
}

#[test]
fn a_pillar_throws_a_wedge_and_of_two_the_common_part_stays_dark() {
    let pillar = slab(MANMADE, [4.1, -0.9, 0.0], [4.9, -0.1, 5.0]);
    let world = |_| road_with(std::slice::from_ref(&pillar));
    let aside = |time: f64| upright([0.0, 3.0 * time, 0.0], 0.4 * time);
    let rules = small(&[]);
    let seen_from = |sweeps_s: &[f64]| {
        let stage = Stage {
            world: &world,
            map_from_ego: &aside,
            sweeps_s,
            annotated_s: &[],
            step_deg: 1.5,
        };
        let labels = stage.drive(&[0.0]).label(&rules);
        let [dark, lit, occupied] = stage.check_still(&labels, &rules);
        assert!(dark > 350 && lit > 1300 && occupied > 300, "{dark}, {lit}, {occupied}");
        labels
    };
    let (one, two) = (seen_from(&[0.0]), seen_from(&[0.0, 0.5]));
    let wedge = |labels: &OccupancyLabels| {
        voxels_above_ground()
            .filter(|&(x, y, z)| *labels.evidence.state.at([x, y, z]) == UNOBSERVED)
            .count()
    };
    assert!(wedge(&two) < wedge(&one) / 2 && wedge(&two) > 0, "{} of {}", wedge(&two), wedge(&one));
    let views = [above(&one, 3), above(&two, 3)];
    let title = "A pillar and its wedge, seen from one place, then from two (1.5 m to the left).";
    assert_golden("geometry/pillar.txt", &picture(title, &views));
}

#[test]
fn a_tunnel_hides_all_but_what_its_end_lets_through() {
    let shell = [
        slab(MANMADE, [-20.0, 2.1, 0.0], [5.6, 2.4, 2.2]),
        slab(MANMADE, [-20.0, -2.4, 0.0], [5.6, -2.1, 2.2]),
        slab(MANMADE, [-20.0, -2.4, 1.9], [5.6, 2.4, 2.2]),
    ];
    let world = |_| road_with(&shell);
    let stage = Stage {
        world: &world,
        map_from_ego: STILL,
        sweeps_s: &[0.0],
        annotated_s: &[],
        step_deg: 0.5,
    };
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let [dark, lit, occupied] = stage.check_still(&labels, &rules);
    assert!(dark > 900 && lit > 500 && occupied > 300, "{dark}, {lit}, {occupied}");
    let outside = (0..15).flat_map(|x| [0, 1, 2, 13, 14, 15].map(|y| [x, y]));
    let seen = outside.flat_map(|[x, y]| (0..6).map(move |z| [x, y, z]));
    assert_eq!(
        seen.filter(|&voxel| class_at(&labels, voxel) != '?').count(),
        0,
        "through the walls"
    );
    let views = [above(&labels, 3), beside(&labels, 8)];
    assert_golden("geometry/tunnel.txt", &picture("A tunnel with its end 5.6 m ahead.", &views));
}

#[test]
fn ground_on_two_levels_is_ground_on_both() {
    let quay = slab(TERRAIN, [4.3, -30.0, -1.0], [30.0, 30.0, 1.0]);
    let world = |_| road_with(std::slice::from_ref(&quay));
    let stage = Stage {
        world: &world,
        map_from_ego: STILL,
        sweeps_s: &[0.0],
        annotated_s: &[],
        step_deg: 0.5,
    };
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let [dark, lit, occupied] = stage.check_still(&labels, &rules);
    assert!(dark > 700 && lit > 1000 && occupied > 300, "{dark}, {lit}, {occupied}");
    let mut grounded = 0;
    for (x, y) in (0..24).flat_map(|x| (0..16).map(move |y| (x, y))) {
        let column: String = (0..6).map(|z| class_at(&labels, [x, y, z])).collect();
        let expected = match x {
            0..12 => "?=....",
            12 => "?*--..",
            _ => "???-..",
        };
        // Far away, rays are too few to hit every voxel of the ground.
        let fits =
            |(found, expected): (char, char)| expected == '*' || found == expected || found == '.';
        assert!(column.chars().zip(expected.chars()).all(fits), "column ({x}, {y}): {column}");
        grounded += usize::from(column.contains(['=', '-']));
    }
    assert!(grounded > 300, "ground in {grounded} of 384 columns");
    let views = [beside(&labels, 8), above(&labels, 2)];
    assert_golden("geometry/two-levels.txt", &picture("A road, and ground 1 m above it.", &views));
}

#[test]
fn section_10_a_camera_sees_over_a_wall_what_is_not_right_behind_it() {
    let wall = slab(MANMADE, [4.1, -30.0, 0.0], [4.4, 30.0, 1.1]);
    let world = |_| road_with(std::slice::from_ref(&wall));
    let ahead = |time: f64| upright([18.0 * time, 0.0, 0.0], 0.0);
    let stage = Stage {
        world: &world,
        map_from_ego: &ahead,
        sweeps_s: &[0.0, 0.5],
        annotated_s: &[],
        step_deg: 0.5,
    };
    let rules = small(&[]);
    let eye = Point3::new(0.2, 0.1, 1.7);
    let labels = with_camera(stage.drive(&[]), &eye).label(&rules);

    stage.check_still(&labels, &rules);
    let (mut hidden, mut seen) = (0, 0);
    for (x, y, z) in voxels_above_ground().filter(|&(x, _, _)| x >= 13) {
        let corners = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5], [0.25, 0.25]];
        let height = |[dx, dz]: [f64; 2]| {
            let (x_m, z_m) = (x as f64 * 0.5 - 2.0 + dx, z as f64 * 0.5 - 0.75 + dz);
            eye.z + (z_m - eye.z) * (4.5 - eye.x) / (x_m - eye.x)
        };
        let is_seen = *labels.mask_camera.at([x, y, z]) == 1;
        let is_ahead = (y as f64 * 0.5 - 3.75 - eye.y).abs() < x as f64 * 0.5 - 2.0 - eye.x;
        // The wall fills its voxels: 1.25 m high, its back at 4.5 m.
        if corners.map(height).iter().all(|&height| height < 1.249) {
            assert!(!is_seen, "{:?} is hidden", [x, y, z]);
            hidden += 1;
        } else if is_ahead && height(corners[4]) > 1.251 {
            assert!(is_seen, "{:?} is in view", [x, y, z]);
            seen += 1;
        }
        assert_eq!(*labels.mask_lidar.at([x, y, z]), 1, "the lidar was on both sides");
    }
    assert!(hidden > 100 && seen > 300, "{hidden} hidden, {seen} seen");
    let view = from_the_left(SHAPE, 8, |voxel| {
        let is_seen = *labels.mask_camera.at(voxel) == 1;
        if is_seen || class_at(&labels, voxel) == '?' { class_at(&labels, voxel) } else { 'x' }
    });
    let title =
        "A camera 1.7 m up at voxel (4, 8, 4) looks over a wall. x observed, but not seen by it.";
    assert_golden("geometry/camera-over-wall.txt", &picture(title, &[view]));
}

/// The drive with a camera that looks ahead from a place in the grid of its first sweep.
fn with_camera(mut drive: Drive, eye: &Point3<f64>) -> Drive {
    drive.scene.cameras.push(camera("FRONT", 400, 60_f64.to_radians()));
    let grid_from_frame = upright((*eye).into(), 0.0);
    drive.add_keyframe(0, &[world_from_map() * looking_ahead(&grid_from_frame)]);
    drive
}

// ---- What moves --------------------------------------------------------------------------------

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
        inside.iter().filter(|&&voxel| *labels.evidence.state.at(voxel) != UNOBSERVED).count()
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

fn instances_above_ground(labels: &OccupancyLabels, track: u16) -> BTreeSet<[usize; 3]> {
    let all = voxels_above_ground().map(|(x, y, z)| [x, y, z]);
    all.filter(|&voxel| *labels.evidence.instances.at(voxel) == track).collect()
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
    assert!(parked.evidence.flow.values().iter().all(is_still));

    let lone = annotated_at(&[0.0]);
    same_but_flow(&lone, &parked, "one annotation is held still");
    assert!(lone.evidence.flow.values().iter().any(|v| v[0].is_nan()), "but tells no velocity");

    let any_time = small(&["raycast.same_time_s=10"]);
    let house = drive_annotated_at(&[]).label(&any_time);
    let parked_any_time = drive_annotated_at(&[&ANNOTATED_S]).label(&any_time);
    assert!(house.evidence.hits == parked.evidence.hits, "hits, as if it were a house");
    assert!(house.semantics == parked.semantics, "classes, as if it were a house");
    assert!(
        house.evidence.state == parked_any_time.evidence.state,
        "states, as if it were a house"
    );
    let shape = instances_above_ground(&parked, 1).len();
    assert!(shape > 30, "{shape} voxels");
}

#[test]
fn section_3_a_track_that_comes_and_goes_stands_only_between_its_annotations() {
    let body = |time: f64| {
        let place = upright([2.5 + time, 1.9, 0.85], 0.0);
        Body::new(CAR, place, [1.0, 0.75, 0.65].into()).tracked(1)
    };
    let world = |time: f64| road_with(&[body(time)]);
    let stage = Stage {
        world: &world,
        map_from_ego: STILL,
        sweeps_s: &[0.2, 0.5, 1.0, 1.25, 1.5, 2.4, 4.0, 4.5, 5.0, 5.2],
        annotated_s: &[&[1.0, 1.5, 4.0, 4.5]],
        step_deg: 2.0,
    };
    let (absent_s, keyframes_s) = ([0.2, 2.4, 5.2], [0.5, 1.25, 2.4, 4.0, 5.0]);
    let drive = stage.drive(&keyframes_s);

    let rules = small(&[]);
    let aggregated = drive.aggregate(&rules, |_| true);
    let boxed_s: Vec<f64> = aggregated.objects.iter().map(|o| o.time.0 as f64 / 1e9).collect();
    assert_eq!(boxed_s, [0.5, 1.0, 1.25, 1.5, 4.0, 4.5, 5.0], "carried 0.6 s on, not over a gap");
    assert!(aggregated.dropped.ghost > 100, "{} ghosts", aggregated.dropped.ghost);

    let smeared = drive.labels(&small(&["relabel.drop_ghosts=none"]));
    let mut views = Vec::new();
    for ((time, sharp), smeared) in keyframes_s.into_iter().zip(drive.labels(&rules)).zip(&smeared)
    {
        let stands = [1.25, 4.0].contains(&time);
        let boxed = instances_above_ground(&sharp, 1).len();
        assert_eq!(boxed > 20, stands, "{boxed} voxels of the track at {time} s");
        if stands {
            stage.check_no_trail(&sharp, &rules, time);
        }
        let cars = sharp.semantics.values().iter().filter(|class| **class == CAR.0).count();
        assert_eq!(cars > 0, stands, "ghosts at {time} s: {cars}");
        smears_where_it_was(&stage, smeared, &absent_s);
        views.push(format!("\nkeyframe at {time} s{}", above(&sharp, 3)));
    }
    let last = format!("\nthe same at 5 s, ghosts kept{}", above(&smeared[4], 3));
    let title = "A car at 1 m/s, annotated at 1.0, 1.5, 4.0 and 4.5 s.";
    assert_golden("geometry/comes-and-goes.txt", &picture(title, &[views.concat(), last]));
}

/// Car voxels without an instance lie where the car was in the sweeps in which no box held it.
#[track_caller]
fn smears_where_it_was(stage: &Stage, labels: &OccupancyLabels, absent_s: &[f64]) {
    let was: Vec<Body> = absent_s.iter().filter_map(|&time| (stage.world)(time).pop()).collect();
    let mut smears = vec![0; was.len()];
    for (voxel, body) in stage.voxels(&small(&[]), 0.0) {
        let is_car = *labels.semantics.at(voxel) == CAR.0;
        if is_car && *labels.evidence.instances.at(voxel) == 0 {
            let held: Vec<bool> =
                was.iter().map(|was| scenes::overlap(&body, &was.grown(0.001))).collect();
            assert!(held.contains(&true), "{voxel:?} is a trail");
            smears.iter_mut().zip(held).for_each(|(count, held)| *count += usize::from(held));
        }
    }
    assert!(smears.iter().all(|&count| count > 5), "{smears:?} voxels at {absent_s:?}");
}

#[test]
fn section_4_of_two_overlapping_boxes_the_smaller_takes_the_points() {
    let boxes = [
        slab(CAR, [3.1, -1.4, 0.2], [6.9, 0.6, 1.5]).tracked(1),
        slab(PEDESTRIAN, [2.6, -0.8, 0.2], [3.7, 0.2, 1.9]).tracked(2),
        slab(CAR, [4.1, 2.2, 0.2], [5.3, 3.4, 1.4]).tracked(3),
        slab(CAR, [4.7, 1.8, 0.2], [5.9, 3.0, 1.4]).tracked(4),
    ];
    let world = |_| road_with(&boxes);
    let annotated: &[f64] = &[0.0];
    let annotated_s = &[annotated; 4];
    let stage =
        Stage { world: &world, map_from_ego: STILL, sweeps_s: &[0.0], annotated_s, step_deg: 0.5 };
    let rules = small(&[]);
    let labels = stage.drive(&[0.0]).label(&rules);

    let owners = owners_of_voxels(&stage, &boxes, &rules);
    let mut judged = [0; 5];
    for (voxel, owners) in owners.iter().filter(|(_, owners)| owners.len() == 1) {
        let owner = *owners.first().expect("one owner");
        assert_eq!(*labels.evidence.instances.at(*voxel), owner, "{voxel:?}");
        judged[usize::from(owner)] += 1;
    }
    assert!(
        judged.iter().all(|&count| count > 3),
        "{judged:?} voxels of 0 (none) and tracks 1 to 4"
    );
    let instance = |voxel| match *labels.evidence.instances.at(voxel) {
        0 => class_at(&labels, voxel),
        track => char::from(b'0' + track as u8),
    };
    let title = "A person's box in a car's, and two boxes of one size. Digits are tracks.";
    let views = [from_above(SHAPE, 2, instance), from_above(SHAPE, 4, instance)];
    assert_golden("geometry/overlapping-boxes.txt", &picture(title, &views));
}

/// For every voxel that was hit: the tracks of its points, 0 for none, by the words of the rule.
fn owners_of_voxels(
    stage: &Stage,
    boxes: &[Body],
    rules: &Rules,
) -> BTreeMap<[usize; 3], BTreeSet<u16>> {
    let margin = Vector3::new(0.1, 0.1, 0.05);
    let grown = |body: &Body| {
        // 10 cm on every face but the bottom's: the middle rises by half as much as the height grows.
        let up = upright([0.0, 0.0, 0.05], 0.0);
        Body {
            map_from_body: body.map_from_body * up,
            half_m: body.half_m + margin,
            ..body.clone()
        }
    };
    let volume = |body: &Body| body.half_m.x * body.half_m.y * body.half_m.z;
    let owner = |p: &Point3<f64>| {
        let inside = boxes.iter().filter(|body| grown(body).contains(p));
        inside.min_by(|a, b| volume(a).total_cmp(&volume(b)).then(a.track.cmp(&b.track)))
    };
    let map_from_lidar = stage.map_from_lidar(0.0);
    let mut owners = BTreeMap::new();
    for p in &look(&(stage.world)(0.0), &map_from_lidar, &directions(stage.step_deg)).positions {
        let p = map_from_lidar * p;
        if let Some(flat) = rules.spec.flat_of(&p) {
            let voxel = rules.spec.voxel_at(flat).0.map(|i| i as usize);
            let tracks: &mut BTreeSet<u16> = owners.entry(voxel).or_default();
            tracks.insert(owner(&p).and_then(|body| body.track).unwrap_or(0));
        }
    }
    owners
}
