//! Rays walked side by side.
//!
//! The walk of [`occlabel_core::walk`] in 32 bits, without a branch: in each turn every ray steps
//! through the face that it meets next, and one more voxel of each is crossed. A ray that has made
//! its steps goes on into a voxel that nobody reads.
//!
//! Why 32 bits are enough: `x_y` is `t_x - t_y` of the next faces times half of both ways. It stays
//! within one step's worth of `t`, so `|x_y| <= 2048 * half < 2^31` for ways of less than 1024
//! voxels, and sums that wrap on the way come out right.

use std::hint::black_box;

use occlabel_core::LATTICE;

use crate::cells::Cell;
use crate::ways::{LANES, Lane, Ways};

/// Steps along x, y and z, counted in one number, each field below a guard bit.
const UNITS: [i32; 3] = [1, 1 << 11, 1 << 22];
const GUARDS: i32 = 1 << 10 | 1 << 21 | 1 << 31;

/// The most voxels along each axis of a grid whose walks can be so counted, with room for the part
/// of a ray before it enters.
pub(crate) const MOST_VOXELS: [usize; 3] = [1000, 1000, 500];

/// Where walks begin, where they end, and what of them counts.
pub(crate) struct Walks {
    /// Faces met before the walk begins.
    pub(crate) from: [Lane; 3],
    /// Steps still to take along x, y and z: a step too many sets a guard bit.
    left: Lane,
    /// All guard bits are set once the ray is in the grid.
    entered: Lane,
    /// Above 0 once the hit is far enough behind.
    pub(crate) past_hit: Lane,
    /// Above 0 while the origin is far enough ahead.
    pub(crate) to_origin: Lane,
    /// Not below 0 once the ground is far enough away.
    pub(crate) off_ground: Lane,
}

impl Walks {
    /// From where the rays have met `from` faces to their ends, or to where they leave the grid.
    #[inline(always)]
    pub(crate) fn new(ways: &Ways, from: [Lane; 3], shape: [i32; 3]) -> Self {
        let (mut left, mut entered, mut gone): (Lane, Lane, Lane) =
            ([0; LANES], [0; LANES], [0; LANES]);
        let guards = [1_i32 << 10, 1 << 10, 1 << 9];
        for axis in 0..3 {
            for lane in 0..LANES {
                // Seen in the direction of the ray, the grid's voxels are numbered from 0.
                let back = ways.back[axis][lane];
                let at = (ways.start[axis][lane] ^ back) - back + (back & (shape[axis] - 1));
                let at = at + from[axis][lane];
                let (steps, border) =
                    (ways.faces[axis][lane] - from[axis][lane], shape[axis] - 1 - at);
                left[lane] = left[lane].wrapping_add(steps.min(border).wrapping_mul(UNITS[axis]));
                gone[lane] |= border >> 31;
                let ahead = guards[axis] - (-at).max(0);
                entered[lane] = entered[lane].wrapping_add(ahead.wrapping_mul(UNITS[axis]));
            }
        }
        for lane in 0..LANES {
            left[lane] &= !gone[lane];
        }
        let (past_hit, to_origin, off_ground) = ([1; LANES], [i32::MAX; LANES], [0; LANES]);
        Self { from, left, entered, past_hit, to_origin, off_ground }
    }
}

/// Walks: each voxel entered is crossed. The last cell is nobody's.
///
/// With `MASKED`, only those crossings count that [`Walks`] allows; without, all rays begin in the
/// grid and no rule forbids any.
#[inline(always)]
pub(crate) fn walk_lanes<C: Cell, const MASKED: bool>(
    ways: &Ways,
    walks: Walks,
    strides: [i32; 3],
    cells: &mut [C],
) {
    let nobodys = cells.len() as i32 - 1;
    let Front { half, stride, mut flat, mut x_y, mut x_z, mut y_z } =
        Front::new(ways, &walks.from, strides);
    let Walks { mut left, mut entered, mut past_hit, mut to_origin, mut off_ground, .. } = walks;
    let mut done = [0; LANES];
    loop {
        let (mut crossed, mut all_done) = ([0; LANES], -1);
        for lane in 0..LANES {
            let is_x = -i32::from(x_y[lane] <= 0) & -i32::from(x_z[lane] <= 0);
            let is_y = !is_x & -i32::from(y_z[lane] <= 0);
            let is_z = !(is_x | is_y);
            let choose = |x: i32, y: i32, z: i32| (x & is_x) | (y & is_y) | (z & is_z);
            let [per_x, per_y, per_z] = [half[0][lane], half[1][lane], half[2][lane]];
            flat[lane] += choose(stride[0][lane], stride[1][lane], stride[2][lane]);
            x_y[lane] = x_y[lane].wrapping_add(per_y & is_x).wrapping_sub(per_x & is_y);
            x_z[lane] = x_z[lane].wrapping_add(per_z & is_x).wrapping_sub(per_x & is_z);
            y_z[lane] = y_z[lane].wrapping_add(per_z & is_y).wrapping_sub(per_y & is_z);
            let step = choose(UNITS[0], UNITS[1], UNITS[2]);
            left[lane] = left[lane].wrapping_sub(step);
            done[lane] |= -i32::from(left[lane] & GUARDS != 0);
            all_done &= done[lane];
            let mut hidden = done[lane];
            if MASKED {
                entered[lane] = entered[lane].wrapping_add(step);
                past_hit[lane] += 1;
                to_origin[lane] -= 1;
                off_ground[lane] -= is_z;
                hidden |= -i32::from(entered[lane] & GUARDS != GUARDS);
                hidden |= -i32::from(past_hit[lane] <= 0) | -i32::from(to_origin[lane] <= 0);
                hidden |= -i32::from(off_ground[lane] < 0);
            }
            crossed[lane] = (flat[lane] & !hidden) | (nobodys & hidden);
        }
        if all_done != 0 {
            return;
        }
        // By way of memory, which is faster than out of a wide register one by one.
        let crossed = black_box(&crossed);
        for lane in 0..LANES {
            if let Some(cell) = cells.get_mut(crossed[lane] as usize) {
                cell.cross();
            }
        }
    }
}

/// How far the walks have come.
struct Front {
    /// Half of each way, times the lattice units of a voxel.
    half: [Lane; 3],
    stride: [Lane; 3],
    flat: Lane,
    /// `t_x - t_y` of the next faces, times half of both ways; and so on.
    x_y: Lane,
    x_z: Lane,
    y_z: Lane,
}

impl Front {
    #[inline(always)]
    fn new(ways: &Ways, from: &[Lane; 3], strides: [i32; 3]) -> Self {
        let zero = [[0; LANES]; 3];
        let (mut half, mut stride, mut to_face) = (zero, zero, zero);
        let mut flat = [0_i32; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let (met, back) = (from[axis][lane], ways.back[axis][lane]);
                let voxel = ways.start[axis][lane] + ((met ^ back) - back);
                half[axis][lane] = ways.full[axis][lane] >> 1;
                to_face[axis][lane] = ways.face[axis][lane] + met * LATTICE as i32;
                stride[axis][lane] = (strides[axis] ^ back) - back;
                flat[lane] = flat[lane].wrapping_add(voxel.wrapping_mul(strides[axis]));
            }
        }
        let x_y = cross(&half, &to_face, 0, 1);
        let x_z = cross(&half, &to_face, 0, 2);
        let y_z = cross(&half, &to_face, 1, 2);
        for axis in 0..3 {
            for lane in 0..LANES {
                half[axis][lane] <<= LATTICE.trailing_zeros();
            }
        }
        Self { half, stride, flat, x_y, x_z, y_z }
    }
}

#[inline(always)]
fn cross(half: &[Lane; 3], to_face: &[Lane; 3], a: usize, b: usize) -> Lane {
    let mut cross = [0; LANES];
    for lane in 0..LANES {
        let a_b = to_face[a][lane].wrapping_mul(half[b][lane]);
        let b_a = to_face[b][lane].wrapping_mul(half[a][lane]);
        cross[lane] = a_b.wrapping_sub(b_a);
    }
    cross
}
