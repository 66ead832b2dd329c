//! Flow, and the voxels that movers swept.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use occlabel_core::{Pose, TrackId};

use crate::support::*;

const CAR: [f64; 3] = [4.0, 1.6, 1.6];

fn car(trajectory: &str) -> String {
    head(0.0) + &lidar(3.0) + &mover("car", "vehicle.car", CAR, trajectory, "")
}

#[track_caller]
fn assert_flow(found: [f32; 3], expected: Vector3<f64>) {
    let off = Vector3::from(found.map(f64::from)) - expected;
    assert!(off.norm() < 1e-5, "{found:?}, expected {expected:?}");
}

#[test]
fn a_straight_car_flows_at_its_speed_in_the_grids_own_frame() {
    let drive = drive(&car("straight = { start = { x_m = -3.0, y_m = 0.0 }, speed_mps = 8.0 }"));
    let spec = grid([-8.0, -8.0, 0.2], [8.0, 8.0, 2.2], 0.4);
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.5);
    let truth = truth_at(&drive, 0, &spec, Pose::from_parts(Vector3::zeros().into(), turned));
    let mut moving = 0;
    for voxel in truth.values().iter().filter(|voxel| voxel.solid > 0.0) {
        assert_eq!(voxel.instance, Some(TrackId(1)));
        assert_flow(voxel.flow, Vector3::new(8.0 * libm::cos(0.5), -8.0 * libm::sin(0.5), 0.0));
        moving += 1;
    }
    assert!(moving > 150, "{moving}");
    assert_eq!(count(&truth, |voxel| voxel.solid == 0.0 && voxel.flow != [0.0; 3]), 0);
    let last = truth_at(&drive, 1, &spec, Pose::identity());
    assert!(count(&last, |voxel| voxel.flow[0].is_nan()) > 150, "no next annotation");
}

#[test]
fn a_turning_car_flows_along_the_chord_of_each_voxels_own_arc() {
    let trajectory = "turn = { start = { x_m = -3.0, y_m = 0.0 }, speed_mps = 4.0, begin_s = 0.0, \
                      duration_s = 9.0, yaw_rate_rad_s = 0.8 }";
    let spec = grid([-8.0, -8.0, 0.2], [8.0, 8.0, 2.2], 0.4);
    let truth = truth_of(&car(trajectory), 0, &spec);
    // The centre of the turn is v / w = 5 m to the left; half a second turns by 0.4 rad.
    let centre = Point3::new(-3.0, 5.0, 0.0);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4);
    let mut moving = 0;
    for (flat, voxel) in truth.values().iter().enumerate().filter(|(_, v)| v.solid > 0.0) {
        let arm = spec.centre(spec.voxel_at(flat)) - centre;
        assert_flow(voxel.flow, (turn * arm - arm) / 0.5);
        moving += 1;
    }
    assert!(moving > 150, "{moving}");
}

#[test]
fn a_car_sweeps_what_it_passes_and_not_what_it_fills() {
    let text = car("straight = { start = { x_m = -3.0, y_m = 0.0 }, speed_mps = 8.0 }");
    let spec = grid([-8.0, -4.0, 0.0], [8.0, 4.0, 4.0], 0.4);
    let truth = truth_of(&text, 1, &spec);
    // At 0.5 s from -1 to 3; at the sweeps from 0 to 0.9 s from -5 to 6.2; y and z on voxel faces.
    for (flat, voxel) in truth.values().iter().enumerate() {
        let c = spec.centre(spec.voxel_at(flat));
        let aside = c.y.abs() < 0.8 && c.z < 1.6;
        let reaches = |from: f64, to: f64| aside && from < c.x + 0.2 && c.x - 0.2 < to;
        assert_eq!(voxel.solid > 0.0, reaches(-1.0, 3.0), "{c:?}");
        assert_eq!(voxel.swept, reaches(-5.0, 6.2) && !reaches(-1.0, 3.0), "{c:?}");
    }
    assert_eq!(count(&truth, |voxel| voxel.swept), 18 * 16);
}
