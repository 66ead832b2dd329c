//! What predictions are scored by.

use occlabel_core::{ClassSet, GridSpec};

/// The id of a voxel of which a file says nothing.
pub const UNLABELLED: u8 = 255;

/// The grid, the classes and the limits that labels are scored by.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoringRules {
    /// The grid of truth and prediction.
    pub spec: GridSpec,
    /// Class names in the order of the class table, without free.
    pub classes: Vec<String>,
    /// Classes that are left out where truth has them (SurroundOcc: noise).
    pub ignored: ClassSet,
    /// Classes whose instances are told apart; the others are stuff.
    pub things: ClassSet,
    /// Classes whose velocity is asked for.
    pub flow_classes: ClassSet,
    /// Outer radii of the range rings, rising, metres; none: no rings.
    pub ring_m: Vec<f64>,
    /// A voxel is met if one of the others is nearer than this, metres.
    pub f_threshold_m: f64,
    /// A detection's centre is right up to this horizontal distance, metres.
    pub detection_m: f64,
    /// Unmatched segments of fewer voxels are neither missed nor false.
    pub min_segment_voxels: u64,
}

impl ScoringRules {
    /// No class ignored, nothing a thing, no rings; F-score at 0.6 m (CVPR 2023), detections at 2 m
    /// (nuScenes), segments of any size.
    pub fn new(spec: GridSpec, classes: Vec<String>) -> Self {
        Self {
            spec,
            classes,
            ignored: ClassSet::default(),
            things: ClassSet::default(),
            flow_classes: ClassSet::default(),
            ring_m: Vec::new(),
            f_threshold_m: 0.6,
            detection_m: 2.0,
            min_segment_voxels: 0,
        }
    }

    /// The canonical id of free: one more than the last class.
    pub fn free(&self) -> u8 {
        self.classes.len() as u8
    }
}
