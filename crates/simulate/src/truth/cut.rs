//! A cuboid cut by a plane.

use nalgebra::Vector3;

use crate::truth::ROUNDING;

/// Along an axis over which the cut moves less than this share of what it moves at most, it is taken
/// to be upright: the exact sum would drown in rounding.
const UPRIGHT: f64 = 1e-4;

/// What lies behind a plane, of a cuboid around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// Share of the cuboid's volume.
    pub(super) share: f64,
    /// Area of the plane within the cuboid, square metres; the whole face if it lies on one.
    pub(super) area_m2: f64,
}

impl Cut {
    /// Cuts a cuboid by the plane whose unit normal points out of the solid, and which the origin is
    /// `distance_m` in front of.
    ///
    /// Along the normal, a cuboid is as deep as its edges' shadows together; what lies behind the
    /// plane is a corner of it, less the corners that stick out beyond its edges.
    pub(super) fn new(half: &Vector3<f64>, normal: &Vector3<f64>, distance_m: f64) -> Self {
        let shadows = normal.abs().component_mul(half) * 2.0;
        let least = shadows.max() * UPRIGHT;
        let mut depths = [0.0; 3];
        let mut count = 0;
        for &shadow in shadows.iter().filter(|&&shadow| shadow > least) {
            depths[count] = shadow;
            count += 1;
        }
        let depths = &depths[..count];
        let depth = depths.iter().sum::<f64>();
        let reach = depth / 2.0 - distance_m;
        if (reach - depth / 2.0).abs() > depth * (0.5 + ROUNDING) {
            return Self { share: if reach > 0.0 { 1.0 } else { 0.0 }, area_m2: 0.0 };
        }
        let volume = 8.0 * half.product();
        let whole: f64 = depths.iter().product();
        // The area is the volume's slope: powers one lower, without the factor of the power.
        let lower: f64 = [1.0, 1.0, 2.0][count - 1];
        let share = corners(depths, reach, count) / (lower * count as f64 * whole);
        let area_m2 = corners(depths, reach, count - 1) * volume / (lower * whole);
        Self { share: share.clamp(0.0, 1.0), area_m2: area_m2.max(0.0) }
    }
}

/// Sum over the corners that the plane has passed, of `(reach - depth of the corner)^power`, signs
/// alternating with each edge on the way to the corner.
fn corners(depths: &[f64], reach: f64, power: usize) -> f64 {
    (0..1_u32 << depths.len())
        .map(|corner| {
            let edges = (0..depths.len()).filter(|edge| corner >> edge & 1 == 1);
            let beyond = reach - edges.map(|edge| depths[edge]).sum::<f64>();
            let sign = if corner.count_ones() % 2 == 0 { 1.0 } else { -1.0 };
            if beyond > 0.0 { sign * [beyond; 3][..power].iter().product::<f64>() } else { 0.0 }
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_cut(normal: [f64; 3], distance_m: f64, share: f64, area_m2: f64) {
        let half = Vector3::new(1.0, 1.5, 0.5);
        let cut = Cut::new(&half, &Vector3::from(normal).normalize(), distance_m);
        assert!((cut.share - share).abs() < 1e-9, "{cut:?}, expected {share}");
        assert!((cut.area_m2 - area_m2).abs() < 1e-7, "{cut:?}, expected {area_m2}");
    }

    #[test]
    fn a_plane_along_faces_cuts_a_slab() {
        assert_cut([0.0, 0.0, 1.0], 0.0, 0.5, 6.0);
        assert_cut([0.0, 0.0, -1.0], 0.25, 0.25, 6.0);
        assert_cut([1.0, 0.0, 0.0], -1.0, 1.0, 3.0);
        assert_cut([1.0, 0.0, 0.0], 1.1, 0.0, 0.0);
    }

    #[test]
    fn a_plane_along_an_edge_cuts_a_wedge_and_one_across_a_corner_a_tetrahedron() {
        // Through the origin: half, and the diagonal of a 2 x 1 side times the edge of 3.
        assert_cut([1.0, 0.0, 2.0], 0.0, 0.5, 3.0 * 5.0_f64.sqrt());
        // Corner (1, 1.5, 0.5) in front of a plane that cuts 0.6 off each edge: all else is behind.
        let distance_m = -(3.0 - 0.6) / 3.0_f64.sqrt();
        let side = 0.6 * 2.0_f64.sqrt();
        let tetrahedron = 0.6 * 0.6 * 0.6 / 6.0 / 6.0;
        assert_cut(
            [1.0, 1.0, 1.0],
            distance_m,
            1.0 - tetrahedron,
            side * side * 3.0_f64.sqrt() / 4.0,
        );
        assert_cut(
            [-1.0, -1.0, -1.0],
            -distance_m,
            tetrahedron,
            side * side * 3.0_f64.sqrt() / 4.0,
        );
    }

    #[test]
    fn a_plane_that_is_nearly_upright_cuts_nearly_as_an_upright_one() {
        for tilt in [1e-12, 1e-5, 0.9e-4, 1.1e-4, 1e-3] {
            let cut =
                Cut::new(&Vector3::repeat(0.2), &Vector3::new(tilt, tilt, 1.0).normalize(), 0.05);
            assert!((cut.share - 0.375).abs() < 2e-6 + tilt * tilt, "{tilt}: {cut:?}");
        }
    }
}
