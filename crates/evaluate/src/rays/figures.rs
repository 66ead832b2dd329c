//! RayIoU, as ratios.

use serde::Serialize;

use super::tally::RayTally;

/// RayIoU of everything that was counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayIou {
    /// The mean over all thresholds and classes, from 0 to 1; `None` if no class was met.
    pub mean: Option<f64>,
    /// Threshold by threshold.
    pub by_threshold: Vec<RayIouAt>,
    /// By class: rays that it stops in the truth.
    pub truth_rays: Vec<u64>,
    /// By class: rays that it stops in the prediction, where something stops them in the truth.
    pub predicted_rays: Vec<u64>,
}

/// RayIoU at a threshold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayIouAt {
    /// How far depths may be apart, metres.
    pub threshold_m: f64,
    /// The mean over the classes that were met.
    pub mean: Option<f64>,
    /// By class; `None` where neither truth nor prediction has a ray. A class that is predicted
    /// though the truth has none of it counts as 0.
    pub by_class: Vec<Option<f64>>,
}

impl RayTally {
    /// The ratios.
    pub fn ray_iou(&self) -> RayIou {
        let thresholds = self.thresholds_m.iter().zip(&self.right);
        let by_threshold: Vec<RayIouAt> =
            thresholds.map(|(threshold_m, right)| self.at(*threshold_m, right)).collect();
        RayIou {
            mean: mean(by_threshold.iter().flat_map(|at| &at.by_class)),
            by_threshold,
            truth_rays: self.truth.clone(),
            predicted_rays: self.prediction.clone(),
        }
    }

    fn at(&self, threshold_m: f64, right: &[u64]) -> RayIouAt {
        let classes = self.truth.iter().zip(&self.prediction).zip(right);
        let iou = |((truth, prediction), right): ((&u64, &u64), &u64)| {
            let either = truth + prediction - right;
            (either > 0).then(|| *right as f64 / either as f64)
        };
        let by_class: Vec<Option<f64>> = classes.map(iou).collect();
        RayIouAt { threshold_m, mean: mean(&by_class), by_class }
    }
}

/// The mean of what there is; `None` if there is nothing.
pub(super) fn mean<'a>(values: impl IntoIterator<Item = &'a Option<f64>>) -> Option<f64> {
    let values: Vec<f64> = values.into_iter().copied().flatten().collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
