//! What was counted of two label sets.

use std::ops::AddAssign;

use super::arrays::ArrayDifferences;
use super::comparer::Comparer;
use super::comparison::Comparison;
use super::mask_agreement::MaskCounts;
use super::state_changes::StateCounts;
use crate::scores::ScoreTally;

/// What was counted of some keyframes of two label sets. Differences add up in any order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// All voxels.
    pub voxels: u64,
    /// Voxels that differ in an array that both have.
    pub differing: u64,
    /// The same array by array.
    pub arrays: ArrayDifferences,
    pub(super) scores: ScoreTally,
    pub(super) mask_lidar: Option<MaskCounts>,
    pub(super) mask_camera: Option<MaskCounts>,
    pub(super) states: Option<StateCounts>,
}

impl Difference {
    /// The share of voxels that differ; `None` of none.
    pub fn differing_share(&self) -> Option<f64> {
        (self.voxels > 0).then(|| self.differing as f64 / self.voxels as f64)
    }

    /// Mean intersection over union of the classes, free left out; `None` if there are none.
    pub fn miou(&self, comparer: &Comparer) -> Option<f64> {
        self.scores.scores(comparer.rules()).semantic?.miou
    }

    /// Takes the ratios.
    pub fn comparison(&self, comparer: &Comparer) -> Comparison {
        Comparison::of(self, comparer.rules())
    }
}

impl AddAssign<&Difference> for Difference {
    fn add_assign(&mut self, other: &Self) {
        if self.voxels == 0 {
            return self.clone_from(other);
        }
        self.voxels += other.voxels;
        self.differing += other.differing;
        self.arrays += &other.arrays;
        self.scores += &other.scores;
        add(&mut self.mask_lidar, &other.mask_lidar);
        add(&mut self.mask_camera, &other.mask_camera);
        add(&mut self.states, &other.states);
    }
}

/// A keyframe may lack what another has.
fn add<T: Clone + for<'a> AddAssign<&'a T>>(sum: &mut Option<T>, more: &Option<T>) {
    match (sum.as_mut(), more) {
        (Some(sum), Some(more)) => *sum += more,
        (None, Some(more)) => *sum = Some(more.clone()),
        (_, None) => {}
    }
}
