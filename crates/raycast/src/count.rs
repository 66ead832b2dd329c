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
        let (other_time, same_time): (Vec<_>, Vec<_>) =
            Work::of(self.instant, self.rules.settings.object_rays)
                .into_iter()
                .partition(|work| self.is_of_another_time(work));
        (0..self.casting.shards)
            .into_par_iter()
            .map(|shard| {
                self.cast::<C>(self.share(&other_time, shard), self.share(&same_time, shard))
            })
            .reduce_with(|mut sum, counts| {
                add(&mut sum, &counts);
                sum
            })
            .expect("at least one shard")
    }

    fn is_of_another_time(&self, work: &Work) -> bool {
        work.is_of_another_time(self.instant, self.rules.settings.same_time_s)
    }

    fn share<'w>(&self, work: &'w [Work<'w>], shard: usize) -> &'w [Work<'w>] {
        let size = work.len().div_ceil(self.casting.shards).max(1);
        work.chunks(size).nth(shard).unwrap_or(&[])
    }

    /// Casts one after the other into the same grids.
    fn cast<C: Cell>(&self, other_time: &[Work], same_time: &[Work]) -> RayCounts {
        let mut caster = Caster::<C>::new(self.spec, self.rules.settings, self.casting.level);
        self.cast_all(other_time, &mut caster);
        // Air seen at another time says nothing about where a track stands now.
        if self.rules.settings.object_rays == ObjectRays::Own {
            caster.forget(voxels_in_boxes(self.instant, self.spec));
        }
        self.cast_all(same_time, &mut caster);
        caster.into_counts()
    }

    fn cast_all<C: Cell>(&self, work: &[Work], caster: &mut Caster<C>) {
        work.iter().for_each(|work| work.cast(self.instant, self.spec, self.rules, caster));
    }
}

/// The places of the voxels whose centres are inside a box that stands now.
fn voxels_in_boxes<'a>(
    instant: &'a Instant,
    spec: &'a GridSpec,
) -> impl Iterator<Item = usize> + 'a {
    instant.standing.iter().flat_map(move |standing| {
        let box_from_grid = standing.grid_from_box.inverse();
        let centre = standing.grid_from_box.translation.vector.into();
        spec.voxels_near(&centre, standing.grown.radius())
            .filter(move |voxel| standing.grown.contains(&(box_from_grid * spec.centre(*voxel))))
            .filter_map(|voxel| spec.flat(voxel))
    })
}

fn add(sum: &mut RayCounts, counts: &RayCounts) {
    let pairs = |sum: &mut [u32], more: &[u32]| sum.iter_mut().zip(more).for_each(|(a, b)| *a += b);
    pairs(sum.hits.values_mut(), counts.hits.values());
    pairs(sum.crossings.values_mut(), counts.crossings.values());
}
