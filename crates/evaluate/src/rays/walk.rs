//! The voxels of one ray, one after the other.

use nalgebra::Vector3;

use super::ray::{Axis, Start};

/// Starts farther away than this never come to the grid, voxels.
const FAR: f64 = (1_u64 << 50) as f64;

/// How far a ray has come.
pub(super) struct Walk {
    axes: [Axis; 3],
    shape: [i64; 3],
    voxel: [i64; 3],
    /// When the voxel is left along each axis, metres.
    leaves_m: [f64; 3],
}

impl Walk {
    /// A ray at the first voxel of the grid on its way; none if it never comes there.
    #[inline]
    pub(super) fn new(start: &Start, direction: &Vector3<f64>, shape: [usize; 3]) -> Option<Self> {
        if !start.voxels.iter().all(|u| u.abs() < FAR) {
            return None;
        }
        let axes = start.ray(direction);
        let voxel = axes.map(|axis| axis.first);
        let mut walk = Self { axes, shape: shape.map(|n| n as i64), voxel, leaves_m: [0.0; 3] };
        walk.look_ahead();
        (walk.is_inside() || walk.enter()).then_some(walk)
    }

    /// The place of its voxel in the flat array, while it is inside.
    #[inline]
    pub(super) fn flat(&self) -> usize {
        let ([x, y, z], [_, ny, nz]) = (self.voxel, self.shape);
        ((x * ny + y) * nz + z) as usize
    }

    #[inline]
    pub(super) fn is_inside(&self) -> bool {
        (0..3).all(|axis| (0..self.shape[axis]).contains(&self.voxel[axis]))
    }

    /// Moves on to the next voxel; where the last one was left, metres.
    #[inline]
    pub(super) fn advance(&mut self) -> f64 {
        let [x_m, y_m, z_m] = self.leaves_m;
        match (x_m < y_m, x_m < z_m, y_m < z_m) {
            (true, true, _) => self.cross::<0>(),
            (false, _, true) => self.cross::<1>(),
            _ => self.cross::<2>(),
        }
    }

    #[inline(always)]
    fn cross<const AXIS: usize>(&mut self) -> f64 {
        let left_m = self.leaves_m[AXIS];
        self.voxel[AXIS] += self.axes[AXIS].step;
        self.leaves_m[AXIS] = self.axes[AXIS].leaves_m(self.voxel[AXIS]);
        left_m
    }

    fn look_ahead(&mut self) {
        self.leaves_m = std::array::from_fn(|axis| self.axes[axis].leaves_m(self.voxel[axis]));
    }

    /// Jumps almost to the grid and walks the rest; whether it comes there.
    #[cold]
    fn enter(&mut self) -> bool {
        let Some(reach_m) = self.reach_m() else { return false };
        self.voxel = self.axes.map(|axis| axis.voxel_at(reach_m, |met_m| met_m < reach_m));
        self.look_ahead();
        while !self.is_inside() {
            if self.is_past() {
                return false;
            }
            self.advance();
        }
        true
    }

    /// When the last axis comes into range, metres; `None` if one never does, or another has left its
    /// range by then.
    fn reach_m(&self) -> Option<f64> {
        let (mut reach_m, mut leaves_m) = (0.0_f64, f64::INFINITY);
        for (axis, n) in self.axes.iter().zip(self.shape) {
            let [near, far] = if axis.step > 0 { [0, n] } else { [n, 0] };
            leaves_m = leaves_m.min(axis.face_m(far));
            if !(0..n).contains(&axis.first) {
                reach_m = reach_m.max(axis.face_m(near));
            }
        }
        (reach_m <= leaves_m && reach_m.is_finite()).then_some(reach_m)
    }

    /// Whether it has gone by the grid along an axis.
    fn is_past(&self) -> bool {
        (0..3).any(|axis| match self.axes[axis].step > 0 {
            true => self.voxel[axis] >= self.shape[axis],
            false => self.voxel[axis] < 0,
        })
    }
}
