//! Between nalgebra, which the project speaks, and glam, which parry speaks: plain numbers.

use nalgebra::{Point3, Vector3};
use parry3d_f64::math::Vector;

use crate::Ray;

/// A point as parry takes it.
pub(crate) fn to_parry(p: &Point3<f64>) -> Vector {
    Vector::new(p.x, p.y, p.z)
}

/// A direction as parry gives it.
pub(crate) fn from_parry(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// A ray as parry takes it.
pub(crate) fn ray_to_parry(ray: &Ray) -> parry3d_f64::query::Ray {
    parry3d_f64::query::Ray::new(to_parry(&ray.origin), to_parry(&ray.direction.into()))
}
