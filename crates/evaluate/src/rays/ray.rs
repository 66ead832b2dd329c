//! When a ray meets which face: the only place that knows.
//!
//! ```text
//!   face     0        1        2        3      u = (origin - min) / size, in voxels
//!            |  v 0   |  v 1   |  v 2   |      a ray with d >= 0 leaves voxel v through face v + 1,
//!            |        |   u--->|        |      one with d < 0 through face v
//! ```
//!
//! A face is met at (face - u) * size / d metres. That is always computed anew, never added up, so it
//! is the same whichever way a voxel was found. Of faces met at once, the one of the higher axis is
//! crossed first.

use nalgebra::{Point3, Vector3};
use occlabel_core::GridSpec;

/// Where rays start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// In voxels.
    pub(super) voxels: [f64; 3],
    /// The voxel.
    pub(super) first: [i64; 3],
    size_m: [f64; 3],
}

impl Start {
    /// A point of the grid frame.
    pub(super) fn new(spec: &GridSpec, origin: &Point3<f64>) -> Self {
        let voxels: [f64; 3] = spec.to_voxel_units(origin).into();
        Self { voxels, first: voxels.map(|u| u.floor() as i64), size_m: spec.size_m().into() }
    }

    /// The ray in a direction, axis by axis.
    #[inline]
    pub(super) fn ray(&self, direction: &Vector3<f64>) -> [Axis; 3] {
        [self.axis(0, direction.x), self.axis(1, direction.y), self.axis(2, direction.z)]
    }

    /// A ray along one axis.
    #[inline(always)]
    pub(super) fn axis(&self, axis: usize, direction: f64) -> Axis {
        let step = if direction >= 0.0 { 1 } else { -1 };
        let metres = if direction == 0.0 { f64::INFINITY } else { self.size_m[axis] / direction };
        Axis { start: self.voxels[axis], first: self.first[axis], metres, step }
    }
}

/// A ray along one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Where it starts, voxels.
    pub(super) start: f64,
    /// The voxel it starts in.
    pub(super) first: i64,
    /// Metres of the ray a voxel; negative downwards, infinite if it never moves.
    metres: f64,
    /// 1 or -1; 1 if it never moves, so that no face ahead is where it starts.
    pub(super) step: i64,
}

impl Axis {
    /// When a face is met, metres; never if the ray does not move along the axis.
    #[inline]
    pub(super) fn face_m(&self, face: i64) -> f64 {
        (face as f64 - self.start) * self.metres
    }

    /// When a voxel is left, metres.
    #[inline]
    pub(super) fn leaves_m(&self, voxel: i64) -> f64 {
        self.face_m(voxel + i64::from(self.step > 0))
    }

    /// When a voxel ahead of the first is entered, metres.
    #[inline]
    pub(super) fn enters_m(&self, voxel: i64) -> f64 {
        self.leaves_m(voxel - self.step)
    }

    /// The voxel once all faces are crossed that `is_crossed` says, of the metres at which they are
    /// met. That must be true up to about `reach_m` metres, and false from there on.
    #[inline]
    pub(super) fn voxel_at(&self, reach_m: f64, is_crossed: impl Fn(f64) -> bool) -> i64 {
        let near = (self.start + reach_m / self.metres) as i64;
        let mut ahead = ((near - self.first) * self.step).max(0);
        while ahead > 0 && !is_crossed(self.enters_m(self.first + ahead * self.step)) {
            ahead -= 1;
        }
        while is_crossed(self.leaves_m(self.first + ahead * self.step)) {
            ahead += 1;
        }
        self.first + ahead * self.step
    }
}
