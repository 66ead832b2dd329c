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
    let (start, size_m) = (grid.spec.to_voxel_units(origin), grid.spec.size_m());
    let [nx, ny, nz] = grid.spec.shape().map(|n| n as i64);
    let (mut voxel, mut step) = ([0_i64; 3], [1_i64; 3]);
    let (mut next_m, mut delta_m) = ([f64::INFINITY; 3], [f64::INFINITY; 3]);
    for axis in 0..3 {
        voxel[axis] = start[axis].floor() as i64;
        if direction[axis] != 0.0 {
            let rate = size_m[axis] / direction[axis];
            step[axis] = if direction[axis] > 0.0 { 1 } else { -1 };
            let face = voxel[axis] + i64::from(step[axis] > 0);
            next_m[axis] = (face as f64 - start[axis]) * rate;
            delta_m[axis] = rate.abs();
        }
    }
    let mut depth_m = 0.0;
    loop {
        let [x, y, z] = voxel;
        if !((0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z)) {
            return RayEnd::Free { depth_m };
        }
        let [tx, ty, tz] = next_m;
        let axis = if tx < ty {
            if tx < tz { 0 } else { 2 }
        } else if ty < tz {
            1
        } else {
            2
        };
        depth_m = next_m[axis];
        voxel[axis] += step[axis];
        next_m[axis] += delta_m[axis];
        let flat = ((x * ny + y) * nz + z) as usize;
        if grid.is_occupied(flat) {
            return RayEnd::Hit(RayHit { flat: flat as u32, depth_m });
        }
    }
}
