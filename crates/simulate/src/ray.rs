//! Half-lines, and where they meet a surface.

use nalgebra::{Point3, Vector3};
use occlabel_core::Pose;

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: Point3<f64>,
    /// Where it goes: a unit vector.
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point at a distance along the ray.
    pub fn at(&self, distance_m: f64) -> Point3<f64> {
        self.origin + self.direction * distance_m
    }

    /// The same ray in another frame.
    pub(crate) fn moved(&self, dst_from_src: &Pose) -> Self {
        Self { origin: dst_from_src * self.origin, direction: dst_from_src * self.direction }
    }
}

/// Where a ray first is in a solid, in the frame of the ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Distance from the ray's origin, metres; 0 if the ray starts in the solid.
    pub distance_m: f64,
    /// Unit normal of the surface, outwards; against the ray if it starts in the solid.
    pub normal: Vector3<f64>,
}

impl Impact {
    /// Of a ray that starts in the solid.
    pub(crate) fn inside(ray: &Ray) -> Self {
        Self { distance_m: 0.0, normal: -ray.direction }
    }
}
