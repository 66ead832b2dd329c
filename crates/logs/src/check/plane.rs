//! The plane that most points lie on.

use nalgebra::{Point3, Unit, Vector3};

/// Points this near to a plane lie on it, metres.
pub(super) const ON_PLANE_M: f64 = 0.15;
/// Planes are tried through so many threes of points. If a fifth of the points is ground, four of
/// these are: enough to find it.
const TRIES: usize = 500;
/// Three points span a plane well if their parallelogram has this area, square metres.
const SMALLEST_SPAN_M2: f64 = 1.0;

/// A plane: the points p with `normal · p = offset_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// Towards the sensor.
    pub(super) normal: Unit<Vector3<f64>>,
    /// Of the plane from the origin, along the normal.
    pub(super) offset_m: f64,
}

impl Plane {
    /// The plane z = 0.
    #[cfg(test)]
    pub(super) const LEVEL: Self =
        Self { normal: Unit::new_unchecked(Vector3::new(0.0, 0.0, 1.0)), offset_m: 0.0 };

    /// The plane through three points, seen from a fourth; none if they span too little.
    fn through([a, b, c]: [&Point3<f64>; 3], eye: &Point3<f64>) -> Option<Self> {
        let across = (b - a).cross(&(c - a));
        let normal = Unit::try_new(across, SMALLEST_SPAN_M2)?;
        let plane = Self { normal, offset_m: normal.dot(&a.coords) };
        let turned = || Self { normal: -normal, offset_m: -plane.offset_m };
        Some(if plane.height_m(eye) < 0.0 { turned() } else { plane })
    }

    /// How far a point lies above it, metres.
    pub(super) fn height_m(&self, p: &Point3<f64>) -> f64 {
        self.normal.dot(&p.coords) - self.offset_m
    }
}

/// Planes through points, each with how many points lie on it. The same points give the same planes.
///
/// Source: Fischler & Bolles, "Random sample consensus", 1981, with fixed threes in place of random
/// ones.
pub(super) fn planes(
    points: &[Point3<f64>],
    eye: Point3<f64>,
) -> impl Iterator<Item = (Plane, usize)> {
    let count = points.len().max(1) as u64;
    let threes = (0..TRIES as u64 * u64::from(points.len() >= 3)).map(move |attempt| {
        [0, 1, 2].map(|corner| &points[(scattered(3 * attempt + corner) % count) as usize])
    });
    threes.filter_map(move |three| {
        let plane = Plane::through(three, &eye)?;
        let is_on = |p: &&Point3<f64>| plane.height_m(p).abs() <= ON_PLANE_M;
        Some((plane, points.iter().filter(is_on).count()))
    })
}

/// A number that looks random, of another one.
/// Source: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", 2014.
pub(super) fn scattered(number: u64) -> u64 {
    let mixed = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ mixed >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plane_of_most_points_is_found_and_looks_at_the_eye() {
        let ground = (0..900).map(|i| {
            let (x, y) = (f64::from(i % 30), f64::from(i / 30));
            Point3::new(x, y, 0.1 * x)
        });
        let wall = (0..300).map(|i| Point3::new(f64::from(i % 30), 31.0, f64::from(i / 30)));
        let points: Vec<_> = ground.chain(wall).collect();
        let best = planes(&points, Point3::new(15.0, 15.0, 9.0)).max_by_key(|(_, count)| *count);
        let (plane, count) = best.expect("a plane");
        assert!((900..960).contains(&count), "{count}");
        let slope = Vector3::new(-0.1, 0.0, 1.0).normalize();
        assert!(plane.normal.dot(&slope) > 0.9999, "{}", plane.normal.as_ref());
        assert!((plane.height_m(&Point3::new(0.0, 0.0, 2.0)) - 2.0 * slope.z).abs() < 0.2);
    }

    #[test]
    fn too_few_points_and_points_on_a_line_span_nothing() {
        let line: Vec<_> = (0..50).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
        for points in [&line[..], &line[..2], &[]] {
            assert_eq!(planes(points, Point3::origin()).count(), 0);
        }
    }
}
