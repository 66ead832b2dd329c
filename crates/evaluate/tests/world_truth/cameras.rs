//! Camera masks: a corridor along x, seen by a camera in its first voxel.

use crate::support::*;
use nalgebra::{Rotation3, Vector3};
use occlabel_core::camera::{Camera, CameraModel, Intrinsics, Pinhole};
use occlabel_core::{Pose, VoxelGrid, VoxelTruth};
use occlabel_evaluate::{KnownWorld, Quality, judge};
use occlabel_occlusion::{CameraRays, Eye, Occluders, OcclusionSettings};

fn camera() -> Camera {
    let k = [[50.0, 0.0, 50.0], [0.0, 50.0, 50.0], [0.0, 0.0, 1.0]];
    let model = CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k).unwrap()));
    Camera { model, width: 100, height: 100, body_mask: None, rolling_shutter: None }
}

fn judge_seen(pairs: &[(Label, VoxelTruth)], occluders: Occluders) -> Quality {
    let scale = row(pairs.len());
    let (labels, truth): (Vec<Label>, Vec<VoxelTruth>) = pairs.iter().copied().unzip();
    let truth = VoxelGrid::from_values(&scale.spec, truth);
    let arrays = Arrays::new(&scale.spec, &labels);
    let camera = camera();
    // z of the camera looks along x of the grid.
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    let grid_from_camera = Pose::from_parts(Vector3::repeat(0.2).into(), turn.into());
    let eyes = [Eye { bit: 3, camera: &camera, grid_from_camera }];
    let rays = CameraRays::OccupiedCenters;
    let settings = OcclusionSettings { rays, occluders, pixel_stride: 7, depth_max_m: 100.0 };
    let known = KnownWorld { scene: "row", truth: &truth, eyes: &eyes, occlusion: Some(&settings) };
    judge(&arrays.judged(), &known, &scale).unwrap().quality()
}

fn seen(label: Label) -> Label {
    Label { is_camera_seen: true, ..label }
}

fn in_sight(truth: VoxelTruth) -> VoxelTruth {
    VoxelTruth { sight: 8, ..truth }
}

#[test]
fn a6c_is_the_rule_on_exact_occupancy_whatever_rays_the_labels_took() {
    // Seen: up to the wall. The labels took the wall for air and saw on behind it.
    let quality = judge_seen(
        &[
            (seen(EMPTY), air()),
            (seen(EMPTY), air()),
            (seen(EMPTY), surface(WALL)),
            (seen(EMPTY), air()),
            (EMPTY, air()),
        ],
        Occluders::All,
    );
    assert_eq!(all(&quality, "mask_camera_iou"), (Some(0.75), 4));
}

#[test]
fn a6c_lets_ground_block_as_the_labels_do() {
    let pairs = [EMPTY, EMPTY, EMPTY, EMPTY].map(seen);
    let pairs: Vec<_> = pairs.into_iter().zip([air(), surface(ROAD), air(), air()]).collect();
    let blocked = judge_seen(&pairs, Occluders::All);
    assert_eq!(all(&blocked, "mask_camera_iou"), (Some(0.5), 4));
    let through = judge_seen(&pairs, Occluders::NonFlat);
    assert_eq!(all(&through, "mask_camera_iou"), (Some(1.0), 4));
}

#[test]
fn a6c_and_a6g_leave_out_what_the_labels_do_not_observe() {
    let quality = judge_seen(
        &[
            (seen(EMPTY), in_sight(air())),
            (UNOBSERVED, in_sight(air())),
            (seen(occupied(WALL)), surface(WALL)),
        ],
        Occluders::All,
    );
    assert_eq!(all(&quality, "mask_camera_iou"), (Some(1.0), 2));
    assert_eq!(all(&quality, "mask_camera_sight_iou"), (Some(0.5), 2));
}

#[test]
fn a6g_is_left_out_where_sight_was_not_measured() {
    let quality = judge_seen(&[(seen(EMPTY), air()), (seen(EMPTY), air())], Occluders::All);
    assert_eq!(all(&quality, "mask_camera_sight_iou"), (None, 0));
    assert_eq!(all(&quality, "mask_camera_iou"), (Some(1.0), 2));
}
