//! Scores of classes, from their confusion: mIoU as Occ3D and the CVPR 2023 challenge have it.

use serde::Serialize;

use super::completion::CompletionScores;
use super::confusion::{Confusion, mean, ratio};
use super::rules::ScoringRules;

/// Scores of classes over a set of voxels. Ratios are from 0 to 1; none where nothing was asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SemanticScores {
    /// How many voxels were asked.
    pub voxels: u64,
    /// Mean IoU over those classes that truth has, free not among them.
    pub miou: Option<f64>,
    /// Share of voxels whose class is right, free among them.
    pub accuracy: Option<f64>,
    /// Mean F1 over those classes that truth has, free not among them.
    pub f1: Option<f64>,
    /// Occupied or not, whatever the class.
    pub occupied: BinaryScores,
    /// As SemanticKITTI and SSCBench count it.
    pub completion: CompletionScores,
    /// By class, free last.
    pub classes: Vec<ClassScores>,
    /// Rows truth, columns prediction: the classes, free, and as a last column no label.
    pub confusion: Vec<Vec<u64>>,
}

/// Overlap, precision and recall of a set of voxels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BinaryScores {
    /// Intersection over union.
    pub iou: Option<f64>,
    /// Of what is predicted, the share that is true.
    pub precision: Option<f64>,
    /// Of what is true, the share that is predicted.
    pub recall: Option<f64>,
}

/// The scores of one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassScores {
    /// Its name.
    pub class: String,
    /// Intersection over union; none if truth has no voxel of it.
    pub iou: Option<f64>,
    /// Of its predicted voxels, the share that is true.
    pub precision: Option<f64>,
    /// Of its true voxels, the share that is predicted.
    pub recall: Option<f64>,
    /// 2 TP / (2 TP + FP + FN); none if truth has no voxel of it.
    pub f1: Option<f64>,
    /// Its voxels in truth.
    pub truth: u64,
    /// Its voxels in the prediction.
    pub prediction: u64,
}

impl SemanticScores {
    /// The scores that a confusion gives.
    pub fn of(confusion: &Confusion, rules: &ScoringRules) -> Self {
        let names = rules.classes.iter().map(String::as_str).chain(["free"]);
        let classes: Vec<_> = names
            .enumerate()
            .map(|(class, name)| ClassScores::of(confusion, class, name))
            .collect();
        let named = &classes[..confusion.classes()];
        Self {
            voxels: confusion.voxels(),
            miou: mean(named.iter().map(|class| class.iou)),
            accuracy: ratio(confusion.right(), confusion.voxels()),
            f1: mean(named.iter().map(|class| class.f1)),
            occupied: BinaryScores::of_occupied(confusion),
            completion: CompletionScores::of(confusion, &rules.ignored),
            confusion: confusion.rows().map(<[u64]>::to_vec).collect(),
            classes,
        }
    }
}

impl ClassScores {
    fn of(confusion: &Confusion, class: usize, name: &str) -> Self {
        let both = confusion.at(class, class);
        let (truth, prediction) = (confusion.of_truth(class), confusion.of_prediction(class));
        let if_in_truth = |score: Option<f64>| score.filter(|_| truth > 0);
        Self {
            class: name.into(),
            iou: if_in_truth(confusion.iou(class)),
            precision: ratio(both, prediction),
            recall: ratio(both, truth),
            f1: if_in_truth(ratio(2 * both, truth + prediction)),
            truth,
            prediction,
        }
    }
}

impl BinaryScores {
    /// Of occupied voxels: any class in truth, any class in the prediction.
    pub(crate) fn of_occupied(confusion: &Confusion) -> Self {
        let classes = 0..confusion.classes();
        let truth: u64 = classes.clone().map(|class| confusion.of_truth(class)).sum();
        let prediction: u64 = classes.clone().map(|class| confusion.of_prediction(class)).sum();
        let both: u64 = classes
            .clone()
            .flat_map(|truth| classes.clone().map(move |predicted| (truth, predicted)))
            .map(|(truth, predicted)| confusion.at(truth, predicted))
            .sum();
        Self {
            iou: ratio(both, truth + prediction - both),
            precision: ratio(both, prediction),
            recall: ratio(both, truth),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::confusion::tests::confusion;
    use super::*;
    use occlabel_core::GridSpec;

    fn scores(truth: &[u8], prediction: &[u8]) -> SemanticScores {
        let spec = GridSpec::new([0.0; 3], [1.0; 3], [1.0; 3]).unwrap();
        let rules = ScoringRules::new(spec, ["car", "bus", "road"].map(String::from).to_vec());
        SemanticScores::of(&confusion(truth, prediction, 3), &rules)
    }

    #[test]
    fn a_class_absent_from_truth_is_set_aside_even_if_predicted() {
        let scores = scores(&[0, 0, 3], &[0, 1, 3]);
        assert_eq!((scores.classes[1].iou, scores.classes[1].prediction), (None, 1));
        assert_eq!(scores.miou, Some(0.5), "of the car alone");
    }

    #[test]
    fn free_is_in_the_matrix_but_not_in_the_mean() {
        // One of two cars is called free, one free voxel a car.
        let scores = scores(&[0, 0, 3, 3], &[0, 3, 0, 3]);
        assert_eq!(scores.miou, Some(1.0 / 3.0));
        assert_eq!(scores.classes[3].iou, Some(1.0 / 3.0));
        assert_eq!(scores.accuracy, Some(0.5));
    }

    #[test]
    fn occupied_is_right_whatever_the_class() {
        let scores = scores(&[0, 1, 2, 3], &[1, 0, 3, 2]);
        assert_eq!(scores.miou, Some(0.0));
        assert_eq!(scores.occupied.iou, Some(0.5));
        assert_eq!(scores.occupied.precision, Some(2.0 / 3.0));
        assert_eq!(scores.occupied.recall, Some(2.0 / 3.0));
    }
}
