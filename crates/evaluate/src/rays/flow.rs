//! Velocity errors along rays, and the score of the challenge of 2024.

use occlabel_core::VoxelGrid;
use serde::Serialize;

use super::figures::mean;
use super::pairs::RayPair;
use crate::exact_sum::ExactSum;

/// At which threshold a ray counts as right, metres, as published.
const THRESHOLD_M: f64 = 2.0;

/// Velocity errors of rays that are right, by class. Tallies add up in any order.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowTally {
    /// Which classes are asked.
    classes: Vec<u8>,
    /// Of each: rays, and the sum of their errors, m/s.
    rays: Vec<u64>,
    errors: Vec<ExactSum>,
    unknown: u64,
}

/// Average velocity errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FlowScore {
    /// mAVE, m/s: the mean over the classes that have an error; `None` if none has.
    pub mean: Option<f64>,
    /// AVE, m/s, of the classes in the order asked; `None` where no ray is right.
    pub by_class: Vec<Option<f64>>,
    /// Right rays of these classes, whose velocity is unknown (not finite) in truth or prediction.
    pub unknown_rays: u64,
}

/// The classes and velocities of a keyframe: in the truth, and in the prediction.
type Grids<'a> = [(&'a VoxelGrid<u8>, &'a VoxelGrid<[f32; 3]>); 2];

impl FlowTally {
    /// Nothing yet, of these classes.
    pub fn new(classes: &[u8]) -> Self {
        let (count, classes) = (classes.len(), classes.to_vec());
        let (rays, errors) = (vec![0; count], vec![ExactSum::default(); count]);
        Self { classes, rays, errors, unknown: 0 }
    }

    /// Counts the rays of a keyframe in the classes and velocities (m/s, along x and y of the grid
    /// frame) of truth and prediction: those stopped by one class in both, less than 2 m apart.
    pub fn count(&mut self, pairs: &[RayPair], [truth, prediction]: Grids) {
        for pair in pairs {
            let Some(hit) = pair.prediction else { continue };
            let places = [pair.truth.flat as usize, hit.flat as usize];
            let class = truth.0.values()[places[0]];
            let is_right = prediction.0.values()[places[1]] == class
                && (hit.depth_m - pair.truth.depth_m).abs() < THRESHOLD_M;
            let asked = self.classes.iter().position(|asked| *asked == class);
            if let (true, Some(at)) = (is_right, asked) {
                self.measure(at, truth.1.values()[places[0]], prediction.1.values()[places[1]]);
            }
        }
    }

    fn measure(&mut self, at: usize, truth: [f32; 3], prediction: [f32; 3]) {
        let [x, y] = [0, 1].map(|axis| f64::from(prediction[axis]) - f64::from(truth[axis]));
        let error = (x * x + y * y).sqrt();
        if error.is_finite() {
            self.rays[at] += 1;
            self.errors[at].add(error);
        } else {
            self.unknown += 1;
        }
    }

    /// Adds the rays of another tally of the same classes.
    ///
    /// # Panics
    /// If the classes differ.
    pub fn add(&mut self, other: &Self) {
        assert_eq!(self.classes, other.classes, "tallies of the same classes");
        self.rays.iter_mut().zip(&other.rays).for_each(|(sum, rays)| *sum += rays);
        self.errors.iter_mut().zip(&other.errors).for_each(|(sum, errors)| *sum += *errors);
        self.unknown += other.unknown;
    }

    /// The averages.
    pub fn score(&self) -> FlowScore {
        let average =
            |(rays, errors): (&u64, &ExactSum)| (*rays > 0).then(|| errors.value() / *rays as f64);
        let by_class: Vec<Option<f64>> = self.rays.iter().zip(&self.errors).map(average).collect();
        FlowScore { mean: mean(&by_class), by_class, unknown_rays: self.unknown }
    }
}

/// The score of the challenge of 2024, of RayIoU and mAVE (m/s): 0.9 and 0.1 of it; an error of 1 m/s
/// or more gives nothing. `None` if one of the two is unknown.
pub fn challenge_score(ray_iou: Option<f64>, mave: Option<f64>) -> Option<f64> {
    Some(0.9 * ray_iou? + 0.1 * (1.0 - mave?).max(0.0))
}
