//! One keyframe of two label sets.

use nalgebra::Point3;
use occlabel_core::{Fault, GridSpec, VoxelGrid};

use super::arrays::ArrayDifferences;
use super::difference::Difference;
use super::mask_agreement::MaskCounts;
use super::state_changes::StateCounts;
use crate::RINGS_M;
use crate::scores::{Metrics, ScoredLabels, ScoredPair, Scorer, ScoringRules};

/// The labels of one keyframe, with canonical ids.
#[derive(Clone, Copy, Debug)]
pub struct ComparedLabels<'a> {
    /// The class, free, or [`UNLABELLED`](crate::scores::UNLABELLED).
    pub semantics: &'a VoxelGrid<u8>,
    /// Not 0 where the lidars observed.
    pub mask_lidar: Option<&'a VoxelGrid<u8>>,
    /// Not 0 where some camera sees it.
    pub mask_camera: Option<&'a VoxelGrid<u8>>,
    /// The number of the object, 0 where there is none.
    pub instances: Option<&'a VoxelGrid<u16>>,
    /// Velocity in the grid frame, m/s.
    pub flow: Option<&'a VoxelGrid<[f32; 3]>>,
}

impl<'a> ComparedLabels<'a> {
    /// Labels of classes alone.
    pub fn of(semantics: &'a VoxelGrid<u8>) -> Self {
        Self { semantics, mask_lidar: None, mask_camera: None, instances: None, flow: None }
    }
}

/// Compares keyframes of two label sets of one grid and the same classes.
#[derive(Clone, Debug)]
pub struct Comparer {
    scorer: Scorer,
}

impl Comparer {
    /// A comparer of labels in a grid, of these classes, voxel by voxel.
    ///
    /// # Errors
    /// If there are more than 254 classes.
    pub fn new(spec: GridSpec, classes: Vec<String>) -> Result<Self, Fault> {
        Self::of(spec, classes, false)
    }

    /// The same, and along rays: RayIoU.
    ///
    /// # Errors
    /// As for [`Comparer::new`].
    pub fn along_rays(spec: GridSpec, classes: Vec<String>) -> Result<Self, Fault> {
        Self::of(spec, classes, true)
    }

    fn of(spec: GridSpec, classes: Vec<String>, rays: bool) -> Result<Self, Fault> {
        let rules = ScoringRules { ring_m: RINGS_M.to_vec(), ..ScoringRules::new(spec, classes) };
        let metrics = Metrics { semantic: true, rays, ..Metrics::default() };
        Ok(Self { scorer: Scorer::new(rules, metrics)? })
    }

    pub(crate) fn rules(&self) -> &ScoringRules {
        self.scorer.rules()
    }

    /// Compares a keyframe, on the thread that asks. Rays, if any are asked for, begin at the origins, in
    /// the grid frame, metres.
    ///
    /// # Errors
    /// If a grid has not the comparer's shape, or an id is of no class.
    pub fn compare(
        &self,
        a: &ComparedLabels,
        b: &ComparedLabels,
        origins: &[Point3<f64>],
    ) -> Result<Difference, Fault> {
        let pair = ScoredPair {
            truth: ScoredLabels::of(a.semantics),
            prediction: ScoredLabels::of(b.semantics),
            mask: None,
            origins,
        };
        let scores = self.scorer.score(&pair)?;
        let (arrays, differing) = ArrayDifferences::of(a, b);
        let masks = |[a, b]: [Option<&VoxelGrid<u8>>; 2]| Some(MaskCounts::of(a?, b?));
        Ok(Difference {
            voxels: self.rules().spec.len() as u64,
            differing,
            arrays,
            scores,
            mask_lidar: masks([a.mask_lidar, b.mask_lidar]),
            mask_camera: masks([a.mask_camera, b.mask_camera]),
            states: StateCounts::of(a, b, self.rules().free()),
        })
    }
}
