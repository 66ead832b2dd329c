//! One ray as the textbook casts it: what the fast ways are compared with.

use nalgebra::{Point3, Vector3};

use super::grid::RayGrid;
use super::hit::{RayEnd, RayHit};

/// Where a ray that starts in the grid ends, by the voxel traversal of Amanatides and Woo (1987): one
/// voxel after the other, the distance to the next face of each axis summed up.
///
/// Equal to [`crate::rays::first_hit`] but for the rounding of the sums: to 1e-9 m, and to the voxel
/// where no two faces are met at once. The direction is of unit length.
pub fn textbook_first_hit(
    grid: &RayGrid,
    origin: &Point3<f64>,
    direction: &Vector3<f64>,
) -> RayEnd {
    let (start, size_m, shape) =
        (grid.spec.to_voxel_units(origin), grid.spec.size_m(), grid.spec.shape());
    let axis = |i: usize| Axis::new(start[i], size_m[i], shape[i], direction[i]);
    let (mut x, mut y, mut z) = (axis(0), axis(1), axis(2));
    let mut depth_m = 0.0;
    while x.is_inside() && y.is_inside() && z.is_inside() {
        let flat = ((x.voxel * y.count + y.voxel) * z.count + z.voxel) as usize;
        depth_m = match (x.next_m < y.next_m, x.next_m < z.next_m, y.next_m < z.next_m) {
            (true, true, _) => x.cross(),
            (false, _, true) => y.cross(),
            _ => z.cross(),
        };
        if grid.is_occupied(flat) {
            return RayEnd::Hit(RayHit { flat: flat as u32, depth_m });
        }
    }
    RayEnd::Free { depth_m }
}

/// How far the ray has come along an axis.
struct Axis {
    voxel: i64,
    count: i64,
    step: i64,
    /// When the next face is met, and how far faces are apart, metres.
    next_m: f64,
    delta_m: f64,
}

impl Axis {
    #[inline(always)]
    fn new(start: f64, size_m: f64, count: usize, direction: f64) -> Self {
        let (voxel, step) = (start.floor(), if direction >= 0.0 { 1 } else { -1 });
        let mut axis = Self {
            voxel: voxel as i64,
            count: count as i64,
            step,
            next_m: f64::INFINITY,
            delta_m: f64::INFINITY,
        };
        if direction != 0.0 {
            let metres = size_m / direction;
            let face = if step > 0 { voxel + 1.0 } else { voxel };
            (axis.next_m, axis.delta_m) = ((face - start) * metres, metres.abs());
        }
        axis
    }

    #[inline(always)]
    fn is_inside(&self) -> bool {
        0 <= self.voxel && self.voxel < self.count
    }

    /// Goes through the next face; when that was, metres.
    #[inline(always)]
    fn cross(&mut self) -> f64 {
        let met_m = self.next_m;
        self.voxel += self.step;
        self.next_m += self.delta_m;
        met_m
    }
}
