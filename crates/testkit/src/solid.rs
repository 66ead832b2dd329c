//! Solid bodies and where a ray meets them, in closed form.
//!
//! Each body is convex and cut out of space by slabs and discs, and a ray is inside each of these
//! for one interval of its length; it is inside the body where all the intervals overlap
//! (Kay & Kajiya 1986).

use crate::pose::Pose;
use nalgebra::{Point3, Vector3};

/// A half-line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Where it starts.
    pub(crate) origin: Point3<f64>,
    /// Where it goes: a unit vector.
    pub(crate) direction: Vector3<f64>,
}

/// A body's form, centred on its own origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    /// A box, by half its length, width and height.
    Box {
        /// Half of the extent along x, y, z.
        half_m: [f64; 3],
    },
    /// An upright cylinder.
    Cylinder {
        /// Radius.
        radius_m: f64,
        /// Half of its height.
        half_height_m: f64,
    },
}

/// A shape that stands somewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid {
    shape: Shape,
    solid_from_world: Pose,
}

impl Solid {
    /// A shape at a pose.
    pub(crate) fn new(shape: Shape, world_from_solid: &Pose) -> Self {
        Self { shape, solid_from_world: world_from_solid.inverse() }
    }

    /// The distance at which a ray of the world enters the body; a ray that starts inside has none.
    pub(crate) fn entry_m(&self, ray: &Ray) -> Option<f64> {
        let origin = self.solid_from_world * ray.origin;
        let direction = self.solid_from_world * ray.direction;
        let inside = match self.shape {
            Shape::Box { half_m } => box_interval(&origin, &direction, half_m),
            Shape::Cylinder { radius_m, half_height_m } => disc_interval(
                &origin, &direction, radius_m,
            )?
            .overlap(slab_interval(origin.z, direction.z, half_height_m)),
        };
        inside.entry_m()
    }
}

/// The part of a ray that lies inside something.
#[derive(Clone, Copy)]
struct Interval {
    near_m: f64,
    far_m: f64,
}

impl Interval {
    fn overlap(self, other: Self) -> Self {
        Self { near_m: self.near_m.max(other.near_m), far_m: self.far_m.min(other.far_m) }
    }

    fn entry_m(self) -> Option<f64> {
        (self.near_m > 0.0 && self.near_m <= self.far_m).then_some(self.near_m)
    }
}

fn box_interval(origin: &Point3<f64>, direction: &Vector3<f64>, half_m: [f64; 3]) -> Interval {
    (1..3).fold(slab_interval(origin[0], direction[0], half_m[0]), |inside, axis| {
        inside.overlap(slab_interval(origin[axis], direction[axis], half_m[axis]))
    })
}

/// Where |origin + t * direction| <= half. A ray along the slab divides by zero: to infinities that
/// mean "always" or "never", as they should, or on the very face to NaNs that `max` passes over.
fn slab_interval(origin: f64, direction: f64, half: f64) -> Interval {
    let a = (-half - origin) / direction;
    let b = (half - origin) / direction;
    Interval { near_m: a.min(b), far_m: a.max(b) }
}

/// Where the ray is within `radius` of the z axis; none if it never is.
fn disc_interval(origin: &Point3<f64>, direction: &Vector3<f64>, radius: f64) -> Option<Interval> {
    let (o, d) = (origin.coords.xy(), direction.xy());
    let (a, b, c) = (d.dot(&d), o.dot(&d), o.dot(&o) - radius * radius);
    if a == 0.0 {
        let always = Interval { near_m: f64::NEG_INFINITY, far_m: f64::INFINITY };
        return (c <= 0.0).then_some(always);
    }
    let root = (b * b - a * c).max(0.0).sqrt();
    let touches = b * b >= a * c;
    touches.then(|| Interval { near_m: (-b - root) / a, far_m: (-b + root) / a })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::yaw_pose;
    use std::f64::consts::{FRAC_PI_4, SQRT_2};

    const CUBE: Shape = Shape::Box { half_m: [1.0, 1.0, 1.0] };
    const PILLAR: Shape = Shape::Cylinder { radius_m: 0.5, half_height_m: 2.0 };

    fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray { origin: origin.into(), direction: Vector3::from(direction).normalize() }
    }

    #[track_caller]
    fn assert_entry(shape: Shape, yaw_rad: f64, ray: Ray, expected_m: Option<f64>) {
        let found_m = Solid::new(shape, &yaw_pose([10.0, 0.0, 0.0], yaw_rad)).entry_m(&ray);
        let same = match (found_m, expected_m) {
            (Some(found), Some(expected)) => (found - expected).abs() < 1e-12,
            (found, expected) => found == expected,
        };
        assert!(same, "expected {expected_m:?}, found {found_m:?}");
    }

    #[test]
    fn a_box_is_met_at_its_face() {
        assert_entry(CUBE, 0.0, ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(9.0));
        assert_entry(CUBE, 0.0, ray([10.5, 0.0, 7.0], [0.0, 0.0, -1.0]), Some(6.0));
        assert_entry(CUBE, 0.0, ray([0.0, 0.0, 0.0], [9.0, 0.0, 0.9]), Some(libm::hypot(9.0, 0.9)));
    }

    #[test]
    fn a_turned_box_is_met_at_its_edge() {
        let along_x = ray([0.0, 0.0, 0.5], [1.0, 0.0, 0.0]);
        assert_entry(CUBE, FRAC_PI_4, along_x, Some(10.0 - SQRT_2));
        let aside = ray([0.0, 1.0, 0.5], [1.0, 0.0, 0.0]);
        assert_entry(CUBE, FRAC_PI_4, aside, Some(11.0 - SQRT_2));
    }

    #[test]
    fn a_pillar_is_met_at_its_mantle_or_its_top() {
        assert_entry(PILLAR, 0.0, ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some(9.5));
        assert_entry(PILLAR, 0.0, ray([0.0, 0.3, 1.0], [1.0, 0.0, 0.0]), Some(9.6));
        assert_entry(PILLAR, 0.0, ray([10.2, 0.2, 5.0], [0.0, 0.0, -1.0]), Some(3.0));
    }

    #[test]
    fn what_is_behind_beside_or_around_the_origin_is_not_met() {
        for shape in [CUBE, PILLAR] {
            assert_entry(shape, 0.0, ray([0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), None);
            assert_entry(shape, 0.0, ray([0.0, 1.5, 0.0], [1.0, 0.0, 0.0]), None);
            assert_entry(shape, 0.0, ray([0.0, 0.0, 2.5], [1.0, 0.0, 0.0]), None);
            assert_entry(shape, 0.0, ray([12.0, 0.0, 9.0], [0.0, 0.0, -1.0]), None);
            assert_entry(shape, 0.0, ray([10.0, 0.0, 0.0], [1.0, 0.0, 0.0]), None);
        }
    }
}
