//! Velocity errors of voxels and detections: MobileOcc's AVE-T, AVE-O, AVE-D.

use std::ops::AddAssign;

use occlabel_core::{ClassId, VoxelGrid};
use serde::Serialize;

use super::confusion::mean;
use super::detections::{detections, distance, matches};
use super::rules::ScoringRules;
use super::scorer::ScoredPair;
use crate::exact_mean::ExactMean;

/// Errors by class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VelocityTally {
    classes: Vec<ClassTally>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct ClassTally {
    total: ExactMean,
    occupied: ExactMean,
    detected: ExactMean,
    /// Voxels whose true velocity is not known.
    unknown: u64,
}

/// Mean lengths of horizontal velocity errors, m/s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VelocityScores {
    /// AVE-T, over all true voxels of a class: mean over classes.
    pub ave_t_mps: Option<f64>,
    /// AVE-O, over those whose predicted class is right: mean over classes.
    pub ave_o_mps: Option<f64>,
    /// AVE-D, over detections that are right: mean over classes.
    pub ave_d_mps: Option<f64>,
    /// By class, those whose velocity is asked for.
    pub classes: Vec<ClassVelocity>,
}

/// The errors of one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassVelocity {
    /// Its name.
    pub class: String,
    /// Over all its true voxels, m/s.
    pub ave_t_mps: Option<f64>,
    /// Over those predicted as the class, m/s.
    pub ave_o_mps: Option<f64>,
    /// Over its matched detections, m/s.
    pub ave_d_mps: Option<f64>,
    /// How many true voxels there were.
    pub voxels: u64,
    /// How many of them were predicted as the class.
    pub right: u64,
    /// How many detections matched.
    pub detections: u64,
    /// True voxels whose velocity truth does not know: left out.
    pub unknown: u64,
}

impl VelocityTally {
    /// Of one keyframe, whose ids and shapes are checked. Where the prediction's velocity is no
    /// number, it counts as standing still.
    pub(crate) fn of(pair: &ScoredPair, rules: &ScoringRules) -> Self {
        let mut classes = vec![ClassTally::default(); rules.classes.len()];
        let is_asked = |class: &usize| rules.flow_classes.contains(ClassId(*class as u8));
        if let (Some(truth), Some(prediction)) = (pair.truth.flow, pair.prediction.flow) {
            count_voxels(pair, truth, prediction, rules, &mut classes);
            for class in (0..classes.len()).filter(is_asked) {
                classes[class].detected = detected(pair, class as u8, rules);
            }
        }
        Self { classes }
    }

    /// Takes the means.
    pub(crate) fn scores(&self, rules: &ScoringRules) -> VelocityScores {
        let asked = self.classes.iter().zip(&rules.classes).enumerate();
        let classes: Vec<ClassVelocity> = asked
            .filter(|(class, _)| rules.flow_classes.contains(ClassId(*class as u8)))
            .map(|(_, (tally, name))| tally.scores(name))
            .collect();
        VelocityScores {
            ave_t_mps: mean(classes.iter().map(|class| class.ave_t_mps)),
            ave_o_mps: mean(classes.iter().map(|class| class.ave_o_mps)),
            ave_d_mps: mean(classes.iter().map(|class| class.ave_d_mps)),
            classes,
        }
    }
}

impl AddAssign<&VelocityTally> for VelocityTally {
    fn add_assign(&mut self, other: &Self) {
        self.classes.resize(self.classes.len().max(other.classes.len()), ClassTally::default());
        for (sum, class) in self.classes.iter_mut().zip(&other.classes) {
            sum.total += class.total;
            sum.occupied += class.occupied;
            sum.detected += class.detected;
            sum.unknown += class.unknown;
        }
    }
}

impl ClassTally {
    fn scores(&self, name: &str) -> ClassVelocity {
        ClassVelocity {
            class: name.into(),
            ave_t_mps: self.total.mean(),
            ave_o_mps: self.occupied.mean(),
            ave_d_mps: self.detected.mean(),
            voxels: self.total.count(),
            right: self.occupied.count(),
            detections: self.detected.count(),
            unknown: self.unknown,
        }
    }
}

fn count_voxels(
    pair: &ScoredPair,
    truth: &VoxelGrid<[f32; 3]>,
    prediction: &VoxelGrid<[f32; 3]>,
    rules: &ScoringRules,
    classes: &mut [ClassTally],
) {
    let predicted = pair.prediction.semantics.values();
    for (at, &class) in pair.truth.semantics.values().iter().enumerate() {
        let is_asked = pair.asks(at) && rules.flow_classes.contains(ClassId(class));
        if !is_asked || class >= rules.free() {
            continue;
        }
        let tally = &mut classes[usize::from(class)];
        let Some(true_mps) = horizontal(truth.values()[at]) else {
            tally.unknown += 1;
            continue;
        };
        let error_mps = distance(true_mps, horizontal(prediction.values()[at]).unwrap_or_default());
        tally.total.add(error_mps);
        if predicted[at] == class {
            tally.occupied.add(error_mps);
        }
    }
}

fn detected(pair: &ScoredPair, class: u8, rules: &ScoringRules) -> ExactMean {
    let truth = detections(&pair.truth, pair, class, &rules.spec);
    let prediction = detections(&pair.prediction, pair, class, &rules.spec);
    let mut errors = ExactMean::default();
    for (t, p) in matches(&truth, &prediction, rules.detection_m) {
        errors.add(distance(truth[t].velocity_mps, prediction[p].velocity_mps));
    }
    errors
}

fn horizontal(mps: [f32; 3]) -> Option<[f64; 2]> {
    let [x, y, _] = mps.map(f64::from);
    (x.is_finite() && y.is_finite()).then_some([x, y])
}

#[cfg(test)]
mod tests {
    use super::super::scorer::tests::{pair, row};
    use super::*;

    const STILL: [f32; 3] = [0.0; 3];
    const WALK: [f32; 3] = [3.0, 4.0, 9.0];
    const UNKNOWN: [f32; 3] = [f32::NAN; 3];

    fn scores(flow: [[[f32; 3]; 4]; 2], instances: [[u16; 4]; 2]) -> VelocityScores {
        let rules =
            ScoringRules { flow_classes: [ClassId(0)].into_iter().collect(), ..row(4, 1.0) };
        let mut grids = pair(&rules, &[0, 0, 0, 1], &[0, 0, 1, 0]);
        grids.instances(&instances[0], &instances[1]);
        grids.flow(&flow[0], &flow[1]);
        VelocityTally::of(&grids.scored(), &rules).scores(&rules)
    }

    #[test]
    fn voxels_are_asked_where_truth_has_the_class() {
        // Right by voxel 0, 5 m/s off at 1 and 2, of which 2 is missed.
        let flow = [[WALK, WALK, WALK, STILL], [WALK, STILL, STILL, WALK]];
        let scores = scores(flow, [[1, 1, 1, 0], [0; 4]]);
        assert_eq!(scores.ave_t_mps, Some(10.0 / 3.0), "z is not asked");
        assert_eq!(scores.ave_o_mps, Some(2.5));
        assert_eq!(scores.ave_d_mps, None, "nothing is detected");
    }

    #[test]
    fn an_unknown_truth_is_left_out_and_an_unknown_prediction_stands_still() {
        let flow = [[UNKNOWN, WALK, STILL, STILL], [STILL, UNKNOWN, UNKNOWN, STILL]];
        let class = scores(flow, [[0; 4]; 2]).classes.remove(0);
        assert_eq!((class.ave_t_mps, class.voxels, class.unknown), (Some(2.5), 2, 1));
    }

    #[test]
    fn detections_are_means_over_instances() {
        // Truth: 1 at 1.5 m, mean 10/3; prediction: 7 at 1.0 m and 8 at 3.5 m.
        let flow = [[WALK, WALK, STILL, STILL], [STILL, WALK, STILL, WALK]];
        let scores = scores(flow, [[1, 1, 1, 0], [7, 7, 0, 8]]);
        // (2, 8/3) against (1.5, 2).
        assert!((scores.ave_d_mps.unwrap() - (0.25_f64 + 4.0 / 9.0).sqrt()).abs() < 1e-12);
        assert_eq!(scores.classes[0].detections, 1);
    }
}
