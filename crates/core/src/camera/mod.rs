//! Cameras: which pixel sees a point, and which direction a pixel looks.
//!
//! Every model maps between a point in the camera frame and a continuous pixel position:
//!
//! ```text
//!        z forward              0   1   2     u
//!       /                     0 +---+---+-- ->
//!      +---- x right            |0,0|1,0|        pixel (i, j) covers [i, i+1) x [j, j+1),
//!      |                      1 +---+---+--      its centre is (i + 0.5, j + 0.5)
//!      y down                   |0,1|1,1|
//!    camera frame, metres     v v                image, pixels
//! ```
//!
//! A model knows its own valid range (the angle up to which its image radius grows) and answers
//! `None` beyond it, so that a distortion polynomial that folds back never shows a point in the
//! wrong pixel. The models are an enum and not a trait: the set is closed, and a `match` costs
//! nothing per point.

mod body_mask;
mod brown_conrady;
#[cfg(test)]
mod checks;
mod distortion;
mod error;
mod intrinsics;
mod kannala_brandt;
mod mei;
mod model;
mod ocam;
mod pinhole;
mod polar;
mod rolling_shutter;
mod roots;

pub use body_mask::BodyMask;
pub use brown_conrady::BrownConrady;
pub use error::CameraError;
pub use intrinsics::Intrinsics;
pub use kannala_brandt::KannalaBrandt;
pub use mei::Mei;
pub use model::CameraModel;
pub use ocam::Ocam;
pub use pinhole::Pinhole;
pub use rolling_shutter::{RollingShutter, ShutterDirection};

use nalgebra::{Point2, Point3, Unit, Vector3};

/// A calibrated camera: its model, its image's size, and what of the image is the vehicle itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Between camera frame and pixels.
    pub model: CameraModel,
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// Pixels that show the vehicle's own body, if any do.
    pub body_mask: Option<BodyMask>,
    /// How the rows are read out, if it is known that they are not read at once.
    pub rolling_shutter: Option<RollingShutter>,
}

impl Camera {
    /// The pixel (column, row) that sees a point of the camera frame, if it is in view.
    ///
    /// In view: inside the model's range, in the image, and not behind the body mask. Depth is the
    /// caller's.
    pub fn pixel_of(&self, point: &Point3<f64>) -> Option<(u32, u32)> {
        let pixel = self.model.project(point)?;
        let (column, row) = (cell(pixel.x, self.width)?, cell(pixel.y, self.height)?);
        (!self.is_body(column, row)).then_some((column, row))
    }

    /// Whether a pixel shows the vehicle's own body; no pixel does if there is no mask.
    pub fn is_body(&self, column: u32, row: u32) -> bool {
        self.body_mask.as_ref().is_some_and(|mask| mask.covers(column, row))
    }

    /// Unit direction in the camera frame through a pixel's centre.
    ///
    /// `None` outside the image, outside the model's range, and where the body mask covers the
    /// pixel.
    pub fn ray_of(&self, column: u32, row: u32) -> Option<Unit<Vector3<f64>>> {
        let seen = column < self.width && row < self.height && !self.is_body(column, row);
        let centre = Point2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
        seen.then(|| self.model.unproject(&centre)).flatten()
    }
}

/// Index of the pixel that holds a coordinate, in an image of `count` pixels along that axis.
fn cell(coordinate: f64, count: u32) -> Option<u32> {
    (coordinate >= 0.0 && coordinate < f64::from(count)).then_some(coordinate as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Focal length 2 px, centre (2, 1), image 4 x 2, the lower right pixel is body.
    fn tiny() -> Camera {
        let k = [[2.0, 0.0, 2.0], [0.0, 2.0, 1.0], [0.0, 0.0, 1.0]];
        let mut covered = vec![false; 8];
        covered[7] = true;
        Camera {
            model: CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k).unwrap())),
            width: 4,
            height: 2,
            body_mask: Some(BodyMask::new(4, 2, covered).unwrap()),
            rolling_shutter: None,
        }
    }

    #[test]
    fn image_is_half_open() {
        let pixel_at = |x: f64, y: f64| tiny().pixel_of(&Point3::new(x, y, 1.0));
        assert_eq!(pixel_at(-1.0, -0.5), Some((0, 0)), "upper left corner");
        assert_eq!(pixel_at(-1.0, 0.0), Some((0, 1)), "an edge belongs to the next pixel");
        assert_eq!(pixel_at(0.999, -0.5), Some((3, 0)));
        assert_eq!(pixel_at(1.0, -0.5), None, "right border");
        assert_eq!(pixel_at(0.0, 0.5), None, "lower border");
        assert_eq!(pixel_at(-1.0 - 1e-12, 0.0), None, "left border");
    }

    #[test]
    fn body_hides_points_and_rays() {
        let camera = tiny();
        assert_eq!(camera.pixel_of(&Point3::new(0.75, 0.25, 1.0)), None);
        assert_eq!(camera.ray_of(3, 1), None);
        assert!(camera.is_body(3, 1) && !camera.is_body(2, 1));
        let bare = Camera { body_mask: None, ..tiny() };
        assert_eq!(bare.pixel_of(&Point3::new(0.75, 0.25, 1.0)), Some((3, 1)));
    }

    #[test]
    fn ray_hits_its_own_pixel() {
        let camera = tiny();
        let mut rays = 0;
        for (column, row) in (0..2).flat_map(|row| (0..4).map(move |column| (column, row))) {
            let Some(ray) = camera.ray_of(column, row) else { continue };
            assert_eq!(camera.pixel_of(&Point3::from(*ray * 7.0)), Some((column, row)));
            rays += 1;
        }
        assert_eq!(rays, 7, "all but the body's pixel");
    }

    #[test]
    fn no_ray_outside_the_image() {
        assert_eq!(tiny().ray_of(4, 0), None);
        assert_eq!(tiny().ray_of(0, u32::MAX), None);
    }
}
