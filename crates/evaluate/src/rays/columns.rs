//! Where the columns of a grid are occupied, a word each.

use occlabel_core::GridSpec;

/// Bits a column.
const BITS: usize = u64::BITS as usize;

/// How far a height may be off by rounding, bits; it is below 1e-5 in a grid of any size.
pub(super) const UNSURE: f64 = 1e-4;

/// Which heights of each column are occupied.
///
/// A bit stands for one voxel, or for as many (a power of two) as let the column fit into a word. It
/// is set if any of its voxels is occupied.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    columns: Vec<Column>,
    /// Voxels a bit, as a power of two.
    shift: u32,
}

/// The occupied heights of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    /// A bit each.
    pub(super) word: u64,
    /// What does not come up to here, or stays above there, meets none of them, in bits.
    pub(super) from: f32,
    pub(super) to: f32,
}

impl Columns {
    pub(super) fn new(spec: &GridSpec, semantics: &[u8], free: u8) -> Self {
        let nz = spec.shape()[2];
        let shift = nz.div_ceil(BITS).next_power_of_two().trailing_zeros();
        // All at once, so that it is done in wide registers.
        let occupied: Vec<u8> = semantics.iter().map(|class| u8::from(*class < free)).collect();
        let column = |occupied: &[u8]| Column::new(word(occupied, shift));
        Self { columns: occupied.chunks_exact(nz).map(column).collect(), shift }
    }

    /// Column `x * ny + y`.
    #[inline(always)]
    pub(super) fn at(&self, column: u32) -> Column {
        self.columns[column as usize]
    }

    /// Voxels a bit along z.
    pub(super) fn voxels_per_bit(&self) -> f64 {
        f64::from(1_u32 << self.shift)
    }
}

impl Column {
    fn new(word: u64) -> Self {
        let unsure = UNSURE as f32;
        let [from, to] = match word.checked_ilog2() {
            Some(top) => [word.trailing_zeros() as f32 - unsure, (top + 1) as f32 + unsure],
            None => [f32::INFINITY, f32::NEG_INFINITY],
        };
        Self { word, from, to }
    }
}

/// The bits of a column that has a 1 for every occupied voxel.
fn word(occupied: &[u8], shift: u32) -> u64 {
    let bit = |(z, one): (usize, &u8)| u64::from(*one) << (z >> shift);
    let (eights, rest) = if shift == 0 { occupied.as_chunks() } else { (&[][..], occupied) };
    let word = eights.iter().zip(0..).fold(0, |word, (eight, at)| word | gather(eight) << (8 * at));
    (8 * eights.len()..).zip(rest).map(bit).fold(word, |word, bit| word | bit)
}

/// The lowest bits of eight bytes.
#[inline]
fn gather(bytes: &[u8; 8]) -> u64 {
    /// Brings them together in the highest byte.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    u64::from_le_bytes(*bytes).wrapping_mul(GATHER) >> 56
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_stands_for_as_many_voxels_as_it_must() {
        for (nz, voxels) in [(1, 1), (16, 1), (64, 1), (65, 2), (128, 2), (129, 4)] {
            let spec = GridSpec::new([0.0; 3], [1.0, 1.0, nz as f64], [1.0; 3]).unwrap();
            let mut semantics = vec![255; nz];
            semantics[nz - 1] = 3;
            let columns = Columns::new(&spec, &semantics, 4);
            assert_eq!(columns.voxels_per_bit(), voxels as f64, "{nz}");
            assert_eq!(columns.at(0).word, 1 << ((nz - 1) / voxels), "{nz}");
        }
    }

    #[test]
    fn every_voxel_of_a_column_has_its_bit() {
        for nz in 1..=64 {
            for place in 0..nz {
                let column: Vec<u8> = (0..nz).map(|z| u8::from(z == place)).collect();
                assert_eq!(word(&column, 0), 1 << place, "{place} of {nz}");
            }
        }
    }
}
