//! Small scenes for the tests of this crate.

use occlabel_core::{GridSpec, Palette, VoxelGrid};

use crate::{ShownKeyframe, ShownScene};

/// A scene of two classes; 2 is free.
pub(crate) fn shown_scene() -> ShownScene {
    ShownScene {
        name: "street".into(),
        frame: "ego".into(),
        palette: Palette::of(&["car", "driveable_surface"]),
        free: 2,
        cameras: Vec::new(),
        tracks: Vec::new(),
    }
}

/// A keyframe of which nothing but the classes is known.
pub(crate) fn shown_keyframe(spec: &GridSpec, semantics: VoxelGrid<u8>) -> ShownKeyframe {
    ShownKeyframe {
        token: "first".into(),
        time: None,
        world_from_grid: None,
        heading_rad: Some(0.0),
        spec: spec.clone(),
        semantics,
        mask_lidar: None,
        mask_camera: None,
        instances: None,
        flow: None,
        evidence: None,
    }
}
