//! Where a ray enters an axis-parallel box.

use nalgebra::{Point3, Vector3};
use occlabel_core::{GridSpec, VoxelIndex};

/// The first metres along a ray, of unit `direction`, at which it is between two corners; 0 if it
/// starts there, `None` if it never is.
pub(super) fn entry_m(
    origin: &Point3<f64>,
    direction: &Vector3<f64>,
    lower: &Point3<f64>,
    upper: &Point3<f64>,
) -> Option<f64> {
    let (mut first, mut last) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) = (lower[axis] - origin[axis], upper[axis] - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    (first <= last).then_some(first)
}

/// The metres along a ray at which it enters a voxel that the lattice walk found on its way.
///
/// The walk's ray is snapped (labels.md section 8), so the true one may pass a corner of the voxel by
/// less than a thousandth of its side: then the place nearest to the voxel's centre is taken.
pub(super) fn voxel_entry_m(
    spec: &GridSpec,
    voxel: VoxelIndex,
    origin: &Point3<f64>,
    direction: &Vector3<f64>,
) -> f64 {
    let (centre, half) = (spec.centre(voxel), spec.size_m() / 2.0);
    entry_m(origin, direction, &(centre - half), &(centre + half))
        .unwrap_or_else(|| (centre - origin).dot(direction).max(0.0))
}

/// Distance from a point to a voxel, 0 inside, metres.
pub(super) fn voxel_distance_m(spec: &GridSpec, voxel: VoxelIndex, p: &Point3<f64>) -> f64 {
    let (centre, half) = (spec.centre(voxel), spec.size_m() / 2.0);
    let beyond = |axis: usize| ((p[axis] - centre[axis]).abs() - half[axis]).max(0.0);
    Vector3::new(beyond(0), beyond(1), beyond(2)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_enters_through_the_face_it_meets_last() {
        let (lower, upper) = (Point3::new(2.0, -1.0, -1.0), Point3::new(4.0, 1.0, 1.0));
        let entry = |x: f64, way: [f64; 3]| {
            entry_m(&Point3::new(x, 0.0, 0.0), &Vector3::from(way), &lower, &upper)
        };
        assert_eq!(entry(0.0, [1.0, 0.0, 0.0]), Some(2.0));
        assert_eq!(entry(3.0, [1.0, 0.0, 0.0]), Some(0.0), "it starts inside");
        assert_eq!(entry(5.0, [1.0, 0.0, 0.0]), None, "it is behind");
        assert_eq!(entry(0.0, [0.0, 1.0, 0.0]), None, "it runs past");
        assert_eq!(entry(0.0, [0.8, 0.6, 0.0]), None, "it is through in y before it is there in x");
    }

    #[test]
    fn distance_to_a_voxel_is_to_its_nearest_face_edge_or_corner() {
        let spec = GridSpec::new([0.0; 3], [4.0; 3], [1.0; 3]).unwrap();
        let distance = |p: [f64; 3]| voxel_distance_m(&spec, VoxelIndex([1, 1, 1]), &p.into());
        assert_eq!(distance([1.2, 1.9, 1.0]), 0.0);
        assert_eq!(distance([2.5, 1.5, 1.5]), 0.5);
        assert!((distance([2.3, 2.4, 1.5]) - 0.5).abs() < 1e-12);
    }
}
