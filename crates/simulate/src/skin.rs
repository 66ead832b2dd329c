//! The surfaces of shapes as triangles.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point3, Rotation3, Vector3};

/// So many corners are around what is round: 5 mm from one to the next around a wrist, 5 cm around a
/// waist, of which the chords stand 2 mm off.
const AROUND: u32 = 24;
/// So many rings are from the equator of a round end to its pole.
const RINGS: u32 = 6;

/// Corners, and triangles between them, counter-clockwise seen from outside.
pub(crate) type Skin = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// A capsule: two half balls around the ends of a segment.
pub(crate) fn capsule(from: &Point3<f64>, to: &Point3<f64>, radius_m: f64) -> Skin {
    let way = to - from;
    let angle = |ring: u32| f64::from(ring) / f64::from(RINGS) * FRAC_PI_2;
    let ring = |along_m: f64, (sin, cos): (f64, f64)| [radius_m * cos, along_m + radius_m * sin];
    let lower = (0..=RINGS).rev().map(|n| ring(0.0, libm::sincos(-angle(n))));
    let upper = (0..=RINGS).map(|n| ring(way.norm(), libm::sincos(angle(n))));
    let (corners, faces) = lathe(&lower.chain(upper).collect::<Vec<_>>());
    let axis = way.try_normalize(1e-9).unwrap_or_else(Vector3::z);
    let turn = Rotation3::rotation_between(&Vector3::z(), &axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    (corners.iter().map(|corner| from + turn * corner.coords).collect(), faces)
}

/// A cylinder around the z axis, half of it above the origin.
pub(crate) fn cylinder(radius_m: f64, half_m: f64) -> Skin {
    lathe(&[[0.0, -half_m], [radius_m, -half_m], [radius_m, half_m], [0.0, half_m]])
}

/// What rings around the z axis enclose: the radius and the height of each, from the lowest.
fn lathe(rings: &[[f64; 2]]) -> Skin {
    let corner = |[radius_m, z_m]: &[f64; 2], at: u32| {
        let (sin, cos) = libm::sincos(f64::from(at) / f64::from(AROUND) * TAU);
        Point3::new(radius_m * cos, radius_m * sin, *z_m)
    };
    let corners = rings.iter().flat_map(|ring| (0..AROUND).map(move |at| corner(ring, at)));
    let corners: Vec<_> = corners.collect();
    let place = |ring: usize, at: u32| ring as u32 * AROUND + at % AROUND;
    let mut faces = Vec::new();
    for (ring, at) in (1..rings.len()).flat_map(|ring| (0..AROUND).map(move |at| (ring, at))) {
        let [a, b] = [0, 1].map(|step| place(ring - 1, at + step));
        let [c, d] = [0, 1].map(|step| place(ring, at + step));
        faces.extend([[a, b, c], [b, d, c]].into_iter().filter(|face| has_area(&corners, *face)));
    }
    (corners, faces)
}

/// Triangles at a pole may have none.
fn has_area(corners: &[Point3<f64>], face: [u32; 3]) -> bool {
    let [a, b, c] = face.map(|at| corners[at as usize]);
    (b - a).cross(&(c - a)).norm() > 1e-12
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume that a surface encloses, cubic metres: below 0 if it is inside out.
    fn volume_m3((corners, faces): &Skin) -> f64 {
        let corner = |at: u32| corners[at as usize].coords;
        let six = |&[a, b, c]: &[u32; 3]| corner(a).dot(&corner(b).cross(&corner(c)));
        faces.iter().map(six).sum::<f64>() / 6.0
    }

    #[test]
    fn skins_look_outwards_and_enclose_nearly_what_their_shapes_do() {
        let pi = std::f64::consts::PI;
        let ends = [Point3::new(0.3, 0.1, -2.0), Point3::new(0.3, 0.5, -2.3)];
        let capsule_m3 = pi * 0.2 * 0.2 * 0.5 + 4.0 / 3.0 * pi * 0.2 * 0.2 * 0.2;
        let ball_m3 = 4.0 / 3.0 * pi * 0.2 * 0.2 * 0.2;
        for (skin, exact) in [
            (capsule(&ends[0], &ends[1], 0.2), capsule_m3),
            (capsule(&ends[1], &ends[0], 0.2), capsule_m3),
            (capsule(&ends[0], &ends[0], 0.2), ball_m3),
            (cylinder(0.5, 1.0), pi * 0.25 * 2.0),
        ] {
            let share = volume_m3(&skin) / exact;
            assert!((0.97..1.0).contains(&share), "{share}");
        }
    }
}
