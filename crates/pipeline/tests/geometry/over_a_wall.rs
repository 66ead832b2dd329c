//! A camera that looks over a wall.

use nalgebra::Point3;
use occlabel_core::OccupancyLabels;
use occlabel_testkit::assert_golden;

use crate::scenes::{
    Drive, MANMADE, Stage, camera, class_at, from_the_left, looking_ahead, slab, small, upright,
    world_from_map,
};
use crate::{SHAPE, picture, road_with, voxels_above_ground};

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
    camera_sees_over_the_wall(&labels, &eye);
    let view = from_the_left(SHAPE, 8, |voxel| {
        let is_seen = *labels.mask_camera.at(voxel) == 1;
        if is_seen || class_at(&labels, voxel) == '?' { class_at(&labels, voxel) } else { 'x' }
    });
    let title =
        "A camera 1.7 m up at voxel (4, 8, 4) looks over a wall. x observed, but not seen by it.";
    assert_golden("geometry/camera-over-wall.txt", &picture(title, &[view]));
}

/// Voxels behind the wall are seen where the line from the eye to them passes above it. The wall fills
/// its voxels: 1.25 m high, its back at 4.5 m.
#[track_caller]
fn camera_sees_over_the_wall(labels: &OccupancyLabels, eye: &Point3<f64>) {
    let (mut hidden, mut seen) = (0, 0);
    for (x, y, z) in voxels_above_ground().filter(|&(x, _, _)| x >= 13) {
        let corners = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5], [0.25, 0.25]];
        let height = |[dx, dz]: [f64; 2]| {
            let (x_m, z_m) = (x as f64 * 0.5 - 2.0 + dx, z as f64 * 0.5 - 0.75 + dz);
            eye.z + (z_m - eye.z) * (4.5 - eye.x) / (x_m - eye.x)
        };
        let is_seen = *labels.mask_camera.at([x, y, z]) == 1;
        let is_ahead = (y as f64 * 0.5 - 3.75 - eye.y).abs() < x as f64 * 0.5 - 2.0 - eye.x;
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
}

/// The drive with a camera that looks ahead from a place in the grid of its first sweep.
fn with_camera(mut drive: Drive, eye: &Point3<f64>) -> Drive {
    drive.scene.cameras.push(camera("FRONT", 400, 60_f64.to_radians()));
    let grid_from_frame = upright((*eye).into(), 0.0);
    drive.add_keyframe(0, &[world_from_map() * looking_ahead(&grid_from_frame)]);
    drive
}
