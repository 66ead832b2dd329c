//! How much memory a run will take, before it takes it.

use occlabel_core::GridSpec;

/// Bytes that the program takes whatever it labels: itself, and tables of a small log.
const BYTES_FOR_ALL: u64 = 24 << 20;

/// Bytes that a thread takes: its stack, and what the allocator keeps for it.
const BYTES_A_THREAD: u64 = 1 << 20;

/// Bytes that a point takes while its scene is in memory: position, label, origin, and its place in
/// the search tree; measured up to 67 where half of the points are labelled.
const BYTES_A_POINT: u64 = 30 + 38;

/// Bytes of a point in a cloud: position, label, origin.
const BYTES_A_COPY: u64 = 30;

/// Bytes that a voxel takes while rays are counted and judged, besides the shards: vote 6, state 1.
const BYTES_A_COUNTED_VOXEL: u64 = 7;

/// Bytes that a voxel takes in each shard of the ray counts: hits 4, crossings 4 and, where only
/// whether there were any is kept at first, 1.
const BYTES_A_SHARD_VOXEL: u64 = 9;

/// Bytes that a voxel takes while cameras look, besides bits: vote 6, state 1, matter 1, camera bits 2.
const BYTES_A_LOOKED_AT_VOXEL: u64 = 10;

/// Bytes that a voxel's counts take from when it is judged, if its evidence is wanted.
const BYTES_A_KEPT_COUNT: u64 = 4;

/// Grids of bits that are held for each camera, and for all together.
const BITS_A_CAMERA: u64 = 3;
const BITS_FOR_ALL_CAMERAS: u64 = 4;

/// Bytes that a voxel takes when its evidence is put together: vote 6, state twice 2, hits and
/// crossings 4, instance 2, flow 12, camera bits 2, what is written of labels 3.
const BYTES_A_VOXEL_WITH_EVIDENCE: u64 = 31;

/// Blocks smaller than this stay with the thread that freed them, as glibc's allocator has it: then a
/// keyframe that is written holds as much as one that is made, as was measured up to a limit.
const GIVEN_BACK_FROM: u64 = 32 << 20;
const MOST_HELD_BACK: u64 = 128 << 20;

/// An upper estimate of the memory of labelling one scene.
#[derive(Clone, Copy, Debug)]
pub struct MemoryModel {
    points: u64,
    voxels: u64,
    /// Bytes of the grids of bits that cameras need.
    looks: u64,
    evidence: bool,
    /// Bytes that those take who bring the sweeps.
    beside: u64,
    /// Points that each keyframe may copy.
    copied: u64,
}

impl MemoryModel {
    /// Of a scene with so many points and cameras, in a grid, with or without evidence.
    pub fn new(points: u64, spec: &GridSpec, cameras: usize, evidence: bool) -> Self {
        let [nx, ny, nz] = spec.shape().map(|n| n as u64);
        let bits = nx * ny * nz.div_ceil(64) * 8;
        let looks = bits * (BITS_A_CAMERA * cameras as u64 + BITS_FOR_ALL_CAMERAS);
        Self { points, voxels: nx * ny * nz, looks, evidence, beside: 0, copied: 0 }
    }

    /// The same, where what brings the sweeps takes so many bytes.
    pub fn beside(self, bytes: u64) -> Self {
        Self { beside: bytes, ..self }
    }

    /// The same, where each keyframe copies what is near enough of the points.
    pub fn cutting(self) -> Self {
        Self { copied: self.points, ..self }
    }

    /// Bytes with `keyframes` labelled at once, the rays of each in `shards`.
    pub fn bytes(&self, keyframes: usize, shards: usize) -> u64 {
        BYTES_FOR_ALL
            + self.beside
            + (keyframes * shards) as u64 * BYTES_A_THREAD
            + self.points * BYTES_A_POINT
            + keyframes as u64 * (self.keyframe_bytes(shards as u64) + self.copied * BYTES_A_COPY)
    }

    fn keyframe_bytes(&self, shards: u64) -> u64 {
        let if_evidence = |bytes: u64| if self.evidence { bytes } else { 0 };
        let counted = BYTES_A_COUNTED_VOXEL + BYTES_A_SHARD_VOXEL * shards;
        let looked_at = BYTES_A_LOOKED_AT_VOXEL + if_evidence(BYTES_A_KEPT_COUNT);
        let finished = if_evidence(BYTES_A_VOXEL_WITH_EVIDENCE);
        let bytes = (self.voxels * counted.max(finished)).max(self.voxels * looked_at + self.looks);
        let is_held_back = self.voxels < GIVEN_BACK_FROM;
        bytes + if is_held_back { bytes.min(MOST_HELD_BACK) } else { 0 }
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
        MemoryModel::new(1_000_000, &spec, 6, true)
    }

    #[test]
    fn without_a_bound_every_job_gets_a_keyframe() {
        assert_eq!(model().plan(8, None), Ok((8, 1)));
    }

    #[test]
    fn a_bound_is_kept_by_fewer_keyframes_at_once() {
        let (keyframes, shards) = model().plan(8, Some(400_000_000)).unwrap();
        assert!(keyframes < 8 && keyframes * shards >= 8, "{keyframes} x {shards}");
        assert!(model().bytes(keyframes, shards) <= 400_000_000);
    }

    #[test]
    fn a_scene_that_does_not_fit_says_what_it_needs() {
        assert_eq!(model().plan(8, Some(1_000)), Err(model().bytes(1, 1)));
    }

    #[test]
    fn a_fine_grid_fits_on_two_threads_as_it_does_on_one() {
        let spec = GridSpec::new([0.0; 3], [80.0, 80.0, 6.4], [0.1; 3]).unwrap();
        let model = MemoryModel::new(100_000, &spec, 6, true);
        let most = Some(2 << 30);
        assert_eq!((model.plan(1, most), model.plan(2, most)), (Ok((1, 1)), Ok((1, 2))));
    }

    #[test]
    fn centimetres_around_a_robot_fit_into_two_gibibytes_without_evidence() {
        let spec = GridSpec::new([0.0; 3], [10.0; 3], [0.02; 3]).unwrap();
        let most = Some(2 << 30);
        assert_eq!(MemoryModel::new(100_000, &spec, 6, false).plan(2, most), Ok((1, 1)));
        assert!(MemoryModel::new(100_000, &spec, 6, true).plan(2, most).is_err());
    }

    #[test]
    fn many_cameras_cost_a_low_grid_more_than_its_rays() {
        let spec = GridSpec::new([0.0; 3], [100.0, 100.0, 1.0], [1.0; 3]).unwrap();
        let bytes = |cameras| MemoryModel::new(0, &spec, cameras, false).bytes(1, 1);
        assert_eq!(bytes(8) - bytes(6), 2 * (2 * 3 * 80_000), "held back too");
    }
}
