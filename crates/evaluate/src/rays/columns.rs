//! Where the columns of a grid are occupied, a word each.

use occlabel_core::GridSpec;

/// Bits a column.
const BITS: usize = u64::BITS as usize;

/// Which heights of each column are occupied.
///
/// A bit stands for one voxel, or for as many (a power of two) as let the column fit into a word. It
/// is set if any of its voxels is occupied.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    words: Vec<u64>,
    /// Voxels a bit, as a power of two.
    shift: u32,
}

impl Columns {
    pub(super) fn new(spec: &GridSpec, semantics: &[u8], free: u8) -> Self {
        let nz = spec.shape()[2];
        let shift = nz.div_ceil(BITS).next_power_of_two().trailing_zeros();
        let word = |column: &[u8]| word(column, shift, free);
        Self { words: semantics.chunks_exact(nz).map(word).collect(), shift }
    }

    /// The occupied heights of column `x * ny + y`.
    #[inline]
    pub(super) fn word(&self, column: usize) -> u64 {
        self.words[column]
    }

    /// Bits a voxel along z.
    pub(super) fn bits_per_voxel(&self) -> f64 {
        1.0 / f64::from(1_u32 << self.shift)
    }
}

fn word(column: &[u8], shift: u32, free: u8) -> u64 {
    let mut word = 0;
    for (z, class) in column.iter().enumerate() {
        word |= u64::from(*class < free) << (z >> shift);
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_stands_for_as_many_voxels_as_it_must() {
        for (nz, bits) in [(1, 1.0), (16, 1.0), (64, 1.0), (65, 0.5), (128, 0.5), (129, 0.25)] {
            let spec = GridSpec::new([0.0; 3], [1.0, 1.0, nz as f64], [1.0; 3]).unwrap();
            let mut semantics = vec![255; nz];
            semantics[nz - 1] = 3;
            let columns = Columns::new(&spec, &semantics, 4);
            assert_eq!(columns.bits_per_voxel(), bits, "{nz}");
            assert_eq!(columns.word(0), 1 << ((nz - 1) as f64 * bits) as u32, "{nz}");
        }
    }
}
