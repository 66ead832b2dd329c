//! Scene completion as SemanticKITTI and SSCBench count it.

use occlabel_core::{ClassId, ClassSet};
use serde::Serialize;

use super::confusion::Confusion;
use super::semantic::BinaryScores;

/// Scores of completion; the mask is the voxels that are not invalid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CompletionScores {
    /// Intersection over union of what is occupied; 0 if nothing is.
    pub iou: f64,
    /// Of voxels predicted as occupied, the share that is; 0 if none is predicted.
    pub precision: f64,
    /// Of occupied voxels, the share that is predicted so; 0 if there are none.
    pub recall: f64,
    /// Mean IoU over all classes that are not ignored. One that neither truth nor prediction has
    /// counts as 0: the published evaluators add a small number to each union.
    pub miou: f64,
}

impl CompletionScores {
    /// The scores that a confusion gives.
    pub fn of(confusion: &Confusion, ignored: &ClassSet) -> Self {
        let occupied = BinaryScores::of_occupied(confusion);
        let asked = |class: &usize| !ignored.contains(ClassId(*class as u8));
        let classes: Vec<usize> = (0..confusion.classes()).filter(asked).collect();
        let sum: f64 = classes.iter().map(|&class| confusion.iou(class).unwrap_or(0.0)).sum();
        Self {
            iou: occupied.iou.unwrap_or(0.0),
            precision: occupied.precision.unwrap_or(0.0),
            recall: occupied.recall.unwrap_or(0.0),
            miou: sum / classes.len().max(1) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::confusion::tests::confusion;
    use super::*;

    #[test]
    fn an_absent_class_counts_as_nothing_right() {
        let half = confusion(&[0, 0, 2], &[0, 0, 2], 2);
        assert_eq!(CompletionScores::of(&half, &ClassSet::default()).miou, 0.5);
        let ignored = [ClassId(1)].into_iter().collect();
        assert_eq!(CompletionScores::of(&half, &ignored).miou, 1.0);
    }

    #[test]
    fn nothing_at_all_scores_nothing() {
        let none = CompletionScores::of(&Confusion::new(2), &ClassSet::default());
        assert_eq!([none.iou, none.precision, none.recall, none.miou], [0.0; 4]);
    }
}
