//! F-score and chamfer distance of the occupied voxels' centres.

use std::ops::AddAssign;

use occlabel_core::ClassId;
use serde::Serialize;

use super::distances::squared_to_nearest;
use super::rules::{ScoringRules, UNLABELLED};
use super::scorer::ScoredPair;
use crate::exact_mean::ExactMean;

/// The published evaluator adds this to each share before it inverts it.
const EPSILON: f64 = 1e-8;

/// A distance within this share of the threshold is at it, which is not below it: centres of a
/// 0.5 m lattice are 0.5 m apart.
const AT_THRESHOLD: f64 = 1e-9;

/// Shares and distances of keyframes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FScoreTally {
    completeness: ExactMean,
    accuracy: ExactMean,
    f_score: ExactMean,
    chamfer_m: ExactMean,
}

/// F-score and its parts, each a mean over keyframes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FScores {
    /// Harmonic mean of the two shares, keyframe by keyframe.
    pub f_score: Option<f64>,
    /// Share of true voxels with a predicted one nearer than the threshold.
    pub completeness: Option<f64>,
    /// Share of predicted voxels with a true one nearer than the threshold.
    pub accuracy: Option<f64>,
    /// Mean distance from predicted to nearest true voxel, and from true to nearest predicted one,
    /// added, metres; over keyframes that have both.
    pub chamfer_m: Option<f64>,
    /// The threshold, metres.
    pub threshold_m: f64,
    /// How many keyframes there were.
    pub keyframes: u64,
    /// In how many of them truth and prediction both have an occupied voxel.
    pub keyframes_with_both: u64,
}

impl FScoreTally {
    /// Of one keyframe, whose ids and shapes are checked.
    pub(crate) fn of(pair: &ScoredPair, rules: &ScoringRules) -> Self {
        let truth = occupied(pair, pair.truth.semantics.values(), rules);
        let prediction = occupied(pair, pair.prediction.semantics.values(), rules);
        let to_prediction = squared_to_nearest(&prediction, &truth, &rules.spec);
        let to_truth = squared_to_nearest(&truth, &prediction, &rules.spec);
        let has_both = !to_prediction.is_empty() && !to_truth.is_empty();
        let share =
            |squared| if has_both { share_below(squared, rules.f_threshold_m) } else { 0.0 };
        let (completeness, accuracy) = (share(&to_prediction), share(&to_truth));
        let f_score = 2.0 / (1.0 / (accuracy + EPSILON) + 1.0 / (completeness + EPSILON));
        let mut tally = Self::default();
        tally.completeness.add(completeness);
        tally.accuracy.add(accuracy);
        tally.f_score.add(if has_both { f_score } else { 0.0 });
        if has_both {
            tally.chamfer_m.add(mean_root(&to_truth) + mean_root(&to_prediction));
        }
        tally
    }

    /// Takes the means.
    pub(crate) fn scores(&self, rules: &ScoringRules) -> FScores {
        FScores {
            f_score: self.f_score.mean(),
            completeness: self.completeness.mean(),
            accuracy: self.accuracy.mean(),
            chamfer_m: self.chamfer_m.mean(),
            threshold_m: rules.f_threshold_m,
            keyframes: self.f_score.count(),
            keyframes_with_both: self.chamfer_m.count(),
        }
    }
}

impl AddAssign<&FScoreTally> for FScoreTally {
    fn add_assign(&mut self, other: &Self) {
        self.completeness += other.completeness;
        self.accuracy += other.accuracy;
        self.f_score += other.f_score;
        self.chamfer_m += other.chamfer_m;
    }
}

/// Where a grid is occupied, within the mask, by a class that is not ignored. A predicted voxel counts
/// where truth says nothing, too, as published.
fn occupied(pair: &ScoredPair, semantics: &[u8], rules: &ScoringRules) -> Vec<bool> {
    let is_occupied = |class: u8| {
        class != rules.free() && class != UNLABELLED && !rules.ignored.contains(ClassId(class))
    };
    match pair.mask {
        None => semantics.iter().map(|&class| is_occupied(class)).collect(),
        Some(mask) => {
            let masked = semantics.iter().zip(mask.values());
            masked.map(|(&class, &seen)| seen != 0 && is_occupied(class)).collect()
        }
    }
}

fn share_below(squared: &[f64], threshold_m: f64) -> f64 {
    let limit = threshold_m * threshold_m * (1.0 - AT_THRESHOLD);
    squared.iter().filter(|&&squared| squared < limit).count() as f64 / squared.len() as f64
}

fn mean_root(squared: &[f64]) -> f64 {
    squared.iter().map(|squared| squared.sqrt()).sum::<f64>() / squared.len() as f64
}

#[cfg(test)]
mod tests {
    use super::super::scorer::tests::{pair, row};
    use super::*;

    fn scores(truth: &[u8], prediction: &[u8], size_m: f64, threshold_m: f64) -> FScores {
        let (rules, truth, prediction) = (row(truth.len(), size_m), truth, prediction);
        let rules = ScoringRules { f_threshold_m: threshold_m, ..rules };
        let grids = pair(&rules, truth, prediction);
        FScoreTally::of(&grids.scored(), &rules).scores(&rules)
    }

    #[test]
    fn a_neighbour_at_the_threshold_is_not_below_it() {
        // One voxel to the side: 0.5 m.
        let at = scores(&[0, 1, 1, 1], &[1, 0, 1, 1], 0.5, 0.5);
        assert_eq!((at.completeness, at.accuracy), (Some(0.0), Some(0.0)));
        let below = scores(&[0, 1, 1, 1], &[1, 0, 1, 1], 0.5, 0.6);
        assert_eq!((below.completeness, below.accuracy), (Some(1.0), Some(1.0)));
        assert!((at.chamfer_m.unwrap() - 1.0).abs() < 1e-12, "half a metre there and back");
    }

    #[test]
    fn shares_are_of_each_sides_own_voxels() {
        let scores = scores(&[0, 0, 1, 1, 1, 0], &[0, 1, 1, 1, 1, 1], 0.4, 0.6);
        assert_eq!(scores.completeness, Some(2.0 / 3.0), "the last is far from any");
        assert_eq!(scores.accuracy, Some(1.0));
        assert!((scores.f_score.unwrap() - 0.8).abs() < 1e-7);
    }

    #[test]
    fn a_keyframe_with_nothing_on_one_side_scores_nothing() {
        for (truth, prediction) in [([1, 1], [0, 1]), ([0, 1], [1, 1]), ([1, 1], [1, 1])] {
            let scores = scores(&truth, &prediction, 0.4, 0.6);
            assert_eq!((scores.f_score, scores.chamfer_m), (Some(0.0), None));
            assert_eq!((scores.keyframes, scores.keyframes_with_both), (1, 0));
        }
    }
}
