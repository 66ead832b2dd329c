//! Where the points of a picture look.

use nalgebra::{Point2, Point3, Vector3};
use occlabel_core::{Camera, Pose};

use crate::picture::canvas::At;
use crate::picture::lens::Lens;

/// An eye in the grid frame, and a direction for each point of its picture.
pub(crate) trait Gaze: Sync {
    /// Where all lines of sight begin, metres.
    fn eye(&self) -> Point3<f64>;
    /// The direction, of length 1, in which a point of the picture looks, if it looks anywhere.
    fn direction(&self, at: At) -> Option<Vector3<f64>>;
    /// Pixels by which a metre at one metre's distance is drawn, about.
    fn focal_px(&self) -> f64;
}

impl Gaze for Lens {
    fn eye(&self) -> Point3<f64> {
        self.eye
    }

    fn direction(&self, at: At) -> Option<Vector3<f64>> {
        Some(Lens::direction(self, at))
    }

    fn focal_px(&self) -> f64 {
        self.focal_px
    }
}

/// A calibrated camera, its image drawn at another size.
pub(crate) struct CameraGaze<'a> {
    camera: &'a Camera,
    grid_from_camera: &'a Pose,
    /// Pixels of the image for one of the picture.
    image_px: Vector2,
    focal_px: f64,
}

type Vector2 = nalgebra::Vector2<f64>;

impl<'a> CameraGaze<'a> {
    /// A camera whose picture is drawn at a size.
    pub(crate) fn new(
        camera: &'a Camera,
        grid_from_camera: &'a Pose,
        (width, height): (u32, u32),
    ) -> Self {
        let share = |image: u32, picture: u32| f64::from(image) / f64::from(picture.max(1));
        let image_px = Vector2::new(share(camera.width, width), share(camera.height, height));
        let mut gaze = Self { camera, grid_from_camera, image_px, focal_px: 0.0 };
        let middle = At::new(f64::from(width), f64::from(height)) / 2.0;
        gaze.focal_px = gaze.focal_at(middle).unwrap_or(f64::from(height));
        gaze
    }

    /// Pixels a radian at a point of the picture.
    fn focal_at(&self, at: At) -> Option<f64> {
        let [one, other] = [0.0, 1.0].map(|step| self.direction(at + Vector2::new(step, 0.0)));
        Some(1.0 / one?.angle(&other?)).filter(|focal| focal.is_finite())
    }
}

impl Gaze for CameraGaze<'_> {
    fn eye(&self) -> Point3<f64> {
        self.grid_from_camera.translation.vector.into()
    }

    /// None beyond the model's range, and where the vehicle itself is in the way.
    fn direction(&self, at: At) -> Option<Vector3<f64>> {
        let pixel = Point2::from(at.coords.component_mul(&self.image_px));
        if self.camera.is_body(pixel.x as u32, pixel.y as u32) {
            return None;
        }
        let way = self.camera.model.unproject(&pixel)?;
        Some(self.grid_from_camera.rotation * way.into_inner())
    }

    fn focal_px(&self) -> f64 {
        self.focal_px
    }
}
