//! How much memory a run will take, before it takes it.

use occlabel_core::GridSpec;

/// Bytes that a point takes while its scene is in memory: position, label, origin, and its place in
/// the search tree.
const BYTES_A_POINT: u64 = 30 + 34;

/// Bytes that a voxel takes when a keyframe's arrays are made: vote 6, counts 8, state 1, camera bits
/// 2, vote where occupied 6, flow 12, the other arrays 11.
const BYTES_A_FINISHED_VOXEL: u64 = 46;

/// Bytes that a voxel takes while rays are counted, besides the shards: vote 6, counts so far 8.
const BYTES_A_COUNTED_VOXEL: u64 = 14;

/// Bytes that a voxel takes in each shard of the ray counts.
const BYTES_A_SHARD_VOXEL: u64 = 8;

/// An upper estimate of the memory of labelling one scene.
#[derive(Clone, Copy, Debug)]
pub struct MemoryModel {
    points: u64,
    voxels: u64,
}

impl MemoryModel {
    /// Of a scene with so many points, in a grid.
    pub fn new(points: u64, spec: &GridSpec) -> Self {
        Self { points, voxels: spec.len() as u64 }
    }

    /// Bytes with `keyframes` labelled at once, the rays of each in `shards`.
    pub fn bytes(&self, keyframes: usize, shards: usize) -> u64 {
        let counted = BYTES_A_COUNTED_VOXEL + BYTES_A_SHARD_VOXEL * shards as u64;
        let voxel = counted.max(BYTES_A_FINISHED_VOXEL);
        self.points * BYTES_A_POINT + keyframes as u64 * self.voxels * voxel
    }

    /// How many keyframes to label at once and in how many shards each, so that `jobs` threads are
    /// busy and `limit` bytes suffice.
    ///
    /// # Errors
    /// The bytes needed, if even one keyframe at a time does not fit.
    pub fn plan(&self, jobs: usize, limit: Option<u64>) -> Result<(usize, usize), u64> {
        let fits = |keyframes: usize, shards: usize| {
            limit.is_none_or(|limit| self.bytes(keyframes, shards) <= limit)
        };
        (1..=jobs)
            .rev()
            .map(|keyframes| (keyframes, jobs.div_ceil(keyframes)))
            .chain([(1, 1)])
            .find(|&(keyframes, shards)| fits(keyframes, shards))
            .ok_or_else(|| self.bytes(1, 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> MemoryModel {
        let spec = GridSpec::new([0.0; 3], [100.0; 3], [1.0; 3]).unwrap();
        MemoryModel::new(1_000_000, &spec)
    }

    #[test]
    fn without_a_bound_every_job_gets_a_keyframe() {
        assert_eq!(model().plan(8, None), Ok((8, 1)));
    }

    #[test]
    fn a_bound_is_kept_by_fewer_keyframes_at_once() {
        let (keyframes, shards) = model().plan(8, Some(300_000_000)).unwrap();
        assert!(keyframes < 8 && keyframes * shards >= 8, "{keyframes} x {shards}");
        assert!(model().bytes(keyframes, shards) <= 300_000_000);
    }

    #[test]
    fn a_scene_that_does_not_fit_says_what_it_needs() {
        assert_eq!(model().plan(8, Some(1_000)), Err(model().bytes(1, 1)));
    }

    #[test]
    fn a_fine_grid_fits_on_two_threads_as_it_does_on_one() {
        let spec = GridSpec::new([0.0; 3], [80.0, 80.0, 6.4], [0.1; 3]).unwrap();
        let model = MemoryModel::new(100_000, &spec);
        let most = Some(2 << 30);
        assert_eq!((model.plan(1, most), model.plan(2, most)), (Ok((1, 1)), Ok((1, 2))));
    }
}
