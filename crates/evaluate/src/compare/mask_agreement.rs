//! Whether two masks agree.

use std::ops::AddAssign;

use occlabel_core::VoxelGrid;
use serde::Serialize;

use crate::scores::ratio;

/// Voxels by what two masks say of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MaskCounts {
    /// Set in both.
    pub both: u64,
    /// Set in the first alone.
    pub only_a: u64,
    /// Set in the second alone.
    pub only_b: u64,
    /// Set in none.
    pub neither: u64,
}

/// The same with its ratio.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MaskAgreement {
    /// Set in both.
    pub both: u64,
    /// Set in the first alone.
    pub only_a: u64,
    /// Set in the second alone.
    pub only_b: u64,
    /// Set in none.
    pub neither: u64,
    /// Intersection over union; `None` of two empty masks.
    pub iou: Option<f64>,
}

impl MaskCounts {
    /// What two masks of one grid say.
    pub fn of(a: &VoxelGrid<u8>, b: &VoxelGrid<u8>) -> Self {
        let mut counts = [0; 4];
        for (a, b) in a.values().iter().zip(b.values()) {
            counts[usize::from(*a != 0) * 2 + usize::from(*b != 0)] += 1;
        }
        let [neither, only_b, only_a, both] = counts;
        Self { both, only_a, only_b, neither }
    }

    /// With its ratio.
    pub fn agreement(&self) -> MaskAgreement {
        let Self { both, only_a, only_b, neither } = *self;
        MaskAgreement { both, only_a, only_b, neither, iou: ratio(both, both + only_a + only_b) }
    }
}

impl AddAssign<&MaskCounts> for MaskCounts {
    fn add_assign(&mut self, other: &Self) {
        self.both += other.both;
        self.only_a += other.only_a;
        self.only_b += other.only_b;
        self.neither += other.neither;
    }
}
