//! How two label sets differ, as ratios.

use serde::Serialize;

use super::arrays::ArrayDifferences;
use super::difference::Difference;
use super::mask_agreement::{MaskAgreement, MaskCounts};
use super::state_changes::{StateChanges, StateCounts};
use crate::rays::RayIou;
use crate::scores::{RingScores, ScoringRules, SemanticScores};

/// How two label sets differ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Keyframes that both have.
    pub keyframes: u64,
    /// Their voxels.
    pub voxels: u64,
    /// Voxels that differ in an array that both have.
    pub differing: u64,
    /// Their share.
    pub differing_share: Option<f64>,
    /// Voxels that differ, array by array.
    pub arrays: ArrayDifferences,
    /// IoU by class, and their confusion: rows are the first set's classes.
    pub semantic: Option<SemanticScores>,
    /// The same by horizontal distance from the grid frame's origin.
    pub by_ring: Vec<RingScores>,
    /// What the lidars observed.
    pub mask_lidar: Option<MaskAgreement>,
    /// What the cameras see.
    pub mask_camera: Option<MaskAgreement>,
    /// From which state to which.
    pub states: Option<StateChanges>,
    /// RayIoU, the first set taken as the truth; `None` without origins of rays.
    pub rays: Option<RayIou>,
}

impl Comparison {
    pub(super) fn of(difference: &Difference, rules: &ScoringRules) -> Self {
        let scores = difference.scores.scores(rules);
        Self {
            keyframes: scores.keyframes,
            voxels: difference.voxels,
            differing: difference.differing,
            differing_share: difference.differing_share(),
            arrays: difference.arrays,
            semantic: scores.semantic,
            by_ring: scores.by_ring,
            mask_lidar: difference.mask_lidar.as_ref().map(MaskCounts::agreement),
            mask_camera: difference.mask_camera.as_ref().map(MaskCounts::agreement),
            states: difference.states.as_ref().map(StateCounts::changes),
            rays: scores.rays.map(|rays| rays.ray_iou),
        }
    }
}
