//! A ray cut down to the part that lies in a convex solid (Kay & Kajiya 1986).
//!
//! A convex solid is cut out of space by half-spaces and a disc; a ray is in each of them for one
//! interval of its length, and in the solid where all the intervals overlap.

use nalgebra::Vector3;

use crate::{Impact, Ray};

/// The part of a ray that is left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clip {
    near_m: f64,
    near_normal: Vector3<f64>,
    far_m: f64,
}

impl Clip {
    /// The whole line of a ray.
    pub(crate) fn whole() -> Self {
        Self { near_m: f64::NEG_INFINITY, near_normal: Vector3::zeros(), far_m: f64::INFINITY }
    }

    /// What is left within `normal * p <= reach_m`.
    pub(crate) fn half_space(self, ray: &Ray, normal: &Vector3<f64>, reach_m: f64) -> Self {
        let speed = normal.dot(&ray.direction);
        let gap_m = reach_m - normal.dot(&ray.origin.coords);
        if speed < 0.0 {
            self.enter(gap_m / speed, *normal)
        } else if speed > 0.0 {
            self.leave(gap_m / speed)
        } else {
            self.kept_if(gap_m >= 0.0)
        }
    }

    /// What is left within a radius of the z axis.
    pub(crate) fn disc(self, ray: &Ray, radius_m: f64) -> Self {
        let (o, d) = (ray.origin.coords.xy(), ray.direction.xy());
        let across = d.norm_squared();
        if across == 0.0 {
            return self.kept_if(o.norm_squared() <= radius_m * radius_m);
        }
        // Measured at the closest approach, so that a far origin does not drown the radius.
        let closest_m = -o.dot(&d) / across;
        let room = radius_m * radius_m - (o + d * closest_m).norm_squared();
        let half_m = (room.max(0.0) / across).sqrt();
        let met = (o + d * (closest_m - half_m)) / radius_m;
        self.kept_if(room >= 0.0)
            .enter(closest_m - half_m, Vector3::new(met.x, met.y, 0.0))
            .leave(closest_m + half_m)
    }

    /// Where the ray first is in the solid.
    pub(crate) fn impact(self, ray: &Ray) -> Option<Impact> {
        if self.near_m > self.far_m || self.far_m < 0.0 {
            return None;
        }
        let outside = Impact { distance_m: self.near_m, normal: self.near_normal };
        Some(if self.near_m > 0.0 { outside } else { Impact::inside(ray) })
    }

    fn enter(self, at_m: f64, normal: Vector3<f64>) -> Self {
        if at_m > self.near_m { Self { near_m: at_m, near_normal: normal, ..self } } else { self }
    }

    fn leave(self, at_m: f64) -> Self {
        Self { far_m: self.far_m.min(at_m), ..self }
    }

    fn kept_if(self, kept: bool) -> Self {
        if kept { self } else { Self { far_m: f64::NEG_INFINITY, ..self } }
    }
}
