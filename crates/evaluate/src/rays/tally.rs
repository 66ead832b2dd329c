//! RayIoU, counted.

use occlabel_core::VoxelGrid;

use super::pairs::RayPair;

/// How far depths may be apart, metres, as published.
pub const THRESHOLDS_M: [f64; 3] = [1.0, 2.0, 4.0];

/// Rays by class, before any ratio is taken. Tallies of keyframes add up in any order.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTally {
    pub(super) thresholds_m: Vec<f64>,
    /// By class: rays that it stops in the truth, and of these in the prediction.
    pub(super) truth: Vec<u64>,
    pub(super) prediction: Vec<u64>,
    /// By threshold and class: rays stopped by the class in both, at about the same depth.
    pub(super) right: Vec<Vec<u64>>,
}

impl RayTally {
    /// Nothing yet, of so many classes (free not among them) and thresholds of depth, metres.
    pub fn new(classes: usize, thresholds_m: &[f64]) -> Self {
        Self {
            thresholds_m: thresholds_m.to_vec(),
            truth: vec![0; classes],
            prediction: vec![0; classes],
            right: vec![vec![0; classes]; thresholds_m.len()],
        }
    }

    /// Counts the rays of a keyframe in its grids of classes.
    pub fn count(&mut self, pairs: &[RayPair], truth: &VoxelGrid<u8>, prediction: &VoxelGrid<u8>) {
        for pair in pairs {
            let class = usize::from(truth.values()[pair.truth.flat as usize]);
            self.truth[class] += 1;
            let Some(hit) = pair.prediction else { continue };
            let predicted = usize::from(prediction.values()[hit.flat as usize]);
            self.prediction[predicted] += 1;
            if predicted == class {
                self.count_right(class, (hit.depth_m - pair.truth.depth_m).abs());
            }
        }
    }

    fn count_right(&mut self, class: usize, error_m: f64) {
        for (right, threshold_m) in self.right.iter_mut().zip(&self.thresholds_m) {
            right[class] += u64::from(error_m < *threshold_m);
        }
    }

    /// Adds the rays of another tally of the same classes and thresholds.
    ///
    /// # Panics
    /// If classes or thresholds differ.
    pub fn add(&mut self, other: &Self) {
        assert_eq!(self.thresholds_m, other.thresholds_m, "tallies of the same thresholds");
        assert_eq!(self.truth.len(), other.truth.len(), "tallies of the same classes");
        add_up(&mut self.truth, &other.truth);
        add_up(&mut self.prediction, &other.prediction);
        self.right.iter_mut().zip(&other.right).for_each(|(sum, right)| add_up(sum, right));
    }
}

fn add_up(sums: &mut [u64], counts: &[u64]) {
    sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
}
