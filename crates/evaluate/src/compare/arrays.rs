//! How many voxels differ in each array.

use std::ops::AddAssign;

use occlabel_core::VoxelGrid;
use serde::Serialize;

use super::comparer::ComparedLabels;

/// Voxels that differ, array by array; `None` where one of the sets lacks it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ArrayDifferences {
    /// Class, free or no label.
    pub semantics: u64,
    /// What the lidars observed.
    pub mask_lidar: Option<u64>,
    /// What the cameras see.
    pub mask_camera: Option<u64>,
    /// The number of the object.
    pub instances: Option<u64>,
    /// Velocity, bit by bit; unknown is the same as unknown.
    pub flow: Option<u64>,
}

impl ArrayDifferences {
    /// Of two keyframes, and how many voxels differ in any array that both have.
    pub(crate) fn of(a: &ComparedLabels, b: &ComparedLabels) -> (Self, u64) {
        let mut any = vec![false; a.semantics.values().len()];
        let differences = Self {
            semantics: differ(a.semantics, b.semantics, &mut any, |a, b| a != b),
            mask_lidar: both(a.mask_lidar, b.mask_lidar, &mut any, |a, b| (*a != 0) != (*b != 0)),
            mask_camera: both(a.mask_camera, b.mask_camera, &mut any, |a, b| {
                (*a != 0) != (*b != 0)
            }),
            instances: both(a.instances, b.instances, &mut any, |a, b| a != b),
            flow: both(a.flow, b.flow, &mut any, flows_differ),
        };
        (differences, any.iter().filter(|any| **any).count() as u64)
    }
}

fn flows_differ(a: &[f32; 3], b: &[f32; 3]) -> bool {
    a.iter().zip(b).any(|(a, b)| a != b && !(a.is_nan() && b.is_nan()))
}

fn both<T>(
    a: Option<&VoxelGrid<T>>,
    b: Option<&VoxelGrid<T>>,
    any: &mut [bool],
    differs: impl Fn(&T, &T) -> bool,
) -> Option<u64> {
    Some(differ(a?, b?, any, differs))
}

fn differ<T>(
    a: &VoxelGrid<T>,
    b: &VoxelGrid<T>,
    any: &mut [bool],
    differs: impl Fn(&T, &T) -> bool,
) -> u64 {
    let mut count = 0;
    for ((a, b), any) in a.values().iter().zip(b.values()).zip(any) {
        let differs = differs(a, b);
        *any |= differs;
        count += u64::from(differs);
    }
    count
}

impl AddAssign<&ArrayDifferences> for ArrayDifferences {
    fn add_assign(&mut self, other: &Self) {
        let add = |sum: Option<u64>, more: Option<u64>| Some(sum.unwrap_or(0) + more?).or(sum);
        self.semantics += other.semantics;
        self.mask_lidar = add(self.mask_lidar, other.mask_lidar);
        self.mask_camera = add(self.mask_camera, other.mask_camera);
        self.instances = add(self.instances, other.instances);
        self.flow = add(self.flow, other.flow);
    }
}
