//! Grids of names (a class, a mask, a track, bits) made small: voxels mostly have what the voxel before
//! them along x has.

use super::deflate::deflate;

/// One deflated part a byte of the numbers, the lowest first: each byte xor that of the voxel one step
/// back along x. `slab` is how many voxels share an x.
pub(crate) fn encode<const BYTES: usize>(
    values: impl Fn(usize) -> [u8; BYTES],
    len: usize,
    slab: usize,
) -> Vec<Vec<u8>> {
    let plane = |byte: usize| {
        let before = |flat: usize| if flat < slab { 0 } else { values(flat - slab)[byte] };
        let steps: Vec<u8> = (0..len).map(|flat| values(flat)[byte] ^ before(flat)).collect();
        deflate(&steps)
    };
    (0..BYTES).map(plane).collect()
}
