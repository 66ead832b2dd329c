//! Counting all rays of an instant (labels.md section 8).

use occlabel_core::{GridSpec, Instant, Level, RayCounts};
use rayon::prelude::*;

use crate::caster::Caster;
use crate::cells::Cell;
use crate::work::Work;
use crate::{ObjectRays, RayRules};

/// How rays are counted. But for what is kept of the crossings, none of it shows in the counts.
#[derive(Clone, Copy, Debug)]
pub struct Casting {
    /// What is kept of the crossings.
    pub crossings: Crossings,
    /// Over how many threads the rays are shared out, with a pair of grids each; at least 1.
    pub shards: usize,
    /// The instruction set.
    pub level: Level,
}

/// What is kept of the crossings of a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossings {
    /// Whether there were any: then the count is at least 1, but not their number.
    Whether,
    /// How many there were.
    HowMany,
}

impl Casting {
    /// On the best instruction set of this processor.
    pub fn new(crossings: Crossings, shards: usize) -> Self {
        Self { crossings, shards, level: Level::best() }
    }
}

/// How often each voxel was hit and crossed.
///
/// Sums of integers, so the result depends neither on the order of rays nor on threads.
///
/// # Panics
/// If there are 0 shards, or the processor does not have the level.
pub fn count(instant: &Instant, spec: &GridSpec, rules: &RayRules, casting: &Casting) -> RayCounts {
    assert!(casting.shards > 0, "at least one shard");
    let all = Rays { instant, spec, rules, casting };
    match casting.crossings {
        Crossings::Whether => all.count::<bool>(),
        Crossings::HowMany => all.count::<u32>(),
    }
}

/// The rays of an instant and how to count them.
struct Rays<'a> {
    instant: &'a Instant<'a>,
    spec: &'a GridSpec,
    rules: &'a RayRules<'a>,
    casting: &'a Casting,
}

impl Rays<'_> {
    fn count<C: Cell>(&self) -> RayCounts {
        let settings = self.rules.settings;
        let (other_time, same_time): (Vec<_>, Vec<_>) =
            Work::of(self.instant, settings.object_rays)
                .into_iter()
                .partition(|work| work.is_of_another_time(self.instant, settings.same_time_s));
        let mut counts = self.cast_all::<C>(&other_time);
        if settings.object_rays == ObjectRays::Own {
            forget_air_in_boxes(&mut counts, self.instant, self.spec);
        }
        add(&mut counts, &self.cast_all::<C>(&same_time));
        counts
    }

    fn cast_all<C: Cell>(&self, work: &[Work]) -> RayCounts {
        work.par_chunks(work.len().div_ceil(self.casting.shards).max(1))
            .map(|share| {
                let mut caster = self.caster::<C>();
                let cast = |work: &Work| {
                    work.cast(self.instant, self.spec, self.rules, &mut caster);
                };
                share.iter().for_each(cast);
                caster.into_counts()
            })
            .reduce_with(|mut sum, counts| {
                add(&mut sum, &counts);
                sum
            })
            .unwrap_or_else(|| self.caster::<C>().into_counts())
    }

    fn caster<C: Cell>(&self) -> Caster<'_, C> {
        Caster::new(self.spec, self.rules.settings, self.casting.level)
    }
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
