//! Voxels exactly at a limit, seen by turned cameras: rounding must not decide (labels.md section 10).

use nalgebra::{Point3, UnitQuaternion, Vector3};
use occlabel_core::camera::{CameraModel, Intrinsics, Pinhole};
use occlabel_core::{Camera, GridSpec, Pose, VoxelGrid};
use occlabel_occlusion::{CameraRays, Eye, Lenses, Matter, Occluders, OcclusionSettings, visible};

fn seen(shape: [usize; 3], at: [f64; 3], yaw: f64, solid: [i64; 3], depth_max_m: f64) -> bool {
    let k = [[50.0, 0.0, 50.0], [0.0, 50.0, 50.0], [0.0, 0.0, 1.0]];
    let model = CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k).unwrap()));
    let camera = Camera { model, width: 100, height: 100, body_mask: None, rolling_shutter: None };
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
        * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    let grid_from_camera = Pose::from_parts(Point3::from(at).into(), turn);
    let eye = Eye { bit: 0, camera: &camera, grid_from_camera };
    let spec = GridSpec::new([0.0; 3], shape.map(|n| n as f64), [1.0; 3]).unwrap();
    let solids = spec.voxels().map(|v| if v.0 == solid { Matter::Solid } else { Matter::Air });
    let matter = VoxelGrid::from_values(&spec, solids.collect());
    let settings = OcclusionSettings {
        rays: CameraRays::OccupiedCenters,
        occluders: Occluders::All,
        pixel_stride: 1,
        depth_max_m,
    };
    *visible(&[eye], &Lenses::default(), &spec, &matter, &settings).at(solid.map(|i| i as usize))
        == 1
}

/// The camera at the centre of voxel (0, 2, 2) looks along x; the voxel's centre is 1..39 m ahead.
#[test]
fn section_10_the_depth_is_closed_for_a_turned_camera() {
    let mut lost = Vec::new();
    for x in 1..40 {
        for step in -10..=10 {
            let yaw = f64::from(step) * 0.05;
            if !seen([40, 5, 5], [0.5, 2.5, 2.5], yaw, [x, 2, 2], x as f64) {
                lost.push((x, step));
            }
        }
    }
    assert!(lost.is_empty(), "{} of 819 lost, (metres, yaw / 0.05): {:?}", lost.len(), &lost[..9]);
}

/// A camera exactly at a voxel's centre has z_camera = 0 there: not in view, no ray, no bit.
#[test]
fn section_10_the_cameras_own_centre_is_not_in_view() {
    let mut gained = 0;
    for (x, step) in (0..40).flat_map(|x| (-10..=10).map(move |step| (x, step))) {
        let at = [x as f64 + 0.5, 2.5, 2.5];
        gained += usize::from(seen([40, 5, 5], at, f64::from(step) * 0.05, [x, 2, 2], 100.0));
    }
    assert_eq!(gained, 0, "of 840");
}
