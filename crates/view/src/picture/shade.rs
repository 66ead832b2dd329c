//! How bright a point of a voxel's face is.

use nalgebra::Vector3;

use crate::picture::cast::Hit;

/// What the light of a face is by the axis it lies across: the two kinds of walls differ, so that
/// corners show.
const WALL_LIGHT: [f64; 2] = [0.80, 0.64];
const TOP_LIGHT: f64 = 1.0;
const UNDER_LIGHT: f64 = 0.5;
/// What each neighbour that stands over a face's corner takes from the light there.
const CORNER_SHADE: f64 = 0.16;
/// The joint between voxels: how much darker, and from how many pixels a voxel on it is drawn in
/// full; smaller voxels would drown in their joints.
const JOINT_SHADE: f64 = 0.20;
const JOINT_FULL_PX: f64 = 10.0;
const JOINT_NONE_PX: f64 = 3.0;

/// The light on a face by how it stands.
pub(crate) fn face_light(hit: &Hit) -> f64 {
    match (hit.axis, hit.normal) {
        (2, 1) => TOP_LIGHT,
        (2, _) => UNDER_LIGHT,
        (axis, _) => WALL_LIGHT[axis],
    }
}

/// The share of the sky that the neighbours leave to a point (voxel units) of a face: counted at the
/// face's four corners, and blended between them.
pub(crate) fn sky_light(hit: &Hit, at: &Vector3<f64>, solid: impl Fn([i64; 3]) -> bool) -> f64 {
    let (a, b) = ((hit.axis + 1) % 3, (hit.axis + 2) % 3);
    let over = |da: i64, db: i64| {
        let mut voxel = hit.voxel;
        voxel[hit.axis] += hit.normal;
        voxel[a] += da;
        voxel[b] += db;
        solid(voxel)
    };
    let corner = |da: i64, db: i64| {
        let sides = i32::from(over(da, 0)) + i32::from(over(0, db));
        let hidden = if sides == 2 { 3 } else { sides + i32::from(over(da, db)) };
        1.0 - CORNER_SHADE * f64::from(hidden)
    };
    let (share_a, share_b) = (at[a] - hit.voxel[a] as f64, at[b] - hit.voxel[b] as f64);
    let blend = |low: f64, high: f64, share: f64| low + (high - low) * share;
    let near = blend(corner(-1, -1), corner(1, -1), share_a);
    let far = blend(corner(-1, 1), corner(1, 1), share_a);
    blend(near, far, share_b)
}

/// The light that the joint between voxels leaves to a point of a face, where a voxel is drawn
/// `voxel_px` pixels large.
pub(crate) fn joint_light(hit: &Hit, at: &Vector3<f64>, voxel_px: f64) -> f64 {
    let strength = ((voxel_px - JOINT_NONE_PX) / (JOINT_FULL_PX - JOINT_NONE_PX)).clamp(0.0, 1.0);
    let off = |axis: usize| {
        let share = at[axis] - hit.voxel[axis] as f64;
        share.min(1.0 - share)
    };
    let off_px = off((hit.axis + 1) % 3).min(off((hit.axis + 2) % 3)) * voxel_px;
    1.0 - JOINT_SHADE * strength * (1.0 - off_px).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn top() -> Hit {
        Hit { voxel: [5, 5, 5], flat: Some(0), axis: 2, normal: 1, t: 1.0 }
    }

    #[test]
    fn a_wall_beside_a_face_darkens_its_side_and_not_the_other() {
        let wall = |voxel: [i64; 3]| voxel[0] == 6 && voxel[2] == 6;
        let light = |x: f64| sky_light(&top(), &Vector3::new(x, 5.5, 6.0), wall);
        assert!((light(5.0) - 1.0).abs() < 1e-12);
        assert!((light(6.0) - (1.0 - 2.0 * CORNER_SHADE)).abs() < 1e-12, "side and corner");
        assert!((light(5.5) - (1.0 - CORNER_SHADE)).abs() < 1e-12);
    }

    #[test]
    fn a_corner_between_two_walls_is_as_dark_as_can_be() {
        let walls = |voxel: [i64; 3]| voxel[2] == 6 && (voxel[0] == 6) != (voxel[1] == 6);
        let light = sky_light(&top(), &Vector3::new(6.0, 6.0, 6.0), walls);
        assert!((light - (1.0 - 3.0 * CORNER_SHADE)).abs() < 1e-12);
    }

    #[test]
    fn joints_show_on_large_voxels_only() {
        let light = |y: f64, px: f64| joint_light(&top(), &Vector3::new(5.5, y, 6.0), px);
        assert_eq!(light(5.0, 20.0), 1.0 - JOINT_SHADE);
        assert_eq!([light(5.5, 20.0), light(5.0, 2.0)], [1.0, 1.0]);
    }
}
