//! A camera at the moment of its exposure.

use nalgebra::Point3;
use occlabel_core::{Camera, Pose};

use crate::OcclusionSettings;

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

    /// Whether a point of the grid frame is in view: near enough, before the lens, on the image, and
    /// not behind the camera's own body.
    ///
    /// The way to the point is taken before it is turned, so that distances stay exact.
    pub(crate) fn has_in_view(&self, p: &Point3<f64>, settings: &OcclusionSettings) -> bool {
        let way = p - self.position();
        let in_camera = || Point3::from(self.grid_from_camera.rotation.inverse() * way);
        way.norm() <= settings.depth_max_m && self.camera.pixel_of(&in_camera()).is_some()
    }

    /// The far ends of rays through every `stride`-th pixel of each row and column, grid frame.
    /// Pixels that show the camera's own body, or nothing by its model, have none.
    pub(crate) fn pixel_ends(
        &self,
        stride: usize,
        depth_m: f64,
    ) -> impl Iterator<Item = Point3<f64>> {
        let rows = (0..self.camera.height).step_by(stride);
        rows.flat_map(move |row| {
            (0..self.camera.width).step_by(stride).filter_map(move |column| {
                let direction = self.camera.ray_of(column, row)?;
                Some(self.grid_from_camera * Point3::from(direction.into_inner() * depth_m))
            })
        })
    }
}
