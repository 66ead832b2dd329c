//! Panoptic quality (Kirillov et al. 2019) of voxels.

use std::ops::AddAssign;

use super::confusion::Confusion;
use super::pair_counts::PairCounts;
use super::rules::ScoringRules;
use super::scorer::ScoredPair;
use super::segments::{Overlaps, Segment};
use crate::exact_mean::ExactMean;

/// Matches and misses of segments, by class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PanopticTally {
    pub(super) classes: Vec<ClassTally>,
    /// For PQ-dagger.
    pub(super) confusion: Confusion,
}

/// Of one class: the overlaps of its matched segments, and those without a match.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ClassTally {
    pub(super) matched: ExactMean,
    pub(super) missed: u64,
    pub(super) spurious: u64,
}

impl PanopticTally {
    /// Of one keyframe, whose ids and shapes are checked.
    pub(crate) fn of(pair: &ScoredPair, rules: &ScoringRules) -> Self {
        let overlaps = Overlaps::of(pair, rules);
        let mut matching = Matching { overlaps: &overlaps, rules, classes: Vec::new() };
        matching.classes.resize(rules.classes.len(), ClassTally::default());
        matching.run();
        let (truth, prediction) = (pair.truth.semantics, pair.prediction.semantics);
        let mut pairs = PairCounts::new();
        pairs.count(truth.values(), prediction.values(), pair.mask.map(|mask| mask.values()));
        let confusion = Confusion::of_pairs(&pairs, rules.classes.len(), &rules.ignored);
        Self { classes: matching.classes, confusion }
    }
}

impl AddAssign<&PanopticTally> for PanopticTally {
    fn add_assign(&mut self, other: &Self) {
        self.classes.resize(self.classes.len().max(other.classes.len()), ClassTally::default());
        for (sum, class) in self.classes.iter_mut().zip(&other.classes) {
            sum.matched += class.matched;
            sum.missed += class.missed;
            sum.spurious += class.spurious;
        }
        self.confusion += &other.confusion;
    }
}

/// The segments of one keyframe, being matched.
struct Matching<'a> {
    overlaps: &'a Overlaps,
    rules: &'a ScoringRules,
    classes: Vec<ClassTally>,
}

impl Matching<'_> {
    /// Two segments of one class match if they share more than half of their union: no segment can
    /// match twice.
    fn run(&mut self) {
        let mut truth = self.overlaps.truth.clone();
        let mut prediction = self.overlaps.prediction.clone();
        for (&(t, p), &shared) in &self.overlaps.both {
            let union = self.overlaps.truth[&t] + self.overlaps.prediction[&p]
                - shared
                - self.overlaps.shared(Segment::VOID, p);
            if t.class == p.class && self.is_class(t) && 2 * shared > union {
                self.classes[usize::from(t.class)].matched.add(shared as f64 / union as f64);
                truth.remove(&t);
                prediction.remove(&p);
            }
        }
        truth.into_iter().for_each(|(segment, voxels)| self.miss(segment, voxels));
        prediction.into_iter().for_each(|(segment, voxels)| self.suspect(segment, voxels));
    }

    fn miss(&mut self, truth: Segment, voxels: u64) {
        if self.is_class(truth) && voxels >= self.rules.min_segment_voxels {
            self.classes[usize::from(truth.class)].missed += 1;
        }
    }

    /// A segment that lies mostly where truth says nothing is not wrong.
    fn suspect(&mut self, predicted: Segment, voxels: u64) {
        let in_void = self.overlaps.shared(Segment::VOID, predicted);
        let is_judged = voxels >= self.rules.min_segment_voxels && 2 * in_void <= voxels;
        if self.is_class(predicted) && is_judged {
            self.classes[usize::from(predicted.class)].spurious += 1;
        }
    }

    fn is_class(&self, segment: Segment) -> bool {
        segment.class < self.rules.free()
    }
}

#[cfg(test)]
mod tests {
    use super::super::scorer::tests::{pair, row};
    use super::*;
    use occlabel_core::ClassId;

    /// Class 0 is a thing, 1 is stuff, 2 is free.
    fn tally(truth: (&[u8], &[u16]), prediction: (&[u8], &[u16]), min: u64) -> Vec<ClassTally> {
        let rules = ScoringRules {
            classes: vec!["car".into(), "road".into()],
            things: [ClassId(0)].into_iter().collect(),
            min_segment_voxels: min,
            ..row(truth.0.len(), 1.0)
        };
        let mut grids = pair(&rules, truth.0, prediction.0);
        grids.instances(truth.1, prediction.1);
        PanopticTally::of(&grids.scored(), &rules).classes
    }

    fn class(overlaps: &[f64], missed: u64, spurious: u64) -> ClassTally {
        let mut tally = ClassTally { missed, spurious, ..ClassTally::default() };
        overlaps.iter().for_each(|&overlap| tally.matched.add(overlap));
        tally
    }

    #[test]
    fn more_than_half_of_the_union_is_a_match() {
        // Three of four; then two of four, which is not more than half.
        let three = tally((&[0; 4], &[1; 4]), (&[0, 0, 0, 2], &[7; 4]), 0);
        assert_eq!(three[0], class(&[0.75], 0, 0));
        let half = tally((&[0; 4], &[1; 4]), (&[0, 0, 2, 2], &[7; 4]), 0);
        assert_eq!(half[0], class(&[], 1, 1));
    }

    #[test]
    fn things_are_told_apart_and_stuff_is_one_segment() {
        let truth: (&[u8], &[u16]) = (&[0, 0, 0, 0, 1, 1], &[1, 1, 2, 2, 5, 6]);
        let prediction: (&[u8], &[u16]) = (&[0, 0, 0, 0, 1, 1], &[3, 3, 3, 4, 8, 8]);
        let tally = tally(truth, prediction, 0);
        assert_eq!(tally[0], class(&[2.0 / 3.0], 1, 1));
        assert_eq!(tally[1], class(&[1.0], 0, 0));
    }

    #[test]
    fn what_truth_leaves_open_counts_neither_for_nor_against() {
        // Two of the five predicted voxels lie in void: 3 of 3 remain.
        let tally_in = |truth: &[u8]| tally((truth, &[1; 5]), (&[0; 5], &[1; 5]), 0)[0];
        assert_eq!(tally_in(&[0, 0, 0, 255, 255]), class(&[1.0], 0, 0));
        // Three of five in void, the rest on the road: not judged; two of five: judged.
        assert_eq!(tally_in(&[1, 1, 255, 255, 255]), class(&[], 0, 0));
        assert_eq!(tally_in(&[1, 1, 1, 255, 255]), class(&[], 0, 1));
    }

    #[test]
    fn small_segments_without_a_match_are_passed_over() {
        let truth: (&[u8], &[u16]) = (&[0, 2, 2, 2], &[1, 0, 0, 0]);
        let prediction: (&[u8], &[u16]) = (&[2, 0, 0, 2], &[0, 1, 1, 0]);
        assert_eq!(tally(truth, prediction, 2)[0], class(&[], 0, 1));
    }
}
