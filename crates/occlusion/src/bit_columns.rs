//! A bit for each voxel, the voxels of a column side by side.

use occlabel_core::{GridSpec, VoxelGrid};

/// A bit for each voxel. A column has words of its own, so that up to 64 of its voxels are looked at
/// in one step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BitColumns {
    words: Vec<u64>,
    /// Words of a column.
    pitch: usize,
}

impl BitColumns {
    /// No bit set.
    pub(crate) fn new(spec: &GridSpec) -> Self {
        let [nx, ny, nz] = spec.shape();
        let pitch = nz.div_ceil(64);
        Self { words: vec![0; nx * ny * pitch], pitch }
    }

    /// The voxels whose value is such.
    pub(crate) fn of<T: Copy>(
        spec: &GridSpec,
        grid: &VoxelGrid<T>,
        is_one: impl Fn(T) -> bool,
    ) -> Self {
        let (mut bits, nz) = (Self::new(spec), spec.shape()[2]);
        for (column, values) in grid.values().chunks_exact(nz).enumerate() {
            values
                .iter()
                .enumerate()
                .filter(|(_, v)| is_one(**v))
                .for_each(|(z, _)| bits.set(column, z));
        }
        bits
    }

    /// The word that holds a height of a column, and the height's bit in it.
    #[inline]
    fn place(&self, column: usize, z: usize) -> (usize, u64) {
        (column * self.pitch + z / 64, 1 << (z % 64))
    }

    /// The bits of a column from a multiple of 64 upwards.
    pub(crate) fn bits(&self, column: usize, z: usize) -> u64 {
        self.words[self.place(column, z).0]
    }

    /// Whether the bit of a voxel is set; its column is `x * ny + y`.
    #[inline]
    pub(crate) fn get(&self, column: usize, z: usize) -> bool {
        let (word, bit) = self.place(column, z);
        self.words[word] & bit != 0
    }

    /// Sets the bit of a voxel.
    #[inline]
    pub(crate) fn set(&mut self, column: usize, z: usize) {
        let (word, bit) = self.place(column, z);
        self.words[word] |= bit;
    }

    /// Clears the bit of a voxel.
    pub(crate) fn clear(&mut self, column: usize, z: usize) {
        let (word, bit) = self.place(column, z);
        self.words[word] &= !bit;
    }

    /// Whether all bits of a column from `low` to `high` are set.
    #[inline]
    pub(crate) fn has_all(&self, column: usize, low: usize, high: usize) -> bool {
        if self.pitch == 1 {
            return !self.words[column] & mask(low, high) == 0;
        }
        self.parts(column, low, high).all(|(word, mask)| !self.words[word] & mask == 0)
    }

    /// Whether no bit of a column from `low` to `high` is set.
    #[inline]
    pub(crate) fn has_none(&self, column: usize, low: usize, high: usize) -> bool {
        self.parts(column, low, high).all(|(word, mask)| self.words[word] & mask == 0)
    }

    /// Sets all bits of a column from `low` to `high`.
    #[inline]
    pub(crate) fn set_all(&mut self, column: usize, low: usize, high: usize) {
        self.parts(column, low, high).for_each(|(word, mask)| self.words[word] |= mask);
    }

    /// The words that hold a column from `low` to `high`, and their bits of it.
    #[inline]
    fn parts(
        &self,
        column: usize,
        low: usize,
        high: usize,
    ) -> impl Iterator<Item = (usize, u64)> + use<> {
        let first = column * self.pitch;
        (low / 64..=high / 64).map(move |part| {
            let from = if part == low / 64 { low % 64 } else { 0 };
            let to = if part == high / 64 { high % 64 } else { 63 };
            (first + part, mask(from, to))
        })
    }

    /// Sets the bits that are set in another grid of the same shape.
    pub(crate) fn unite(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, other)| *word |= other);
    }

    /// Calls `visit` with the place in the flat array of each voxel whose bit is set.
    pub(crate) fn for_each(&self, spec: &GridSpec, mut visit: impl FnMut(usize)) {
        let nz = spec.shape()[2];
        for (at, word) in self.words.iter().enumerate() {
            let first = at / self.pitch * nz + at % self.pitch * 64;
            let mut rest = *word;
            while rest != 0 {
                visit(first + rest.trailing_zeros() as usize);
                rest &= rest - 1;
            }
        }
    }
}

/// The bits of a word from `low` to `high`.
#[inline]
fn mask(low: usize, high: usize) -> u64 {
    (!0 << low) & (!0 >> (63 - high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_of_a_range_are_the_bits_one_by_one() {
        let mut asked = 0;
        for nz in [1, 2, 5, 16, 33, 64, 65, 130, 200] {
            let spec = GridSpec::new([0.0; 3], [2.0, 3.0, nz as f64], [1.0; 3]).unwrap();
            let mut bits = BitColumns::new(&spec);
            let is_hole = |column: usize, z: usize| (column * 31 + z * 7).is_multiple_of(23);
            for at in 0..6 * nz {
                bits.set(at / nz, at % nz);
                if is_hole(at / nz, at % nz) {
                    bits.clear(at / nz, at % nz);
                }
            }
            for (column, low) in (0..6).flat_map(|column| (0..nz).map(move |z| (column, z))) {
                assert_eq!(bits.get(column, low), !is_hole(column, low));
                for high in low..nz {
                    let expected = (low..=high).all(|z| !is_hole(column, z));
                    assert_eq!(bits.has_all(column, low, high), expected, "{column} {low} {high}");
                    asked += 1;
                }
            }
        }
        assert!(asked > 100_000, "{asked}");
    }
}
