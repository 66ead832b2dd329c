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

    /// Tells whether a point of the grid frame is in view: near enough, before the lens, on the
    /// image, and not behind the camera's own body.
    ///
    /// The way to the point is taken before it is turned, so that distances stay exact.
    pub(crate) fn view(&self, depth_max_m: f64) -> impl Fn(&Point3<f64>) -> bool {
        let position = self.position();
        let camera_from_grid = self.grid_from_camera.rotation.inverse().to_rotation_matrix();
        move |p| {
            let way = p - position;
            let in_camera = || Point3::from(camera_from_grid * way);
            way.norm() <= depth_max_m && self.camera.pixel_of(&in_camera()).is_some()
        }
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
