//! Any ray through a small grid: the fast walk is the textbook one.

use std::ops::ControlFlow;

use occlabel_core::{GridSpec, LatticePoint, traverse, walk, walk_after};

use super::bytes::Bytes;

/// Both walks between two points of the lattice; from within the grid, past some faces too.
pub(super) fn walk_both_ways(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let sides = std::array::from_fn(|_| 1.0 + bytes.below(9) as f64);
    let spec = GridSpec::new([0.0; 3], sides, [1.0; 3]).unwrap();
    let [from, to] = [point(&mut bytes), point(&mut bytes)];
    let textbook: Vec<_> =
        traverse(from, to).filter_map(|voxel| Some((spec.flat(voxel)?, voxel.0))).collect();
    let mut fast = Vec::new();
    walk(&spec, from, to, noted(&mut fast));
    assert_eq!(fast, textbook, "{from:?} {to:?} {sides:?}");
    if spec.flat(from.voxel()).is_some() {
        let (axis, faces) = (bytes.below(3), 1 + bytes.below(9) as i64);
        let is_after = |at: &[i64; 3]| (at[axis] - from.voxel().0[axis]).abs() >= faces;
        let late: Vec<_> = textbook.into_iter().filter(|(_, at)| is_after(at)).collect();
        let mut past = Vec::new();
        walk_after(&spec, [from, to], (axis, faces), noted(&mut past));
        assert_eq!(past, late, "{from:?} {to:?} {sides:?} {axis} {faces}");
    }
    true
}

fn noted(list: &mut Vec<(usize, [i64; 3])>) -> impl FnMut(usize, [i64; 3]) -> ControlFlow<()> {
    |flat, voxel| {
        list.push((flat, voxel));
        ControlFlow::Continue(())
    }
}

/// Near the grid, or up to a million voxels away: some rays are too long for 64 bits.
fn point(bytes: &mut Bytes) -> LatticePoint {
    let coordinate = |bytes: &mut Bytes| match bytes.byte() % 32 {
        0 => bytes.whole() >> 32,
        _ => bytes.whole() >> 48,
    };
    LatticePoint([coordinate(bytes), coordinate(bytes), coordinate(bytes)].map(|q| q | 1))
}
