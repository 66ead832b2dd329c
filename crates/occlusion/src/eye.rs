//! A camera at the moment of its exposure.

use nalgebra::Point3;
use occlabel_core::{Camera, Pose};

/// A camera where it stood when it was exposed.
#[derive(Clone, Debug)]
pub struct Eye<'a> {
    /// Its bit in `camera_bits`.
    pub bit: usize,
    /// Its model, size and mask.
    pub camera: &'a Camera,
    /// Where it stood, in the frame of the grid.
    pub grid_from_camera: Pose,
}

impl Eye<'_> {
    /// Where it stood, grid frame.
    pub(crate) fn position(&self) -> Point3<f64> {
        self.grid_from_camera.translation.vector.into()
    }

    /// The far end of the ray through a pixel, grid frame.
    #[inline]
    pub(crate) fn pixel_end(&self, column: u32, row: u32, depth_m: f64) -> Option<Point3<f64>> {
        let direction = self.camera.ray_of(column, row)?;
        Some(self.grid_from_camera * Point3::from(direction.into_inner() * depth_m))
    }
}
