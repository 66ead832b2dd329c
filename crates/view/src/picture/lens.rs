//! The pinhole through which a perspective picture is taken.

use nalgebra::{Point3, Vector3};

use crate::picture::canvas::At;

/// Tangent of half the view's height: about 35 degrees in all.
pub(crate) const TAN_HALF_VIEW: f64 = 0.32;

/// A pinhole in the grid frame.
pub(crate) struct Lens {
    pub(crate) eye: Point3<f64>,
    right: Vector3<f64>,
    up: Vector3<f64>,
    forward: Vector3<f64>,
    middle: At,
    /// Pixels by which a metre at one metre's depth is drawn.
    pub(crate) focal_px: f64,
}

impl Lens {
    /// A lens at a place, with its right, up and forward, of a picture's size.
    pub(crate) fn new(
        eye: Point3<f64>,
        [right, up, forward]: [Vector3<f64>; 3],
        width: u32,
        height: u32,
    ) -> Self {
        let middle = At::new(f64::from(width), f64::from(height)) / 2.0;
        Self { eye, right, up, forward, middle, focal_px: middle.y / TAN_HALF_VIEW }
    }

    /// The direction, of length 1, in which a point of the picture lies.
    pub(crate) fn direction(&self, at: At) -> Vector3<f64> {
        let off = (at - self.middle) / self.focal_px;
        (self.forward + self.right * off.x - self.up * off.y).normalize()
    }

    /// Where a point of the grid frame is drawn, if it lies ahead.
    pub(crate) fn project(&self, p: &Point3<f64>) -> Option<At> {
        let p = p - self.eye;
        let depth = p.dot(&self.forward);
        let off = nalgebra::Vector2::new(p.dot(&self.right), -p.dot(&self.up));
        (depth > 0.0).then(|| self.middle + off * (self.focal_px / depth))
    }
}
