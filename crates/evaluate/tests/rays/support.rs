//! Grids and dice.

use occlabel_core::{GridSpec, VoxelGrid};

/// Class of free voxels in the tests.
pub(crate) const FREE: u8 = 5;

/// Numbers that look random and are always the same.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    /// From 0 to 1.
    pub(crate) fn share(&mut self) -> f64 {
        self.below(1 << 30) as f64 / f64::from(1 << 30)
    }

    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.share()
    }
}

/// A grid from the origin on.
pub(crate) fn spec(shape: [usize; 3], size_m: [f64; 3]) -> GridSpec {
    let max_m = [0, 1, 2].map(|axis| shape[axis] as f64 * size_m[axis]);
    GridSpec::new([0.0; 3], max_m, size_m).unwrap()
}

/// One in `one_in` voxels occupied, some without a label.
pub(crate) fn semantics(spec: &GridSpec, one_in: u64, dice: &mut Dice) -> VoxelGrid<u8> {
    let mut class = || match dice.below(one_in) {
        0 => dice.below(u64::from(FREE)) as u8,
        1 if one_in > 3 => 255,
        _ => FREE,
    };
    let classes = (0..spec.len()).map(|_| class()).collect();
    VoxelGrid::from_values(spec, classes)
}
