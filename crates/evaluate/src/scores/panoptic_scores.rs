//! PQ, SQ and RQ from matches and misses.

use occlabel_core::ClassId;
use serde::Serialize;

use super::confusion::mean;
use super::panoptic::{ClassTally, PanopticTally};
use super::rules::ScoringRules;

/// Panoptic scores. Ratios are from 0 to 1; none where nothing was asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PanopticScores {
    /// Over all classes that have a segment on either side.
    pub all: PanopticMeans,
    /// Over those of them that are things.
    pub things: PanopticMeans,
    /// Over those of them that are not.
    pub stuff: PanopticMeans,
    /// PQ-dagger (Porzi et al. 2019): PQ of things, and of stuff the IoU over the whole set.
    pub pq_dagger: Option<f64>,
    /// By class.
    pub classes: Vec<ClassPanoptic>,
}

/// Means over classes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PanopticMeans {
    /// Panoptic quality.
    pub pq: Option<f64>,
    /// Segmentation quality: mean IoU of matches.
    pub sq: Option<f64>,
    /// Recognition quality: F1 of segments.
    pub rq: Option<f64>,
}

/// The scores of one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassPanoptic {
    /// Its name.
    pub class: String,
    /// Whether its instances are told apart.
    pub is_thing: bool,
    /// SQ times RQ.
    pub pq: Option<f64>,
    /// Mean IoU of matches; 0 if segments are there but none matches.
    pub sq: Option<f64>,
    /// TP / (TP + FP / 2 + FN / 2).
    pub rq: Option<f64>,
    /// Matched segments.
    pub matched: u64,
    /// Segments of truth without a match.
    pub missed: u64,
    /// Predicted segments without a match.
    pub spurious: u64,
}

impl PanopticTally {
    /// Takes the ratios.
    pub(crate) fn scores(&self, rules: &ScoringRules) -> PanopticScores {
        let scored = self.classes.iter().enumerate();
        let classes: Vec<_> =
            scored.map(|(class, tally)| ClassPanoptic::of(tally, class, rules)).collect();
        let dagger = classes.iter().enumerate().map(|(class, scores)| match scores.is_thing {
            true => scores.pq,
            false => scores.pq.and_then(|_| self.confusion.iou(class)),
        });
        PanopticScores {
            all: PanopticMeans::of(&classes, |_| true),
            things: PanopticMeans::of(&classes, |class| class.is_thing),
            stuff: PanopticMeans::of(&classes, |class| !class.is_thing),
            pq_dagger: mean(dagger),
            classes,
        }
    }
}

impl PanopticMeans {
    fn of(classes: &[ClassPanoptic], is_asked: impl Fn(&ClassPanoptic) -> bool) -> Self {
        let over = |score: fn(&ClassPanoptic) -> Option<f64>| {
            mean(classes.iter().filter(|class| is_asked(class)).map(score))
        };
        Self { pq: over(|class| class.pq), sq: over(|class| class.sq), rq: over(|class| class.rq) }
    }
}

impl ClassPanoptic {
    fn of(tally: &ClassTally, class: usize, rules: &ScoringRules) -> Self {
        let matched = tally.matched.count();
        let halves = 2 * matched + tally.missed + tally.spurious;
        let is_there = |score: f64| (halves > 0).then_some(score);
        let sq = tally.matched.mean().unwrap_or(0.0);
        let rq = 2.0 * matched as f64 / halves as f64;
        Self {
            class: rules.classes[class].clone(),
            is_thing: rules.things.contains(ClassId(class as u8)),
            pq: is_there(sq * rq),
            sq: is_there(sq),
            rq: is_there(rq),
            matched,
            missed: tally.missed,
            spurious: tally.spurious,
        }
    }
}
