//! Voxels by what is known of them.

use std::ops::AddAssign;

use occlabel_core::VoxelGrid;

use crate::NO_LABEL;

/// How many voxels are what.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VoxelTotals {
    /// Occupied ones by the index of their class.
    pub by_class: Vec<u64>,
    /// Known to be empty.
    pub free: u64,
    /// Of which nothing is known.
    pub unobserved: u64,
    /// Those that some camera sees; `None` if the labels do not tell.
    pub seen_by_cameras: Option<u64>,
}

impl VoxelTotals {
    /// Those of a keyframe of so many classes, whose index is followed by that of free. Labels without
    /// a lidar mask tell unobserved voxels only by [`NO_LABEL`].
    pub fn of(
        classes: usize,
        semantics: &VoxelGrid<u8>,
        mask_lidar: Option<&VoxelGrid<u8>>,
        mask_camera: Option<&VoxelGrid<u8>>,
    ) -> Self {
        let mut found = [[0_u64; 2]; 256];
        match mask_lidar {
            None => semantics.values().iter().for_each(|&class| found[usize::from(class)][1] += 1),
            Some(mask) => {
                for (&class, &observed) in semantics.values().iter().zip(mask.values()) {
                    found[usize::from(class)][usize::from(observed != 0)] += 1;
                }
            }
        }
        let seen =
            |mask: &VoxelGrid<u8>| mask.values().iter().map(|&bit| u64::from(bit != 0)).sum();
        let [unobserved, free] = found[classes];
        Self {
            by_class: found[..classes].iter().map(|[unseen, seen]| unseen + seen).collect(),
            free,
            unobserved: unobserved + found[usize::from(NO_LABEL)].iter().sum::<u64>(),
            seen_by_cameras: mask_camera.map(seen),
        }
    }

    /// Where anything stands.
    pub fn occupied(&self) -> u64 {
        self.by_class.iter().sum()
    }

    /// All of them.
    pub fn voxels(&self) -> u64 {
        self.occupied() + self.free + self.unobserved
    }
}

impl AddAssign<&Self> for VoxelTotals {
    fn add_assign(&mut self, other: &Self) {
        self.by_class.resize(self.by_class.len().max(other.by_class.len()), 0);
        self.by_class.iter_mut().zip(&other.by_class).for_each(|(sum, count)| *sum += count);
        self.free += other.free;
        self.unobserved += other.unobserved;
        let both = self.seen_by_cameras.zip(other.seen_by_cameras);
        let either = self.seen_by_cameras.or(other.seen_by_cameras);
        self.seen_by_cameras = both.map(|(a, b)| a + b).or(either);
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::GridSpec;

    use super::*;

    fn grid(values: [u8; 6]) -> VoxelGrid<u8> {
        let spec = GridSpec::new([0.0; 3], [1.0, 2.0, 3.0], [1.0; 3]).unwrap();
        VoxelGrid::from_values(&spec, values.to_vec())
    }

    #[test]
    fn every_voxel_is_counted_once() {
        let semantics = grid([0, 1, 1, 2, 2, NO_LABEL]);
        let (lidar, camera) = (grid([1, 0, 1, 1, 0, 1]), grid([1, 0, 0, 1, 0, 0]));
        let totals = VoxelTotals::of(2, &semantics, Some(&lidar), Some(&camera));
        let expected =
            VoxelTotals { by_class: vec![1, 2], free: 1, unobserved: 2, seen_by_cameras: Some(2) };
        assert_eq!((totals.occupied(), totals.voxels()), (3, 6));
        assert_eq!(totals, expected);
        let bare = VoxelTotals::of(2, &semantics, None, None);
        assert_eq!((bare.free, bare.unobserved, bare.seen_by_cameras), (2, 1, None));
    }

    #[test]
    fn sums_know_cameras_as_soon_as_one_part_does() {
        let semantics = grid([0, 1, 1, 2, 2, 2]);
        let mut sum = VoxelTotals::default();
        sum += &VoxelTotals::of(2, &semantics, None, None);
        assert_eq!(sum.seen_by_cameras, None);
        sum += &VoxelTotals::of(2, &semantics, None, Some(&semantics));
        assert_eq!((sum.voxels(), sum.seen_by_cameras), (12, Some(5)));
    }
}
