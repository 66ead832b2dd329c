//! The same walk as [`crate::traverse`], fast and kept to the grid.
//!
//! Integer cross products are carried along instead of multiplied anew, a ray that starts outside
//! jumps to the grid by exact division, and a ray that leaves ends: a straight way never comes back.

use std::ops::ControlFlow;

use crate::{GridSpec, LATTICE, LatticePoint, VoxelIndex, traverse};

/// Rays longer than this along an axis could overflow 64 bits; they take the textbook way.
const LONGEST: i64 = 1 << 31;

/// Calls `visit(flat, voxel)` for each voxel of the grid that the way from `from` to `to` enters
/// after `from`'s own, in order, `to`'s own included, until it breaks.
///
/// Equal to [`traverse`] cut to the grid, ties included (labels.md section 8).
#[inline]
pub fn walk(
    spec: &GridSpec,
    from: LatticePoint,
    to: LatticePoint,
    mut visit: impl FnMut(usize, [i64; 3]) -> ControlFlow<()>,
) {
    let Some(mut front) = Front::new(from, to) else {
        return walk_textbook(spec, from, to, visit);
    };
    if !front.is_inside(spec) {
        if !front.enter(spec) {
            return;
        }
        let flat = front.flat(spec);
        if visit(flat, front.voxel).is_break() {
            return;
        }
    }
    front.walk_inside(spec, visit);
}

/// Calls `visit` as [`walk`] does, but first for the voxel entered through face number `faces` (from
/// 1) of `axis`; for none if the way ends before.
///
/// The way must begin in the grid.
#[inline]
pub fn walk_after(
    spec: &GridSpec,
    [from, to]: [LatticePoint; 2],
    (axis, faces): (usize, i64),
    mut visit: impl FnMut(usize, [i64; 3]) -> ControlFlow<()>,
) {
    let Some(mut front) = Front::new(from, to) else {
        let is_after = |at: [i64; 3]| (at[axis] - from.voxel().0[axis]).abs() >= faces;
        let late =
            |flat, at| if is_after(at) { visit(flat, at) } else { ControlFlow::Continue(()) };
        return walk_textbook(spec, from, to, late);
    };
    if front.left[axis] < faces {
        return;
    }
    front.pass_face(axis, faces);
    if front.is_inside(spec) && visit(front.flat(spec), front.voxel).is_continue() {
        front.walk_inside(spec, visit);
    }
}

#[cold]
fn walk_textbook(
    spec: &GridSpec,
    from: LatticePoint,
    to: LatticePoint,
    mut visit: impl FnMut(usize, [i64; 3]) -> ControlFlow<()>,
) {
    for voxel in traverse(from, to) {
        if let Some(flat) = spec.flat(voxel)
            && visit(flat, voxel.0).is_break()
        {
            return;
        }
    }
}

/// How far a walk has come.
struct Front {
    voxel: [i64; 3],
    step: [i64; 3],
    /// The ray's length along each axis.
    length: [i64; 3],
    /// How far along each axis the next face lies from the start.
    to_face: [i64; 3],
    /// Steps still to take along each axis.
    left: [i64; 3],
}

impl Front {
    #[inline]
    fn new(from: LatticePoint, to: LatticePoint) -> Option<Self> {
        let (VoxelIndex(voxel), VoxelIndex(end)) = (from.voxel(), to.voxel());
        let mut front = Self { voxel, step: [0; 3], length: [0; 3], to_face: [0; 3], left: [0; 3] };
        for axis in 0..3 {
            let way = to.0[axis] - from.0[axis];
            let within = from.0[axis] & (LATTICE - 1);
            front.step[axis] = way.signum();
            front.length[axis] = way.abs();
            front.to_face[axis] = if way > 0 { LATTICE - within } else { within };
            front.left[axis] = (end[axis] - voxel[axis]).abs();
        }
        (front.length.iter().all(|&length| length <= LONGEST)).then_some(front)
    }

    #[inline]
    fn is_inside(&self, spec: &GridSpec) -> bool {
        spec.flat(VoxelIndex(self.voxel)).is_some()
    }

    #[inline]
    fn flat(&self, spec: &GridSpec) -> usize {
        let strides = spec.strides();
        (0..3).map(|axis| self.voxel[axis] as usize * strides[axis]).sum()
    }

    /// Moves to the first voxel of the grid on the way; `false` if there is none.
    fn enter(&mut self, spec: &GridSpec) -> bool {
        let Some((axis, steps)) = self.last_face(spec) else { return false };
        self.pass_face(axis, steps);
        self.is_inside(spec)
    }

    /// Moves to the voxel entered through face number `steps` of an axis.
    fn pass_face(&mut self, axis: usize, steps: i64) {
        let moment = self.to_face[axis] + (steps - 1) * LATTICE;
        let done: [i64; 3] = std::array::from_fn(|other| {
            if other == axis { steps } else { self.steps_before(other, moment, axis) }
        });
        for other in 0..3 {
            self.voxel[other] += self.step[other] * done[other];
            self.to_face[other] += LATTICE * done[other];
            self.left[other] -= done[other];
        }
    }

    /// Of the faces through which each axis comes into range: the one met last, and how many steps
    /// its axis takes to get through it. `None` if an axis never gets there.
    fn last_face(&self, spec: &GridSpec) -> Option<(usize, i64)> {
        let mut last: Option<(usize, i64)> = None;
        for axis in 0..3 {
            let steps = self.steps_to_range(axis, spec.shape()[axis] as i64)?;
            if steps > 0
                && last.is_none_or(|(other, taken)| self.is_later(axis, steps, other, taken))
            {
                last = Some((axis, steps));
            }
        }
        last
    }

    /// Steps until the axis is in `0..n`; `None` if the ray does not go there.
    fn steps_to_range(&self, axis: usize, n: i64) -> Option<i64> {
        let at = self.voxel[axis];
        let (steps, towards) = if at < 0 { (-at, 1) } else { (at - (n - 1), -1) };
        if steps <= 0 {
            return Some(0);
        }
        (self.step[axis] == towards && steps <= self.left[axis]).then_some(steps)
    }

    /// Whether face number `steps` of `axis` comes after face number `taken` of the lower axis `other`.
    fn is_later(&self, axis: usize, steps: i64, other: usize, taken: i64) -> bool {
        let moment = self.to_face[axis] + (steps - 1) * LATTICE;
        let rival = self.to_face[other] + (taken - 1) * LATTICE;
        moment * self.length[other] >= rival * self.length[axis]
    }

    /// How many faces of `other` come before the face of `axis` at `moment`: earlier, or at the same
    /// time and of a lower axis.
    fn steps_before(&self, other: usize, moment: i64, axis: usize) -> i64 {
        if self.left[other] == 0 {
            return 0;
        }
        let product = moment * self.length[other];
        let reach = if other < axis { product } else { product - 1 } / self.length[axis];
        let past = reach - self.to_face[other];
        if past < 0 { 0 } else { (past / LATTICE + 1).min(self.left[other]) }
    }

    /// Walks from a voxel of the grid to the end or the grid's border.
    ///
    /// `x_y <= 0` says that the next face of x comes no later than that of y, and so on.
    #[inline]
    fn walk_inside(
        self,
        spec: &GridSpec,
        mut visit: impl FnMut(usize, [i64; 3]) -> ControlFlow<()>,
    ) {
        let [mut x, mut y, mut z] = self.voxel;
        let [step_x, step_y, step_z] = self.step;
        let [last_x, last_y, last_z] = self.border(spec);
        let [stride_x, stride_y, stride_z] = self.signed_strides(spec);
        let [per_x, per_y, per_z] = self.length.map(|length| length * LATTICE);
        let [mut x_y, mut x_z, mut y_z] = self.crosses();
        let mut flat = self.flat(spec) as i64;
        for _ in 0..self.left.iter().sum() {
            if x_y <= 0 && x_z <= 0 {
                if x == last_x {
                    return;
                }
                (x, flat, x_y, x_z) = (x + step_x, flat + stride_x, x_y + per_y, x_z + per_z);
            } else if y_z <= 0 {
                if y == last_y {
                    return;
                }
                (y, flat, x_y, y_z) = (y + step_y, flat + stride_y, x_y - per_x, y_z + per_z);
            } else {
                if z == last_z {
                    return;
                }
                (z, flat, x_z, y_z) = (z + step_z, flat + stride_z, x_z - per_x, y_z - per_y);
            }
            if visit(flat as usize, [x, y, z]).is_break() {
                return;
            }
        }
    }

    /// The last index in the grid in the direction of each axis.
    fn border(&self, spec: &GridSpec) -> [i64; 3] {
        std::array::from_fn(
            |axis| if self.step[axis] > 0 { spec.shape()[axis] as i64 - 1 } else { 0 },
        )
    }

    fn signed_strides(&self, spec: &GridSpec) -> [i64; 3] {
        let strides = spec.strides();
        std::array::from_fn(|axis| self.step[axis] * strides[axis] as i64)
    }

    /// t_x - t_y, t_x - t_z, t_y - t_z of the next faces, each times both lengths.
    fn crosses(&self) -> [i64; 3] {
        let ([fx, fy, fz], [lx, ly, lz]) = (self.to_face, self.length);
        [fx * ly - fy * lx, fx * lz - fz * lx, fy * lz - fz * ly]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell;

    fn spec() -> GridSpec {
        GridSpec::new([0.0; 3], [7.0, 5.0, 4.0], [1.0; 3]).unwrap()
    }

    fn fast(from: LatticePoint, to: LatticePoint) -> Vec<VoxelIndex> {
        let mut seen = Vec::new();
        walk(&spec(), from, to, |flat, voxel| {
            assert_eq!(spec().flat(VoxelIndex(voxel)), Some(flat));
            seen.push(VoxelIndex(voxel));
            ControlFlow::Continue(())
        });
        seen
    }

    fn textbook(from: LatticePoint, to: LatticePoint) -> Vec<VoxelIndex> {
        traverse(from, to).filter(|voxel| spec().flat(*voxel).is_some()).collect()
    }

    /// Ends near the grid, often on a coarse lattice, so that ties, axis-parallel rays and rays
    /// within one voxel come up all the time.
    fn end() -> impl Strategy<Value = LatticePoint> {
        let coarse = || (-8_i64..12).prop_map(|voxel| voxel * LATTICE + 1025);
        let fine = || (-12 * LATTICE..16 * LATTICE).prop_map(|q| q | 1);
        let mixed = || prop_oneof![coarse(), fine()];
        prop_oneof![[coarse(), coarse(), coarse()], [mixed(), mixed(), mixed()]]
            .prop_map(LatticePoint)
    }

    #[test]
    fn section_8_the_fast_walk_is_the_textbook_walk_cut_to_the_grid() {
        let (rays, voxels, entering, ties) =
            (Cell::new(0), Cell::new(0), Cell::new(0), Cell::new(0));
        proptest!(ProptestConfig::with_cases(20_000), |(from in end(), to in end())| {
            let expected = textbook(from, to);
            prop_assert_eq!(fast(from, to), expected.clone());
            rays.set(rays.get() + 1);
            voxels.set(voxels.get() + expected.len());
            let outside = spec().flat(from.voxel()).is_none();
            entering.set(entering.get() + usize::from(outside && !expected.is_empty()));
            let way: Vec<i64> = (0..3).map(|a| (to.0[a] - from.0[a]).abs()).collect();
            ties.set(ties.get() + usize::from(way[0] == way[1] && way[0] > 0));
        });
        assert_eq!(rays.get(), 20_000);
        assert!(voxels.get() > 10_000, "{} voxels", voxels.get());
        assert!(entering.get() > 2_000, "{} rays came from outside", entering.get());
        assert!(ties.get() > 100, "{} rays ran along a diagonal", ties.get());
    }

    /// The voxels visited after a face.
    fn after(from: LatticePoint, to: LatticePoint, face: (usize, i64)) -> Vec<VoxelIndex> {
        let mut seen = Vec::new();
        walk_after(&spec(), [from, to], face, |_, voxel| {
            seen.push(VoxelIndex(voxel));
            ControlFlow::Continue(())
        });
        seen
    }

    #[test]
    fn section_8_a_walk_after_a_face_is_the_rest_of_the_walk() {
        let (rays, rests) = (Cell::new(0), Cell::new(0));
        proptest!(ProptestConfig::with_cases(20_000), |(from in end(), to in end(), axis in 0_usize..3, faces in 1_i64..5)| {
            let sides = spec().shape().map(|n| n as i64 * LATTICE);
            let from = LatticePoint([0, 1, 2].map(|axis: usize| from.0[axis].rem_euclid(sides[axis])));
            let is_after = |voxel: &VoxelIndex| (voxel.0[axis] - from.voxel().0[axis]).abs() >= faces;
            let rest: Vec<_> = textbook(from, to).into_iter().filter(is_after).collect();
            prop_assert_eq!(after(from, to, (axis, faces)), rest.clone());
            rays.set(rays.get() + 1);
            rests.set(rests.get() + usize::from(!rest.is_empty()));
        });
        assert!(rays.get() == 20_000 && rests.get() > 5_000, "{} of {}", rests.get(), rays.get());
    }

    #[test]
    fn fault_07_a_walk_after_a_face_may_be_beyond_64_bits() {
        let from = LatticePoint([3 * LATTICE + 1, 1, 1]);
        let to = LatticePoint([3 * LATTICE + 1, 1, 1 << 33 | 1]);
        assert_eq!(after(from, to, (2, 3)), [VoxelIndex([3, 0, 3])]);
    }

    #[test]
    fn fault_07_rays_beyond_64_bits_take_the_textbook_way() {
        let (from, to) = (
            LatticePoint([3 * LATTICE + 1, 1, 1]),
            LatticePoint([3 * LATTICE + 1, 1, 1 << 33 | 1]),
        );
        let mut seen = 0;
        walk(&spec(), from, to, |_, _| {
            seen += 1;
            if seen == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(seen, 3);
    }

    #[test]
    fn a_break_ends_the_walk() {
        let mut seen = 0;
        walk(&spec(), LatticePoint([1, 1, 1]), LatticePoint([6 * LATTICE + 1, 1, 1]), |_, _| {
            seen += 1;
            ControlFlow::Break(())
        });
        assert_eq!(seen, 1);
    }
}
