//! The pinhole camera.

use nalgebra::{Point2, Point3, Vector3};

use super::Intrinsics;

/// A pinhole without distortion: `x = X / Z`, `y = Y / Z`; in view is what lies in front (Z > 0).
///
/// Source: OpenCV, calib3d, "Detailed Description" (pinhole camera model).
#[derive(Clone, Debug, PartialEq)]
pub struct Pinhole {
    intrinsics: Intrinsics,
}

impl Pinhole {
    /// A pinhole; intrinsics were checked when they were made, so this cannot fail.
    pub fn new(intrinsics: Intrinsics) -> Self {
        Self { intrinsics }
    }

    /// The pinhole part.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    pub(super) fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let plane = Point2::new(point.x / point.z, point.y / point.z);
        (point.z > 0.0).then(|| self.intrinsics.pixel(&plane))
    }

    pub(super) fn unproject(&self, pixel: &Point2<f64>) -> Vector3<f64> {
        let plane = self.intrinsics.plane(pixel);
        Vector3::new(plane.x, plane.y, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::checks::*;
    use super::*;
    use crate::camera::CameraModel;

    /// CAM_FRONT of nuScenes, 1600 x 900.
    const K: [[f64; 3]; 3] = [
        [1266.417203046554, 0.0, 816.2670197447984],
        [0.0, 1266.417203046554, 491.50706579294757],
        [0.0, 0.0, 1.0],
    ];

    fn model(k: &[[f64; 3]; 3]) -> CameraModel {
        CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(k).unwrap()))
    }

    #[test]
    fn known_values() {
        let skewed = model(&[[100.0, 4.0, 50.0], [0.0, 200.0, 60.0], [0.0, 0.0, 1.0]]);
        let pixel = skewed.project(&Point3::new(1.0, -1.0, 2.0)).unwrap();
        assert_eq!(pixel, Point2::new(50.0 - 2.0 + 50.0, -100.0 + 60.0), "by hand");
        assert_eq!(skewed.project(&Point3::new(0.0, 0.0, 1e-9)), Some(Point2::new(50.0, 60.0)));
    }

    #[test]
    fn only_the_front_is_in_view() {
        for z in [0.0, -0.0, -1e-9, -5.0] {
            assert_eq!(model(&K).project(&Point3::new(0.3, 0.2, z)), None, "z = {z}");
        }
    }

    #[test]
    fn round_trips() {
        assert_eq!(round_trip_pixels(&model(&K), 1600, 900, 7), 229 * 129);
        assert!(round_trip_directions(&model(&K), 20_000) > 8_000);
    }

    #[test]
    fn agrees_with_the_homogeneous_product() {
        let k = nalgebra::Matrix3::from_fn(|row, column| K[row][column]);
        let oracle = |point: &Point3<f64>| {
            let image = k * point.coords;
            (point.z > 0.0).then(|| Point2::new(image.x / image.z, image.y / image.z))
        };
        assert!(agrees_with(&model(&K), oracle, 20_000) > 8_000);
    }

    #[test]
    fn strange_input_is_out_of_view() {
        refuses_strange_input(&model(&K));
    }
}
