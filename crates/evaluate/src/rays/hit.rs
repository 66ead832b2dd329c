//! What stops one ray.

use nalgebra::{Point3, Vector3};
use occlabel_core::GridSpec;

use super::grid::RayGrid;
use super::ray::{Axis, Start};
use super::walk::Walk;

/// The first occupied voxel on a ray's way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Its place in the flat array of the grid.
    pub flat: u32,
    /// How far from the origin the ray leaves it, metres.
    pub depth_m: f64,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RayEnd {
    /// In the first occupied voxel.
    Hit(RayHit),
    /// Beyond the grid; nothing in the way.
    Free {
        /// How far from the origin it leaves the grid, metres; 0 if it never comes there.
        depth_m: f64,
    },
}

impl RayEnd {
    /// What it hits, if anything.
    pub fn hit(&self) -> Option<RayHit> {
        match *self {
            Self::Hit(hit) => Some(hit),
            Self::Free { .. } => None,
        }
    }

    /// How far from the origin the ray leaves the hit voxel, or else the grid, metres.
    pub fn depth_m(&self) -> f64 {
        match *self {
            Self::Hit(RayHit { depth_m, .. }) | Self::Free { depth_m } => depth_m,
        }
    }
}

/// Where a ray from a point of the grid frame ends; the direction is of unit length.
///
/// An origin outside the grid is no obstacle: the ray may still come into it. An origin on a face
/// starts in the voxel above it, and a ray that goes down leaves that voxel after 0 metres.
pub fn first_hit(grid: &RayGrid, origin: &Point3<f64>, direction: &Vector3<f64>) -> RayEnd {
    let start = Start::new(grid.spec, origin);
    let Some(mut walk) = Walk::new(&start, direction, grid.spec.shape()) else {
        return RayEnd::Free { depth_m: 0.0 };
    };
    loop {
        let flat = walk.flat();
        let depth_m = walk.advance();
        if grid.is_occupied(flat) {
            return RayEnd::Hit(RayHit { flat: flat as u32, depth_m });
        }
        if !walk.is_inside() {
            return RayEnd::Free { depth_m };
        }
    }
}

/// Where a ray leaves the grid if nothing is in the way, metres; 0 if it never comes there.
pub(super) fn leaves_grid_m(
    spec: &GridSpec,
    origin: &Point3<f64>,
    direction: &Vector3<f64>,
) -> f64 {
    let (start, shape) = (Start::new(spec, origin), spec.shape());
    if Walk::new(&start, direction, shape).is_none() {
        return 0.0;
    }
    let far = |axis: &Axis, n: usize| axis.face_m(if axis.step > 0 { n as i64 } else { 0 });
    start
        .ray(direction)
        .iter()
        .zip(shape)
        .map(|(axis, n)| far(axis, n))
        .fold(f64::INFINITY, f64::min)
}
