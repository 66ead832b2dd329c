//! The confusion of classes.

use std::ops::AddAssign;

use occlabel_core::{ClassId, ClassSet};

use super::pair_counts::PairCounts;
use super::rules::UNLABELLED;

/// Voxels by true class (rows) and predicted class (columns): the classes, free, and in the columns
/// a last one for voxels of which the prediction says nothing.
///
/// Voxels of which truth says nothing, or an ignored class, are not in it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Confusion {
    classes: usize,
    counts: Vec<u64>,
}

impl Confusion {
    /// No voxel yet, for so many classes without free.
    pub fn new(classes: usize) -> Self {
        Self { classes, counts: vec![0; (classes + 1) * (classes + 2)] }
    }

    /// The confusion that pairs of ids make.
    pub(crate) fn of_pairs(pairs: &PairCounts, classes: usize, ignored: &ClassSet) -> Self {
        let mut confusion = Self::new(classes);
        for truth in (0..=classes).filter(|&truth| !ignored.contains(ClassId(truth as u8))) {
            for predicted in 0..=classes {
                confusion.counts[truth * (classes + 2) + predicted] = pairs.of(truth, predicted);
            }
            confusion.counts[truth * (classes + 2) + classes + 1] =
                pairs.of(truth, UNLABELLED.into());
        }
        confusion
    }

    /// How many classes there are, without free.
    pub fn classes(&self) -> usize {
        self.classes
    }

    /// Voxels of a true class that are predicted so; `classes()` is free, and as a prediction
    /// `classes() + 1` is nothing.
    #[inline]
    pub fn at(&self, truth: usize, predicted: usize) -> u64 {
        self.counts[truth * (self.classes + 2) + predicted]
    }

    /// The rows, each of a true class.
    pub fn rows(&self) -> impl Iterator<Item = &[u64]> {
        self.counts.chunks(self.classes + 2)
    }

    /// All voxels.
    pub fn voxels(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Voxels of a true class.
    pub fn of_truth(&self, class: usize) -> u64 {
        (0..self.classes + 2).map(|predicted| self.at(class, predicted)).sum()
    }

    /// Voxels predicted as a class.
    pub fn of_prediction(&self, class: usize) -> u64 {
        (0..=self.classes).map(|truth| self.at(truth, class)).sum()
    }

    /// Voxels whose class is right, free among them.
    pub fn right(&self) -> u64 {
        (0..=self.classes).map(|class| self.at(class, class)).sum()
    }

    /// Intersection over union of a class; none if it is neither in truth nor predicted.
    pub fn iou(&self, class: usize) -> Option<f64> {
        let both = self.at(class, class);
        ratio(both, self.of_truth(class) + self.of_prediction(class) - both)
    }
}

impl AddAssign<&Confusion> for Confusion {
    /// # Panics
    /// If the classes differ in number. An empty confusion fits every other.
    fn add_assign(&mut self, other: &Self) {
        if self.counts.is_empty() {
            return self.clone_from(other);
        }
        assert!(other.counts.is_empty() || self.classes == other.classes, "one class table");
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
    }
}

/// How many of how many; none of nothing.
pub(crate) fn ratio(part: u64, all: u64) -> Option<f64> {
    (all > 0).then(|| part as f64 / all as f64)
}

/// The mean of those numbers that are there; none of none.
pub(crate) fn mean(numbers: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let numbers: Vec<f64> = numbers.flatten().collect();
    (!numbers.is_empty()).then(|| numbers.iter().sum::<f64>() / numbers.len() as f64)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The confusion of two lists of ids.
    pub(crate) fn confusion(truth: &[u8], prediction: &[u8], classes: usize) -> Confusion {
        let mut pairs = PairCounts::new();
        pairs.count(truth, prediction, None);
        Confusion::of_pairs(&pairs, classes, &ClassSet::default())
    }

    #[test]
    fn what_truth_leaves_open_is_left_out() {
        let all = confusion(&[0, 1, 255, 255], &[0, 0, 0, 255], 1);
        assert_eq!(all.rows().collect::<Vec<_>>(), [[1, 0, 0], [1, 0, 0]]);
        let mut pairs = PairCounts::new();
        pairs.count(&[0, 1, 2], &[0, 0, 0], None);
        let ignored = [ClassId(0)].into_iter().collect();
        assert_eq!(Confusion::of_pairs(&pairs, 2, &ignored).voxels(), 2);
    }

    #[test]
    fn a_prediction_that_says_nothing_misses_the_truth_and_names_no_class() {
        let silent = confusion(&[0, 0, 0, 1], &[0, 0, 255, 1], 1);
        assert_eq!(silent.iou(0), Some(2.0 / 3.0));
        assert_eq!(silent.iou(1), Some(1.0), "free has no false voxel by it");
    }

    #[test]
    fn confusions_add_up() {
        let mut sum = Confusion::default();
        sum += &confusion(&[0, 1], &[1, 1], 1);
        sum += &confusion(&[0], &[0], 1);
        assert_eq!(sum, confusion(&[0, 0, 1], &[0, 1, 1], 1));
    }
}
