//! Grids of counts made small, without loss.
//!
//! A count is nearly what its neighbours along x and y make one expect (Weinberger, Seroussi and
//! Sapiro, "The LOCO-I lossless image compression algorithm", 2000), and how far off it is depends on how
//! large they are. So the errors are written apart by the size of the neighbours; each of these streams
//! is noise of its own frequencies.

use super::bits::BitWriter;
use super::deflate::{deflate, deflate_noise};

/// Streams of errors by the size of the neighbours: 0, 1 to 2 bits, 3 to 4 bits, ..., 15 to 16 bits.
pub(crate) const STREAMS: usize = 9;

/// Errors below this are written as they are; of others, the token has the exponent and the highest
/// bits behind the leading one.
const PLAIN: u32 = 16;
/// Bits of a larger error that are in its token.
const TOKEN_BITS: u32 = 3;

/// Parts: a bit a voxel, set where there is a count and none was expected, or the reverse; the tokens
/// of each stream; the bits of errors that are in no token. `expected` tells where counts are likely.
pub(crate) fn encode(
    counts: &[u16],
    shape: [usize; 3],
    expected: impl Fn(usize) -> bool,
) -> Vec<Vec<u8>> {
    let mut surprises = BitWriter::default();
    let mut streams: [Vec<u8>; STREAMS] = Default::default();
    let mut rest = BitWriter::default();
    for (flat, &count) in counts.iter().enumerate() {
        surprises.push(u32::from((count != 0) != expected(flat)), 1);
        if count != 0 {
            let near = Neighbors::of(counts, shape, flat);
            let error = zigzag(i32::from(count) - near.expected());
            streams[near.stream()].push(token(error));
            rest.push(error, bits_in_rest(error));
        }
    }
    let tokens = streams.iter().map(|stream| deflate_noise(stream));
    [deflate(&surprises.bytes())]
        .into_iter()
        .chain(tokens)
        .chain([deflate(&rest.bytes())])
        .collect()
}

/// The counts one step back along x, along y, and along both; 0 outside the grid.
struct Neighbors {
    x: i32,
    y: i32,
    both: i32,
}

impl Neighbors {
    fn of(counts: &[u16], [_, ny, nz]: [usize; 3], flat: usize) -> Self {
        let (slab, has_x, has_y) = (ny * nz, flat >= ny * nz, !(flat / nz).is_multiple_of(ny));
        let at =
            |is_there: bool, back: usize| if is_there { counts[flat - back].into() } else { 0 };
        Self { x: at(has_x, slab), y: at(has_y, nz), both: at(has_x && has_y, slab + nz) }
    }

    /// The plane through the three, but no farther than they are.
    fn expected(&self) -> i32 {
        let (low, high) = (self.x.min(self.y), self.x.max(self.y));
        (self.x + self.y - self.both).clamp(low, high)
    }

    fn stream(&self) -> usize {
        let largest = self.x.max(self.y).max(self.both) as u32;
        (u32::BITS - largest.leading_zeros()).div_ceil(2) as usize
    }
}

/// 0, -1, 1, -2, 2 as 0, 1, 2, 3, 4.
pub(crate) fn zigzag(error: i32) -> u32 {
    (error << 1 ^ error >> 31) as u32
}

fn token(error: u32) -> u8 {
    if error < PLAIN {
        return error as u8;
    }
    let rest = bits_in_rest(error);
    let highest = error >> rest & ((1 << TOKEN_BITS) - 1);
    (PLAIN + (((error.ilog2() - PLAIN.ilog2()) << TOKEN_BITS) | highest)) as u8
}

/// How many of the lowest bits the token leaves out.
fn bits_in_rest(error: u32) -> u32 {
    if error < PLAIN { 0 } else { error.ilog2() - TOKEN_BITS }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_and_its_rest_tell_every_error_apart() {
        let mut seen = std::collections::BTreeSet::new();
        for error in 0..=131_070 {
            let rest = bits_in_rest(error);
            assert!(seen.insert((token(error), error & ((1 << rest) - 1))), "{error}");
        }
        assert_eq!(seen.len(), 131_071);
    }

    #[test]
    fn the_expected_count_is_that_of_a_plane_or_an_edge() {
        let near = |x, y, both| Neighbors { x, y, both }.expected();
        assert_eq!([near(7, 5, 6), near(9, 2, 1), near(9, 2, 12), near(0, 0, 4)], [6, 9, 2, 0]);
    }

    #[test]
    fn the_stream_goes_by_the_largest_neighbor() {
        let stream = |x, y, both| Neighbors { x, y, both }.stream();
        let largest = [0, 1, 3, 4, 15, 16, 65_535].map(|n| stream(0, n, 0));
        assert_eq!(largest, [0, 1, 1, 2, 2, 3, STREAMS - 1]);
    }
}
