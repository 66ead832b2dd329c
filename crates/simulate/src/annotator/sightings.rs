//! What the keyframes' reference sweeps see of the movers.

use std::collections::BTreeMap;

use occlabel_core::Timestamp;
use rayon::prelude::*;

use crate::annotator::BoxTime;
use crate::schedule::SweepKey;
use crate::{What, World};

/// How the reference sweep of each keyframe meets each mover. Empty if the annotator need not know.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sightings(BTreeMap<Timestamp, Vec<Sighting>>);

/// The returns of one mover in one sweep.
#[derive(Clone, Copy, Debug)]
struct Sighting {
    returns: u32,
    /// When the mover stands where its box says.
    box_time: Timestamp,
}

impl Sightings {
    /// Casts the keyframes' sweeps if boxes depend on it. Parallel over keyframes.
    pub(crate) fn new(world: &World, keyframes: &[SweepKey]) -> Self {
        let rolls = keyframes.first().is_some_and(|key| world.lidars[key.lidar].rolling);
        let by_mean = rolls && world.annotator.box_time == BoxTime::MeanReturn;
        if !by_mean && world.annotator.min_points == 0 {
            return Self::default();
        }
        let see = |key: &SweepKey| (key.time, sightings(world, key));
        Self(keyframes.par_iter().map(see).collect::<Vec<_>>().into_iter().collect())
    }

    /// When a mover stands where its box at a time says: one that was drawn at a keyframe, or one
    /// straight between those of the keyframes around.
    pub(crate) fn box_time(&self, time: Timestamp, mover: usize) -> Timestamp {
        let late_ns = |(keyframe, movers): (&Timestamp, &Vec<Sighting>)| {
            (keyframe.0, movers[mover].box_time.0 - keyframe.0)
        };
        let before = self.0.range(..=time).next_back().map(late_ns);
        let after = self.0.range(time..).next().map(late_ns);
        let late_ns = match (before, after) {
            (Some((a, late_a)), Some((b, late_b))) if a < b => {
                let share = (time.0 - a) as f64 / (b - a) as f64;
                late_a + ((late_b - late_a) as f64 * share).round() as i64
            }
            (Some((_, late)), _) | (None, Some((_, late))) => late,
            (None, None) => 0,
        };
        Timestamp(time.0 + late_ns)
    }

    /// Whether a mover has enough returns in a keyframe's reference sweep.
    pub(crate) fn has(&self, keyframe: Timestamp, mover: usize, min_points: u32) -> bool {
        min_points == 0
            || self.0.get(&keyframe).is_some_and(|movers| movers[mover].returns >= min_points)
    }
}

fn sightings(world: &World, key: &SweepKey) -> Vec<Sighting> {
    let mut tallies = vec![(0_i64, 0_u32); world.movers.len()];
    for found in world.lidars[key.lidar].sweep(world, key.number) {
        if let What::Mover(at) = found.hit.what {
            tallies[at].0 += found.time.0 - key.time.0;
            tallies[at].1 += 1;
        }
    }
    let sighting = |(sum_ns, returns): (i64, u32)| {
        let late_ns = match world.annotator.box_time {
            BoxTime::MeanReturn => sum_ns / i64::from(returns.max(1)),
            BoxTime::Sweep => 0,
        };
        Sighting { returns, box_time: Timestamp(key.time.0 + late_ns) }
    };
    tallies.into_iter().map(sighting).collect()
}
