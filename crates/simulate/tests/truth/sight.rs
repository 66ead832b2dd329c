//! What cameras truly see.

use occlabel_core::{GridSpec, Pose, VoxelGrid, VoxelTruth};
use occlabel_simulate::{TrueRays, TruthAt, TruthSettings, keyframe_truth};

use crate::support::*;

/// A camera at the origin that sees 400 aside at 390 ahead, and a wall before it, its faces
/// on those of voxels: x from 4.8 to 5.2, y from -1.2 to 1.2.
fn truth(depth_max_m: f64) -> (GridSpec, VoxelGrid<VoxelTruth>) {
    let wall = solid("static.manmade", [5.0, 0.0, 0.0], "box.size_m = [0.4, 2.4, 80.0]");
    let camera = r#"
        [[camera]]
        name = "CAM_FRONT"
        mounting = { position_m = [0.0, 0.0, 0.0] }
        model.pinhole.matrix = [[390.0, 0.0, 400.0], [0.0, 390.0, 400.0], [0.0, 0.0, 1.0]]
        width = 800
        height = 800
        rate_hz = 10.0
    "#;
    let text = head(0.0).replace("speed_mps = 0.0", "speed_mps = 0.0 }\nheave_m = { mean = 30.0");
    let drive = drive(&(text + &lidar(1.0) + &wall + camera));
    let spec = grid([-4.0, -8.0, -1.2], [12.0, 8.0, 1.2], 0.4);
    let keyframe = &drive.scene().keyframes[1];
    // The ego heaves 30 m up, above the ground; the wall stays where it can be seen.
    let world_from_grid = Pose::translation(0.0, 0.0, 30.0);
    let at = TruthAt { keyframe, spec: &spec, world_from_grid };
    let settings = TruthSettings { sight_depth_m: Some(depth_max_m), ..SETTINGS };
    let truth = keyframe_truth(&drive, &TrueRays::cast(&drive), &at, &settings, None);
    (spec, truth)
}

#[test]
fn a_wall_hides_its_shadow_and_nothing_else() {
    let (spec, truth) = truth(10.0);
    let mut seen = [0, 0, 0];
    for (flat, voxel) in truth.values().iter().enumerate() {
        let c = spec.centre(spec.voxel_at(flat));
        let aside = c.y.abs().max(c.z.abs());
        let in_view = aside * 390.0 < c.x * 400.0 && c.coords.norm() <= 10.0;
        let hidden = c.x > 5.2 && c.y.abs() * 4.8 / c.x < 1.2;
        assert_eq!(voxel.sight, u16::from(in_view && !hidden), "{c:?}");
        seen[0] += usize::from(in_view && !hidden);
        seen[1] += usize::from(in_view && hidden);
        seen[2] += usize::from(voxel.sight == 1 && voxel.solid > 0.0);
    }
    assert!(seen[0] > 1500 && seen[1] > 300, "{seen:?}");
    assert_eq!(seen[2], 6 * 6, "the wall itself is seen");
}
