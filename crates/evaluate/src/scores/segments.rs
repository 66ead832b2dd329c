//! Segments of a keyframe: voxels of one class and, of things, one instance.

use std::collections::BTreeMap;

use occlabel_core::ClassId;

use super::rules::{ScoringRules, UNLABELLED};
use super::scorer::{ScoredLabels, ScoredPair};

/// A class, and the instance of a thing. Things without an instance are one segment a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Segment {
    pub(crate) class: u8,
    pub(crate) instance: u16,
}

/// How many voxels each segment has, and how many two of them share.
#[derive(Debug, Default)]
pub(crate) struct Overlaps {
    pub(crate) truth: BTreeMap<Segment, u64>,
    pub(crate) prediction: BTreeMap<Segment, u64>,
    /// Of (truth, prediction).
    pub(crate) both: BTreeMap<(Segment, Segment), u64>,
}

impl Segment {
    /// Of what truth leaves open.
    pub(crate) const VOID: Self = Self { class: UNLABELLED, instance: 0 };

    fn key(self) -> u64 {
        u64::from(self.class) << 16 | u64::from(self.instance)
    }

    fn of_key(key: u64) -> Self {
        Self { class: (key >> 16) as u8, instance: key as u16 }
    }
}

impl Overlaps {
    /// Of the voxels within the mask. Free and no label are segments too.
    pub(crate) fn of(pair: &ScoredPair, rules: &ScoringRules) -> Self {
        let mut keys: Vec<u64> = (0..rules.spec.len())
            .filter(|&at| pair.asks(at))
            .map(|at| {
                let truth = segment(&pair.truth, at, rules);
                truth.key() << 32 | segment(&pair.prediction, at, rules).key()
            })
            .collect();
        keys.sort_unstable();
        let mut overlaps = Self::default();
        for run in keys.chunk_by(|a, b| a == b) {
            let (truth, prediction) = (Segment::of_key(run[0] >> 32), Segment::of_key(run[0]));
            let voxels = run.len() as u64;
            *overlaps.truth.entry(truth).or_default() += voxels;
            *overlaps.prediction.entry(prediction).or_default() += voxels;
            overlaps.both.insert((truth, prediction), voxels);
        }
        overlaps
    }

    pub(crate) fn shared(&self, truth: Segment, prediction: Segment) -> u64 {
        self.both.get(&(truth, prediction)).copied().unwrap_or(0)
    }
}

/// The segment of a voxel; classes that are ignored are void.
fn segment(labels: &ScoredLabels, at: usize, rules: &ScoringRules) -> Segment {
    let class = labels.semantics.values()[at];
    if rules.ignored.contains(ClassId(class)) {
        return Segment::VOID;
    }
    match labels.instances {
        Some(instances) if rules.things.contains(ClassId(class)) => {
            Segment { class, instance: instances.values()[at] }
        }
        _ => Segment { class, instance: 0 },
    }
}
