//! What a keyframe's own sensors have to say, apart from all other sweeps.
//!
//! Some dialects bring it along: the voxels that the keyframe's own sweep hits are what completion
//! networks are given (`input`), and cameras need not look everywhere (`infov`).

use occlabel_aggregate::{WindowSettings, compose};
use occlabel_core::{AggregatedScene, ClassId, Keyframe, Scene, VoxelGrid};
use occlabel_occlusion::in_view;
use occlabel_voxelize::voxelize;

use crate::Rules;
use crate::aggregate_scene::standing_boxes;
use crate::label_keyframe::{moment, open_eyes};

/// 1 where a point of the keyframe's own moment lies.
pub fn own_points(
    scene: &Scene,
    aggregated: &AggregatedScene<ClassId>,
    keyframe: &Keyframe,
    rules: &Rules,
) -> VoxelGrid<u8> {
    let standing = standing_boxes(&scene.tracks, keyframe.time, rules);
    let window = WindowSettings { window_s: 0.0, deformable_window_s: 0.0, ..rules.window };
    let mut instant = compose(aggregated, &moment(scene, keyframe, rules, &standing), &window);
    instant.background.retain(|sweep| sweep.time.is_some());
    instant.objects.retain(|placed| placed.object.time.is_some());
    voxelize(&instant, &rules.spec, &rules.votes()).map(|vote| u8::from(vote.is_some()))
}

/// 1 where the centre of a voxel is in view of one of the keyframe's cameras, hidden or not.
pub fn own_view(scene: &Scene, keyframe: &Keyframe, rules: &Rules) -> VoxelGrid<u8> {
    let grid_from_world = rules.world_from_grid(scene.reference_sweep(keyframe)).inverse();
    let eyes = open_eyes(scene, keyframe, &grid_from_world);
    in_view(&eyes, &rules.spec, rules.occlusion.depth_max_m)
}
