//! The exact walk along a ray, voxel by voxel: the textbook form.
//!
//! Amanatides & Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics 1987, on the
//! integer lattice of labels.md section 8. Slow, obvious, and right on rays of any length: this is
//! what [`crate::walk`] is tested against.

use crate::{LATTICE, LatticePoint, VoxelIndex};

/// The voxels that the straight way from `from` to `to` enters after `from`'s own, in order, `to`'s
/// own included. Where several axes meet faces at one moment, x steps before y before z.
pub fn traverse(from: LatticePoint, to: LatticePoint) -> Traverse {
    Traverse {
        voxel: from.voxel(),
        end: to.voxel(),
        step: std::array::from_fn(|axis| (to.0[axis] - from.0[axis]).signum()),
        length: std::array::from_fn(|axis| i128::from((to.0[axis] - from.0[axis]).abs())),
        to_face: std::array::from_fn(|axis| distance_to_face(from.0[axis], to.0[axis])),
    }
}

/// Iterator of [`traverse`].
#[derive(Clone, Debug)]
pub struct Traverse {
    voxel: VoxelIndex,
    end: VoxelIndex,
    step: [i64; 3],
    /// The ray's length along each axis.
    length: [i128; 3],
    /// How far along each axis the next face lies from the start.
    to_face: [i128; 3],
}

impl Iterator for Traverse {
    type Item = VoxelIndex;

    fn next(&mut self) -> Option<VoxelIndex> {
        if self.voxel == self.end {
            return None;
        }
        let axis = self.next_axis();
        self.voxel.0[axis] += self.step[axis];
        self.to_face[axis] += i128::from(LATTICE);
        Some(self.voxel)
    }
}

impl Traverse {
    /// The axis whose face comes first.
    fn next_axis(&self) -> usize {
        let y_or_z = if self.before(1, 2) { 1 } else { 2 };
        if self.before(0, y_or_z) { 0 } else { y_or_z }
    }

    /// Whether axis `a` meets its next face no later than axis `b`: t_a <= t_b, t = to_face / length,
    /// compared by cross products. An axis along which the ray does not run never meets one.
    fn before(&self, a: usize, b: usize) -> bool {
        self.length[a] != 0
            && (self.length[b] == 0
                || self.to_face[a] * self.length[b] <= self.to_face[b] * self.length[a])
    }
}

fn distance_to_face(from: i64, to: i64) -> i128 {
    let within = from.rem_euclid(LATTICE);
    i128::from(if to > from { LATTICE - within } else { within })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;

    fn path(from: [i64; 3], to: [i64; 3]) -> Vec<[i64; 3]> {
        traverse(LatticePoint(from), LatticePoint(to)).map(|voxel| voxel.0).collect()
    }

    #[test]
    fn section_8_a_ray_within_one_voxel_crosses_nothing() {
        assert!(path([1, 1, 1], [2047, 2047, 2047]).is_empty());
    }

    #[test]
    fn section_8_a_straight_ray_enters_each_voxel_after_its_own() {
        assert_eq!(
            path([1025, 1025, 1025], [3 * 2048 + 1, 1025, 1025]),
            [[1, 0, 0], [2, 0, 0], [3, 0, 0]]
        );
        assert_eq!(path([1025, 1025, 1025], [1025, 1025 - 4096, 1025]), [[0, -1, 0], [0, -2, 0]]);
    }

    #[test]
    fn section_8_ties_step_x_before_y_before_z() {
        assert_eq!(path([1025; 3], [1025 + 2048; 3]), [[1, 0, 0], [1, 1, 0], [1, 1, 1]]);
        assert_eq!(path([1025; 3], [1025 - 2048; 3]).len(), 3);
    }

    /// Exact slabs: the share of the way at which the segment is inside a voxel, as fractions of
    /// the product of the lengths. `None` if it never is; touching counts.
    fn overlap(from: LatticePoint, to: LatticePoint, voxel: [i64; 3]) -> Option<bool> {
        let (mut low, mut high) = ((0_i128, 1_i128), (1_i128, 1_i128));
        for axis in 0..3 {
            let (a, way) = (i128::from(from.0[axis]), i128::from(to.0[axis] - from.0[axis]));
            let faces = [voxel[axis], voxel[axis] + 1].map(|i| i128::from(i * LATTICE) - a);
            if way == 0 {
                (faces[0] < 0 && faces[1] > 0).then_some(())?;
                continue;
            }
            let [near, far] = if way > 0 { faces } else { [-faces[1], -faces[0]] };
            let later =
                |p: (i128, i128), q: (i128, i128)| if p.0 * q.1 >= q.0 * p.1 { p } else { q };
            low = later(low, (near, way.abs()));
            high = if later(high, (far, way.abs())) == high { (far, way.abs()) } else { high };
        }
        let (start, end) = (low.0 * high.1, high.0 * low.1);
        (start <= end).then_some(start < end)
    }

    #[test]
    fn section_8_the_walk_is_every_voxel_that_the_segment_passes_through() {
        let (passed, touched) = (Cell::new(0), Cell::new(0));
        let end =
            || [-6144_i64..6144, -6144_i64..6144, -6144_i64..6144].prop_map(|q| q.map(|q| q | 1));
        proptest!(ProptestConfig::with_cases(2_000), |(from in end(), to in end())| {
            let (from, to) = (LatticePoint(from), LatticePoint(to));
            let walked: Vec<_> = std::iter::once(from.voxel()).chain(traverse(from, to)).collect();
            for flat in 0..8 * 8 * 8 {
                let voxel = [flat / 64, flat / 8 % 8, flat % 8].map(|i| i - 4);
                let is_walked = walked.contains(&VoxelIndex(voxel));
                match overlap(from, to, voxel) {
                    Some(true) => prop_assert!(is_walked, "{voxel:?} is passed"),
                    Some(false) => touched.set(touched.get() + 1),
                    None => prop_assert!(!is_walked, "{voxel:?} is not even touched"),
                }
                passed.set(passed.get() + usize::from(is_walked));
            }
        });
        assert!(passed.get() > 10_000, "{} voxels passed, {} touched", passed.get(), touched.get());
    }

    #[test]
    fn a_walk_takes_one_step_per_index_and_ends_at_the_end() {
        let (from, to) = (LatticePoint([11, -5001, 77777]), LatticePoint([90001, 44445, -3]));
        let walked: Vec<_> = traverse(from, to).collect();
        let steps: i64 = (0..3).map(|a| (from.voxel().0[a] - to.voxel().0[a]).abs()).sum();
        assert_eq!(walked.len() as i64, steps);
        assert_eq!(walked.last(), Some(&to.voxel()));
    }
}
