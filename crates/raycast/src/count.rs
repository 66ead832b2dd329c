//! Counting all rays of an instant (labels.md section 8).

use occlabel_core::{GridSpec, Instant, RayCounts};
use rayon::prelude::*;

use crate::caster::Caster;
use crate::work::Work;
use crate::{ObjectRays, RayRules};

/// How often each voxel was hit and crossed.
///
/// Rays are shared out over `shards` threads with a pair of grids each; sums of integers, so the
/// result does not depend on it.
///
/// # Panics
/// If `shards` is 0.
pub fn count(instant: &Instant, spec: &GridSpec, rules: &RayRules, shards: usize) -> RayCounts {
    assert!(shards > 0, "at least one shard");
    let same_time_s = rules.settings.same_time_s;
    let (other_time, same_time): (Vec<_>, Vec<_>) = Work::of(instant, rules.settings.object_rays)
        .into_iter()
        .partition(|work| work.is_of_another_time(instant, same_time_s));
    let mut counts = cast_all(&other_time, instant, spec, rules, shards);
    if rules.settings.object_rays == ObjectRays::Own {
        forget_air_in_boxes(&mut counts, instant, spec);
    }
    add(&mut counts, &cast_all(&same_time, instant, spec, rules, shards));
    counts
}

fn cast_all(
    work: &[Work],
    instant: &Instant,
    spec: &GridSpec,
    rules: &RayRules,
    shards: usize,
) -> RayCounts {
    work.par_chunks(work.len().div_ceil(shards).max(1))
        .map(|share| {
            let mut caster = Caster::new(spec, rules);
            share.iter().for_each(|work| work.cast(instant, spec, rules, &mut caster));
            caster.into_counts()
        })
        .reduce_with(|mut sum, counts| {
            add(&mut sum, &counts);
            sum
        })
        .unwrap_or_else(|| Caster::new(spec, rules).into_counts())
}

/// Air seen at another time says nothing about where a track stands now.
fn forget_air_in_boxes(counts: &mut RayCounts, instant: &Instant, spec: &GridSpec) {
    let crossings = counts.crossings.values_mut();
    for standing in &instant.standing {
        let box_from_grid = standing.grid_from_box.inverse();
        let centre = standing.grid_from_box.translation.vector.into();
        for voxel in spec.voxels_near(&centre, standing.grown.radius()) {
            let is_inside = standing.grown.contains(&(box_from_grid * spec.centre(voxel)));
            if let (true, Some(flat)) = (is_inside, spec.flat(voxel)) {
                crossings[flat] = 0;
            }
        }
    }
}

fn add(sum: &mut RayCounts, counts: &RayCounts) {
    let pairs = |sum: &mut [u32], more: &[u32]| sum.iter_mut().zip(more).for_each(|(a, b)| *a += b);
    pairs(sum.hits.values_mut(), counts.hits.values());
    pairs(sum.crossings.values_mut(), counts.crossings.values());
}
