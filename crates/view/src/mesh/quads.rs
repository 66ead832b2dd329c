//! The faces of voxels, joined to rectangles.
//!
//! A face is between a voxel and a neighbour of another kind, or none: what is of one kind is closed by
//! itself, so that a viewer can take other kinds away and finds no holes. Of the faces in one plane that
//! look the same way and are of one kind the first in order grows along its row, then row by row, until
//! something else is in the way.
//!
//! Source of the growing: M. Lysenko, "Meshing in a Minecraft Game", 2012.

/// A rectangle of faces of one kind, in voxel units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Quad<K> {
    pub(crate) kind: K,
    /// The axis along which it looks.
    pub(crate) axis: usize,
    /// Whether it looks up that axis, else down.
    pub(crate) looks_up: bool,
    /// Where its plane meets the axis.
    pub(crate) plane: usize,
    /// Its lower corner along the next axis and the one after that.
    pub(crate) lower: [usize; 2],
    /// Its upper corner, likewise.
    pub(crate) upper: [usize; 2],
}

impl<K> Quad<K> {
    /// The corners, counter-clockwise as seen from outside.
    pub(crate) fn corners(&self) -> [[usize; 3]; 4] {
        let ([u0, v0], [u1, v1]) = (self.lower, self.upper);
        let around = match self.looks_up {
            true => [[u0, v0], [u1, v0], [u1, v1], [u0, v1]],
            false => [[u0, v0], [u0, v1], [u1, v1], [u1, v0]],
        };
        around.map(|[u, v]| {
            let mut corner = [0; 3];
            corner[self.axis] = self.plane;
            corner[(self.axis + 1) % 3] = u;
            corner[(self.axis + 2) % 3] = v;
            corner
        })
    }
}

/// The faces of all voxels that are of a kind, as few rectangles: by axis, plane, and way they look.
pub(crate) fn quads<K: Copy + Eq>(
    shape: [usize; 3],
    kind: impl Fn([usize; 3]) -> Option<K>,
) -> Vec<Quad<K>> {
    let mut quads = Vec::new();
    for axis in 0..3 {
        let size = [shape[(axis + 1) % 3], shape[(axis + 2) % 3]];
        for plane in 0..=shape[axis] {
            for looks_up in [false, true] {
                let mut faces = faces(shape, &kind, axis, plane, looks_up);
                rectangles(&mut faces, size, |kind, lower, upper| {
                    quads.push(Quad { kind, axis, looks_up, plane, lower, upper });
                });
            }
        }
    }
    quads
}

/// The kinds of the faces in a plane that look one way, row by row.
fn faces<K: Copy + Eq>(
    shape: [usize; 3],
    kind: &impl Fn([usize; 3]) -> Option<K>,
    axis: usize,
    plane: usize,
    looks_up: bool,
) -> Vec<Option<K>> {
    let (u_axis, v_axis) = ((axis + 1) % 3, (axis + 2) % 3);
    let at = |layer: Option<usize>, u, v| {
        let mut voxel = [0; 3];
        (voxel[axis], voxel[u_axis], voxel[v_axis]) = (layer?, u, v);
        kind(voxel)
    };
    let (below, above) = (plane.checked_sub(1), (plane < shape[axis]).then_some(plane));
    let (behind, before) = if looks_up { (below, above) } else { (above, below) };
    let rows = (0..shape[v_axis]).flat_map(|v| (0..shape[u_axis]).map(move |u| (u, v)));
    rows.map(|(u, v)| at(behind, u, v).filter(|&kind| at(before, u, v) != Some(kind))).collect()
}

/// Takes rectangles of one kind from a plane until nothing is left.
fn rectangles<K: Copy + Eq>(
    faces: &mut [Option<K>],
    [width, height]: [usize; 2],
    mut found: impl FnMut(K, [usize; 2], [usize; 2]),
) {
    for v in 0..height {
        let mut u = 0;
        while u < width {
            let Some(kind) = faces[v * width + u] else {
                u += 1;
                continue;
            };
            let is_kind = |face: &Option<K>| *face == Some(kind);
            let row = &faces[v * width + u..(v + 1) * width];
            let end_u = u + row.iter().take_while(|face| is_kind(face)).count();
            let is_whole = |v: &usize| faces[v * width + u..v * width + end_u].iter().all(is_kind);
            let end_v = (v..height).take_while(is_whole).last().map_or(v, |last| last + 1);
            (v..end_v).for_each(|v| faces[v * width + u..v * width + end_u].fill(None));
            found(kind, [u, v], [end_u, end_v]);
            u = end_u;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::collections::BTreeMap;

    use proptest::prelude::*;
    use proptest::test_runner::{Config, TestRunner};

    use super::*;

    /// A face of a voxel: kind, axis, whether it looks up, lowest corner.
    type Face = (u8, usize, bool, [usize; 3]);

    /// A small grid by its shape and values in flat order; 0 is nothing.
    type Grid = ([usize; 3], Vec<u8>);

    fn kind((shape, values): &Grid, [x, y, z]: [usize; 3]) -> Option<u8> {
        Some(values[(x * shape[1] + y) * shape[2] + z]).filter(|&value| value != 0)
    }

    fn neighbour(
        shape: [usize; 3],
        mut voxel: [usize; 3],
        axis: usize,
        up: bool,
    ) -> Option<[usize; 3]> {
        voxel[axis] = if up { voxel[axis] + 1 } else { voxel[axis].checked_sub(1)? };
        (voxel[axis] < shape[axis]).then_some(voxel)
    }

    /// Each voxel's six faces, looked at one by one.
    fn by_hand(grid: &Grid) -> Vec<Face> {
        let [nx, ny, nz] = grid.0;
        let mut faces = Vec::new();
        for flat in 0..nx * ny * nz {
            let voxel = [flat / (ny * nz), flat / nz % ny, flat % nz];
            let Some(own) = kind(grid, voxel) else { continue };
            for (axis, up) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
                let beside =
                    neighbour(grid.0, voxel, axis, up).and_then(|beside| kind(grid, beside));
                if beside != Some(own) {
                    let mut corner = voxel;
                    corner[axis] += usize::from(up);
                    faces.push((own, axis, up, corner));
                }
            }
        }
        faces
    }

    fn faces_of(quad: &Quad<u8>) -> Vec<Face> {
        let corners = quad.corners();
        let low: [usize; 3] =
            std::array::from_fn(|axis| corners.iter().map(|c| c[axis]).min().unwrap());
        let high: [usize; 3] =
            std::array::from_fn(|axis| corners.iter().map(|c| c[axis]).max().unwrap());
        let (u, v) = ((quad.axis + 1) % 3, (quad.axis + 2) % 3);
        let cells =
            (low[u]..high[u]).flat_map(|at_u| (low[v]..high[v]).map(move |at_v| (at_u, at_v)));
        let face = |(at_u, at_v)| {
            let mut corner = low;
            (corner[u], corner[v]) = (at_u, at_v);
            (quad.kind, quad.axis, quad.looks_up, corner)
        };
        cells.map(face).collect()
    }

    /// The area times the outward direction, from the corners' order alone.
    fn cross(quad: &Quad<u8>) -> [i64; 3] {
        let [a, b, c, _] = quad.corners().map(|corner| corner.map(|i| i as i64));
        let (p, q): ([i64; 3], [i64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - b[i]));
        std::array::from_fn(|i| p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3])
    }

    fn grids() -> impl Strategy<Value = Grid> {
        let shape = (1..7_usize, 1..7_usize, 1..5_usize);
        shape.prop_flat_map(|(nx, ny, nz)| {
            let value = prop_oneof![3 => Just(0_u8), 3 => Just(1), 1 => Just(2)];
            (Just([nx, ny, nz]), proptest::collection::vec(value, nx * ny * nz))
        })
    }

    #[test]
    fn quads_cover_each_face_once_and_nothing_else() {
        let (faces, joined) = (Cell::new(0), Cell::new(0));
        let mut runner =
            TestRunner::new(Config { cases: 300, failure_persistence: None, ..Config::default() });
        let outcome = runner.run(&grids(), |grid| {
            let quads = quads(grid.0, |voxel| kind(&grid, voxel));
            let mut covered: Vec<_> = quads.iter().flat_map(faces_of).collect();
            let mut expected = by_hand(&grid);
            covered.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(&covered, &expected);
            faces.set(faces.get() + covered.len());
            joined.set(joined.get() + covered.len() - quads.len());
            Ok(())
        });
        outcome.unwrap();
        let (faces, joined) = (faces.get(), joined.get());
        assert!(faces > 10_000 && joined > 3_000, "{faces} faces, {joined} joined to others");
    }

    #[test]
    fn quads_look_outwards_and_hold_the_volume_of_their_voxels() {
        let grid = ([2, 3, 2], vec![1, 0, 1, 1, 0, 2, 1, 2, 0, 0, 2, 2]);
        let mut volumes = [[0; 3]; 3];
        for quad in quads(grid.0, |voxel| kind(&grid, voxel)) {
            let normal = cross(&quad);
            assert!((0..3).all(|axis| (normal[axis] != 0) == (axis == quad.axis)), "{quad:?}");
            assert_eq!(normal[quad.axis] > 0, quad.looks_up, "{quad:?}");
            volumes[usize::from(quad.kind)][quad.axis] += quad.plane as i64 * normal[quad.axis];
        }
        assert_eq!(volumes, [[0; 3], [4; 3], [4; 3]], "voxels by kind, along each axis");
    }

    #[test]
    fn a_block_is_six_quads_and_two_kinds_side_by_side_are_twelve() {
        let block = ([3, 4, 2], vec![1; 24]);
        assert_eq!(quads(block.0, |voxel| kind(&block, voxel)).len(), 6);
        let halves = ([2, 4, 2], [[1; 8], [2; 8]].concat());
        let quads = quads(halves.0, |voxel| kind(&halves, voxel));
        let mut by_kind = BTreeMap::new();
        quads.iter().for_each(|quad| *by_kind.entry(quad.kind).or_insert(0) += 1);
        assert_eq!(by_kind, BTreeMap::from([(1, 6), (2, 6)]));
    }
}
