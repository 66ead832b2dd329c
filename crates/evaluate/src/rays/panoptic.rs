//! RayPQ: panoptic quality along rays.

use serde::Serialize;

use super::figures::mean;
use super::pairs::RayPair;
use super::panoptic_frame::{Fate, Frame, InstanceGrids};
use crate::exact_sum::ExactSum;

/// Segments by threshold and class, before any ratio is taken. Tallies of keyframes add up in any
/// order.
#[derive(Clone, Debug, PartialEq)]
pub struct PanopticTally {
    things: Vec<u8>,
    thresholds_m: Vec<f64>,
    counts: Vec<Vec<Counts>>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Counts {
    matched: u64,
    missed: u64,
    invented: u64,
    ious: ExactSum,
}

/// RayPQ of everything that was counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayPq {
    /// The mean PQ over all thresholds and classes; `None` if there was no segment.
    pub mean: Option<f64>,
    /// Threshold by threshold.
    pub by_threshold: Vec<RayPqAt>,
}

/// RayPQ at a threshold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayPqAt {
    /// How far depths may be apart, metres.
    pub threshold_m: f64,
    /// The means over the classes that have a segment, matched or in error.
    pub pq: Option<f64>,
    /// The same of SQ.
    pub sq: Option<f64>,
    /// The same of RQ.
    pub rq: Option<f64>,
    /// By class; `None` where there is no such segment.
    pub by_class: Vec<Option<RayPqClass>>,
}

/// RayPQ of a class.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RayPqClass {
    /// Panoptic quality: SQ times RQ.
    pub pq: f64,
    /// Segmentation quality: the mean IoU of matched segments, 0 without any.
    pub sq: f64,
    /// Recognition quality: matched segments among all, those in error by halves.
    pub rq: f64,
    /// Segments of the truth and the prediction that match.
    pub matched: u64,
    /// Segments of the truth without a match.
    pub missed: u64,
    /// Segments of the prediction without a match.
    pub invented: u64,
}

impl PanopticTally {
    /// Nothing yet, of so many classes (free not among them) and thresholds of depth, metres; the
    /// instances of `things` are segments of their own.
    pub fn new(classes: usize, things: &[u8], thresholds_m: &[f64]) -> Self {
        let counts = vec![vec![Counts::default(); classes]; thresholds_m.len()];
        Self { things: things.to_vec(), thresholds_m: thresholds_m.to_vec(), counts }
    }

    /// Counts the segments of a keyframe.
    ///
    /// A segment of the truth is an instance of a thing whose rays see one class only, or all else of
    /// a class; one of the prediction is what has one class and one instance.
    pub fn count(&mut self, pairs: &[RayPair], truth: InstanceGrids, prediction: InstanceGrids) {
        let frame = Frame::new(pairs, truth, prediction, |class| self.things.contains(&class));
        for (counts, threshold_m) in self.counts.iter_mut().zip(&self.thresholds_m) {
            for (class, fate) in frame.fates(*threshold_m) {
                counts[usize::from(class)].count(fate);
            }
        }
    }

    /// Adds the segments of another tally of the same classes, things and thresholds.
    ///
    /// # Panics
    /// If they differ.
    pub fn add(&mut self, other: &Self) {
        let kind = |tally: &Self| (tally.things.clone(), tally.thresholds_m.clone());
        assert_eq!(kind(self), kind(other), "tallies of the same things and thresholds");
        let classes = |tally: &Self| tally.counts.first().map(Vec::len);
        assert_eq!(classes(self), classes(other), "tallies of the same classes");
        let pairs = self.counts.iter_mut().flatten().zip(other.counts.iter().flatten());
        pairs.for_each(|(sum, counts)| sum.add(counts));
    }

    /// The ratios.
    pub fn ray_pq(&self) -> RayPq {
        let thresholds = self.thresholds_m.iter().zip(&self.counts);
        let by_threshold: Vec<RayPqAt> =
            thresholds.map(|(threshold_m, counts)| at(*threshold_m, counts)).collect();
        let all = by_threshold.iter().flat_map(|at| &at.by_class);
        let pqs: Vec<Option<f64>> = all.map(|class| class.map(|class| class.pq)).collect();
        RayPq { mean: mean(&pqs), by_threshold }
    }
}

impl Counts {
    fn count(&mut self, fate: Fate) {
        match fate {
            Fate::Matched(iou) => {
                self.matched += 1;
                self.ious.add(iou);
            }
            Fate::Missed => self.missed += 1,
            Fate::Invented => self.invented += 1,
        }
    }

    fn add(&mut self, other: &Self) {
        self.matched += other.matched;
        self.missed += other.missed;
        self.invented += other.invented;
        self.ious += other.ious;
    }

    fn ratios(&self) -> Option<RayPqClass> {
        let Self { matched, missed, invented, ious } = *self;
        if matched + missed + invented == 0 {
            return None;
        }
        let sq = if matched > 0 { ious.value() / matched as f64 } else { 0.0 };
        let rq = matched as f64 / (matched as f64 + 0.5 * (missed + invented) as f64);
        Some(RayPqClass { pq: sq * rq, sq, rq, matched, missed, invented })
    }
}

fn at(threshold_m: f64, counts: &[Counts]) -> RayPqAt {
    let by_class: Vec<Option<RayPqClass>> = counts.iter().map(Counts::ratios).collect();
    let mean_of = |figure: fn(&RayPqClass) -> f64| {
        let figures: Vec<Option<f64>> =
            by_class.iter().map(|class| class.as_ref().map(figure)).collect();
        mean(&figures)
    };
    let [pq, sq, rq] = [mean_of(|c| c.pq), mean_of(|c| c.sq), mean_of(|c| c.rq)];
    RayPqAt { threshold_m, pq, sq, rq, by_class }
}
