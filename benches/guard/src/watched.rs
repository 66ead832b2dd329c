//! What callgrind watches: it counts while one of these runs. Each calls one stage, and nothing else.

use nalgebra::Point3;
use occlabel_aggregate::{SplitSweep, TrackBox, split_sweep};
use occlabel_annotate::RelabelSettings;
use occlabel_core::{AggregatedScene, ClassId, Instant, RayCounts, Sweep, VoxelGrid, VoxelVote};
use occlabel_evaluate::rays::{RayGrid, RayPair, RaySet, ray_pairs};
use occlabel_occlusion::{Eye, Lenses, Matter};
use occlabel_pipeline::{LabelOptions, LabelledKeyframe, Rules, label_keyframe};
use occlabel_raycast::{Casting, count};

use crate::prepared::Prepared;

#[inline(never)]
pub(crate) fn split(sweeps: &[(Sweep, Vec<TrackBox>)], rules: &Rules) -> Vec<SplitSweep> {
    sweeps.iter().map(|(sweep, boxes)| split_sweep(sweep, boxes, &rules.split)).collect()
}

#[inline(never)]
pub(crate) fn relabel(
    scene: AggregatedScene<Option<ClassId>>,
    settings: &RelabelSettings,
) -> AggregatedScene<ClassId> {
    occlabel_annotate::relabel(scene, settings)
}

#[inline(never)]
pub(crate) fn voxelize(instant: &Instant, rules: &Rules) -> VoxelGrid<Option<VoxelVote>> {
    occlabel_voxelize::voxelize(instant, &rules.spec, &rules.votes())
}

#[inline(never)]
pub(crate) fn rays(instant: &Instant, rules: &Rules) -> RayCounts {
    count(instant, &rules.spec, &rules.rays(), &Casting::new(rules.states.crossings(), 1))
}

#[inline(never)]
pub(crate) fn cameras(eyes: &[Eye], matter: &VoxelGrid<Matter>, rules: &Rules) -> VoxelGrid<u16> {
    occlabel_occlusion::visible(eyes, &Lenses::default(), &rules.spec, matter, &rules.occlusion)
}

#[inline(never)]
pub(crate) fn keyframe(
    prepared: &Prepared,
    aggregated: &AggregatedScene<ClassId>,
) -> LabelledKeyframe {
    let Prepared { drive, rules } = prepared;
    let (lenses, options) = (Lenses::default(), LabelOptions::labels(1));
    let keyframe = prepared.keyframe();
    label_keyframe(&drive.scene, aggregated, &lenses, keyframe, rules, &options, |_| {})
}

#[inline(never)]
pub(crate) fn score(semantics: &VoxelGrid<u8>, rules: &Rules) -> Vec<RayPair> {
    let (free, lidar) = (rules.taxonomy.free, Point3::new(0.9, 0.0, 1.8));
    let grid = RayGrid::new(&rules.spec, semantics, free).expect("labels of this grid");
    ray_pairs(&grid, &grid, &[lidar], &RaySet::published()).expect("an origin that is a place")
}
