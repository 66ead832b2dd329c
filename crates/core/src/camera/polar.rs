//! Plane points as radius and unit direction.

use nalgebra::{Point2, Vector2};

/// Radius of a plane point and the unit vector towards it; radius 0 has the zero vector.
///
/// Models that bend light by its angle alone scale the unit vector by an image radius,
/// so a point on the optical axis needs no case of its own.
pub(super) fn polar(x: f64, y: f64) -> (f64, Vector2<f64>) {
    let radius = libm::hypot(x, y);
    if radius == 0.0 {
        return (0.0, Vector2::zeros());
    }
    (radius, Vector2::new(x / radius, y / radius))
}

/// The plane point at a radius in a unit direction.
pub(super) fn at(radius: f64, direction: &Vector2<f64>) -> Point2<f64> {
    Point2::from(direction * radius)
}
