//! A pinhole behind a distorting lens.

use nalgebra::{Point2, Point3, Vector3};

use super::distortion::Distortion;
use super::error::check_finite;
use super::{CameraError, Intrinsics};

/// A pinhole with radial and tangential distortion, in OpenCV's form (formulas at `Distortion`).
///
/// In view is what lies in front (Z > 0), up to the radius where the image would fold back.
///
/// Source: OpenCV, calib3d, "Detailed Description"; Brown 1966, Decentering Distortion of Lenses.
#[derive(Clone, Debug, PartialEq)]
pub struct BrownConrady {
    intrinsics: Intrinsics,
    distortion: Distortion,
}

impl BrownConrady {
    /// From coefficients in OpenCV's order `k1 k2 p1 p2 [k3 [k4 k5 k6]]`.
    ///
    /// # Errors
    /// If there are not 4, 5 or 8 coefficients, or one is not finite.
    pub fn new(intrinsics: Intrinsics, coefficients: &[f64]) -> Result<Self, CameraError> {
        const NAME: &str = "Brown-Conrady distortion";
        check_finite(NAME, coefficients)?;
        let (radial, tangential) = match *coefficients {
            [k1, k2, p1, p2] => ([k1, k2, 0.0, 0.0, 0.0, 0.0], [p1, p2]),
            [k1, k2, p1, p2, k3] => ([k1, k2, k3, 0.0, 0.0, 0.0], [p1, p2]),
            [k1, k2, p1, p2, k3, k4, k5, k6] => ([k1, k2, k3, k4, k5, k6], [p1, p2]),
            _ => {
                let (expected, found) = ("4, 5 or 8", coefficients.len());
                return Err(CameraError::Count { name: NAME, expected, found });
            }
        };
        Ok(Self { intrinsics, distortion: Distortion::new(radial, tangential) })
    }

    /// The pinhole part.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// The coefficients as [`Self::new`] takes them: 5, or 8 if k4, k5 or k6 is not 0.
    pub fn coefficients(&self) -> Vec<f64> {
        let ([k1, k2, k3, k4, k5, k6], [p1, p2]) = self.distortion.coefficients();
        match [k4, k5, k6] == [0.0; 3] {
            true => vec![k1, k2, p1, p2, k3],
            false => vec![k1, k2, p1, p2, k3, k4, k5, k6],
        }
    }

    pub(super) fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        if point.z <= 0.0 {
            return None;
        }
        let plane = Point2::new(point.x / point.z, point.y / point.z);
        self.distortion.distort(&plane).map(|image| self.intrinsics.pixel(&image))
    }

    pub(super) fn unproject(&self, pixel: &Point2<f64>) -> Option<Vector3<f64>> {
        let plane = self.distortion.undistort(&self.intrinsics.plane(pixel))?;
        Some(Vector3::new(plane.x, plane.y, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::checks::*;
    use super::*;
    use crate::camera::CameraModel;

    /// Camera 0 of the raw drives of KITTI, 1392 x 512.
    fn kitti() -> CameraModel {
        model(
            [[984.2439, 0.0, 690.0], [0.0, 980.8141, 233.1966], [0.0, 0.0, 1.0]],
            &[-0.3728755, 0.2037299, 0.002219027, 0.001383707, -0.07233722],
        )
    }

    /// A rational lens as of an Azure Kinect's colour camera, 1280 x 720.
    fn rational() -> CameraModel {
        model(
            [[611.2, 0.0, 638.4], [0.0, 611.1, 366.2], [0.0, 0.0, 1.0]],
            &[0.4626, -2.6153, 0.0007, -0.00032, 1.5189, 0.3415, -2.4359, 1.4446],
        )
    }

    fn model(k: [[f64; 3]; 3], coefficients: &[f64]) -> CameraModel {
        let intrinsics = Intrinsics::from_matrix(&k).unwrap();
        CameraModel::BrownConrady(BrownConrady::new(intrinsics, coefficients).unwrap())
    }

    /// OpenCV's formula spelled out; in view if r g(r) grew at each of many steps from the axis to
    /// the point.
    fn oracle(point: &Point3<f64>, [fx, fy, cx, cy]: [f64; 4], d: [f64; 8]) -> Option<Point2<f64>> {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = d;
        let (x, y) = (point.x / point.z, point.y / point.z);
        let factor = |r: f64| {
            let (r2, r4, r6) = (libm::pow(r, 2.0), libm::pow(r, 4.0), libm::pow(r, 6.0));
            (1.0 + k1 * r2 + k2 * r4 + k3 * r6) / (1.0 + k4 * r2 + k5 * r4 + k6 * r6)
        };
        let radius = (x * x + y * y).sqrt();
        let image =
            |i: u32| (radius * f64::from(i) / 2000.0) * factor(radius * f64::from(i) / 2000.0);
        if point.z <= 0.0 || (1..=2000).any(|i| image(i) <= image(i - 1)) {
            return None;
        }
        let (g, r2) = (factor(radius), radius * radius);
        let u = x * g + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
        let v = y * g + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
        Some(Point2::new(fx * u + cx, fy * v + cy))
    }

    #[test]
    fn agrees_with_opencv() {
        // cv2.projectPoints of OpenCV 5.0.0, no rotation, no translation, printed to 10 digits.
        holds_frozen(
            &kitti(),
            &[
                ([0.0, 0.0, 2.0], [690.0, 233.1966]),
                ([1.0, 0.5, 4.0], [929.6036204066, 352.6979575441]),
                ([-2.0, 1.0, 5.0], [323.0407287060, 416.6078697036]),
                ([0.3, -0.9, 3.0], [784.9801705948, -50.1261849562]),
                ([1.5, 0.4, 2.5], [1213.0018326188, 372.8774415149]),
                ([-1.0, -1.0, 3.0], [387.1542557610, -68.4117507969]),
            ],
        );
        holds_frozen(
            &rational(),
            &[
                ([0.0, 0.0, 2.0], [638.4, 366.2]),
                ([1.0, 0.5, 4.0], [792.4548955008, 443.2559033733]),
                ([-2.0, 1.0, 5.0], [389.3604437802, 490.7654039095]),
                ([0.3, -0.9, 3.0], [700.0988587083, 181.1178194007]),
                ([1.5, 0.4, 2.5], [1015.4333192012, 466.9108245557]),
                ([-1.0, -1.0, 3.0], [430.7179692482, 158.6904646381]),
            ],
        );
    }

    #[test]
    fn agrees_with_the_slow_oracle() {
        let d = [-0.3728755, 0.2037299, 0.002219027, 0.001383707, -0.07233722, 0.0, 0.0, 0.0];
        let seen = agrees_with(
            &kitti(),
            |point| oracle(point, [984.2439, 980.8141, 690.0, 233.1966], d),
            20_000,
        );
        assert!(seen > 1_000, "{seen} seen");
        let d = [0.4626, -2.6153, 0.0007, -0.00032, 1.5189, 0.3415, -2.4359, 1.4446];
        let seen = agrees_with(
            &rational(),
            |point| oracle(point, [611.2, 611.1, 638.4, 366.2], d),
            20_000,
        );
        assert!(seen > 1_000, "{seen} seen");
    }

    #[test]
    fn round_trips() {
        assert_eq!(round_trip_pixels(&kitti(), 1392, 512, 5), 279 * 103);
        assert_eq!(round_trip_pixels(&rational(), 1280, 720, 5), 256 * 144);
        let directions = [kitti(), rational()].map(|model| round_trip_directions(&model, 20_000));
        assert!(directions.iter().all(|&count| count > 1_000), "{directions:?}");
    }

    #[test]
    fn folded_and_rear_points_are_out_of_view() {
        // r (1 - r^2 / 3) grows up to r = 1: 45 degrees.
        let folding = model(
            [[100.0, 0.0, 50.0], [0.0, 100.0, 50.0], [0.0, 0.0, 1.0]],
            &[-1.0 / 3.0, 0.0, 0.0, 0.0],
        );
        let limit = std::f64::consts::FRAC_PI_4;
        for azimuth in [0.0, 1.0, 2.5, -2.0] {
            assert!(folding.project(&at_angle(limit - 1e-9, azimuth)).is_some());
            assert_eq!(folding.project(&at_angle(limit + 1e-9, azimuth)), None);
            assert_eq!(folding.project(&at_angle(3.0, azimuth)), None);
        }
        assert_eq!(folding.unproject(&Point2::new(50.0 + 66.7, 50.0)), None, "peak at 66.67");
    }

    #[test]
    fn strange_input_is_out_of_view() {
        refuses_strange_input(&kitti());
        refuses_strange_input(&rational());
    }

    #[test]
    fn wrong_coefficients_are_refused() {
        let k = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let error = |coefficients: &[f64]| {
            BrownConrady::new(Intrinsics::from_matrix(&k).unwrap(), coefficients)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            error(&[0.1; 6]),
            "Brown-Conrady distortion: 6 coefficients, expected 4, 5 or 8"
        );
        assert_eq!(
            error(&[0.1, f64::NAN, 0.0, 0.0]),
            "Brown-Conrady distortion: NaN, expected a finite number"
        );
    }
}
