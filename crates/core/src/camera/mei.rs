//! The omnidirectional camera of OpenCV's contrib modules.

use nalgebra::{Point2, Point3, Vector3};

use super::distortion::Distortion;
use super::error::{check, exactly};
use super::{CameraError, Intrinsics};

/// A unit sphere seen by a distorted pinhole that is shifted back by xi from the sphere's centre:
///
/// ```text
/// (X, Y, Z) = p / |p|        x = X / (Z + xi)        y = Y / (Z + xi)
/// ```
///
/// then radial and tangential distortion, then the camera matrix. xi = 0 is a pinhole, xi = 1 a
/// parabolic mirror. Omnidirectional: in view is every direction up to which the image radius
/// grows, that is Z + xi > 0, 1 + xi Z > 0, and below the fold of the radial distortion.
///
/// Source: Mei and Rives 2007, Single View Point Omnidirectional Camera Calibration from Planar
/// Grids, in the form of OpenCV, ccalib, "Omnidirectional camera".
#[derive(Clone, Debug, PartialEq)]
pub struct Mei {
    intrinsics: Intrinsics,
    xi: f64,
    distortion: Distortion,
}

impl Mei {
    /// From coefficients xi k1 k2 p1 p2.
    ///
    /// # Errors
    /// If there are not 5 coefficients, one is not finite, or xi <= -1 (nothing would be in view).
    pub fn new(intrinsics: Intrinsics, coefficients: &[f64]) -> Result<Self, CameraError> {
        let [xi, k1, k2, p1, p2] = exactly("Mei distortion", "5", coefficients)?;
        check("Mei xi", xi, "more than -1", |xi| xi > -1.0)?;
        let distortion = Distortion::new([k1, k2, 0.0, 0.0, 0.0, 0.0], [p1, p2]);
        Ok(Self { intrinsics, xi, distortion })
    }

    /// The pinhole part.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// The coefficients xi k1 k2 p1 p2.
    pub fn coefficients(&self) -> [f64; 5] {
        let ([k1, k2, ..], [p1, p2]) = self.distortion.coefficients();
        [self.xi, k1, k2, p1, p2]
    }

    pub(super) fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let distance = libm::hypot(libm::hypot(point.x, point.y), point.z);
        let cosine = point.z / distance;
        let depth = cosine + self.xi;
        if depth <= 0.0 || 1.0 + self.xi * cosine <= 0.0 {
            return None;
        }
        let plane = Point2::new(point.x / distance / depth, point.y / distance / depth);
        self.distortion.distort(&plane).map(|image| self.intrinsics.pixel(&image))
    }

    /// The nearer point of the sphere on the shifted pinhole's ray (Mei and Rives 2007, section
    /// II).
    pub(super) fn unproject(&self, pixel: &Point2<f64>) -> Option<Vector3<f64>> {
        let plane = self.distortion.undistort(&self.intrinsics.plane(pixel))?;
        let square = plane.coords.norm_squared();
        let discriminant = 1.0 + (1.0 - self.xi * self.xi) * square;
        let distance = (self.xi + discriminant.sqrt()) / (1.0 + square);
        (discriminant > 0.0)
            .then(|| Vector3::new(distance * plane.x, distance * plane.y, distance - self.xi))
    }
}

#[cfg(test)]
mod tests {
    use super::super::checks::*;
    use super::*;
    use crate::camera::CameraModel;

    /// Camera 2 of KITTI-360, 1400 x 1400, with a little skew added.
    const KITTI_360_K: [[f64; 3]; 3] = [
        [1336.3220825849971, 0.7, 716.943235101263],
        [0.0, 1335.7883350012958, 705.764983082216],
        [0.0, 0.0, 1.0],
    ];

    const KITTI_360: [f64; 5] = [
        2.213404750785489,
        0.01679823566011368,
        1.6548773243373522,
        0.00042223943394772046,
        0.00042462134260997584,
    ];

    /// As of a catadioptric camera calibrated by Kalibr; the radial part folds at m = 0.9.
    const MIRROR: [f64; 5] = [0.98, -0.35, 0.04, 0.0005, -0.0003];

    fn model(coefficients: &[f64]) -> CameraModel {
        let intrinsics = Intrinsics::from_matrix(&KITTI_360_K).unwrap();
        CameraModel::Mei(Mei::new(intrinsics, coefficients).unwrap())
    }

    /// The formula spelled out with angles; in view if the sphere's and the lens's image radius
    /// grew at each of many steps from the axis to the point.
    fn oracle(point: &Point3<f64>, [xi, k1, k2, p1, p2]: [f64; 5]) -> Option<Point2<f64>> {
        let angle = libm::atan2(libm::hypot(point.x, point.y), point.z);
        let on_plane = |i: u32| {
            let t = angle * f64::from(i) / 5000.0;
            (libm::sin(t) / (libm::cos(t) + xi), libm::cos(t) + xi)
        };
        let lens = |r: f64| r * (1.0 + k1 * libm::pow(r, 2.0) + k2 * libm::pow(r, 4.0));
        let grows = |i: u32| {
            let ((r, depth), (before, _)) = (on_plane(i), on_plane(i - 1));
            depth > 0.0 && r > before && lens(r) > lens(before)
        };
        if !(1..=5000).all(grows) {
            return None;
        }
        let (r, azimuth) = (on_plane(5000).0, libm::atan2(point.y, point.x));
        let (x, y) = (r * libm::cos(azimuth), r * libm::sin(azimuth));
        let u = lens(r) * libm::cos(azimuth) + 2.0 * p1 * x * y + p2 * (r * r + 2.0 * x * x);
        let v = lens(r) * libm::sin(azimuth) + p1 * (r * r + 2.0 * y * y) + 2.0 * p2 * x * y;
        let [[fx, skew, cx], [_, fy, cy], _] = KITTI_360_K;
        Some(Point2::new(fx * u + skew * v + cx, fy * v + cy))
    }

    #[test]
    fn agrees_with_opencv() {
        // cv2.omnidir.projectPoints of OpenCV 5.0.0, no rotation, no translation, printed to 10
        // digits.
        holds_frozen(
            &model(&KITTI_360),
            &[
                ([0.0, 0.0, 2.0], [716.9432351013, 705.7649830822]),
                ([1.0, 0.5, 4.0], [818.2950169083, 756.4093827209]),
                ([-2.0, 1.0, 5.0], [560.7996368362, 783.8405024476]),
                ([0.3, -0.9, 0.2], [895.6370560459, 169.4252914250]),
                ([1.5, 0.4, -0.1], [1365.3054052139, 878.6573525035]),
                ([-1.0, -1.0, -0.3], [211.2865708987, 200.5741612031]),
            ],
        );
    }

    #[test]
    fn xi_1_is_stereographic() {
        // A point 90 degrees off the axis lies on the image plane at radius tan(45 degrees) = 1.
        let pixel = model(&[1.0, 0.0, 0.0, 0.0, 0.0]).project(&Point3::new(5.0, 0.0, 0.0)).unwrap();
        assert!((pixel.x - KITTI_360_K[0][0] - KITTI_360_K[0][2]).abs() < 1e-10, "{pixel}");
    }

    #[test]
    fn agrees_with_the_slow_oracle() {
        for (coefficients, at_least) in [(KITTI_360, 2_500), (MIRROR, 1_600), ([0.0; 5], 1_600)] {
            let seen =
                agrees_with(&model(&coefficients), |point| oracle(point, coefficients), 4_000);
            assert!(seen > at_least, "{seen} seen of {coefficients:?}");
        }
    }

    #[test]
    fn round_trips() {
        let exercised = round_trip_pixels(&model(&KITTI_360), 1400, 1400, 5);
        assert!(exercised > 60_000, "{exercised} of {}: all but the corners", 280 * 280);
        for coefficients in [KITTI_360, MIRROR] {
            let exercised = round_trip_directions(&model(&coefficients), 20_000);
            assert!(exercised > 8_000, "{exercised} of {coefficients:?}");
        }
    }

    #[test]
    fn view_ends_where_the_radius_stops_growing() {
        let ends =
            [(2.0, libm::acos(-0.5)), (0.0, 0.5 * std::f64::consts::PI), (0.5, libm::acos(-0.5))];
        for (xi, end) in ends {
            let model = model(&[xi, 0.0, 0.0, 0.0, 0.0]);
            assert!(model.project(&at_angle(end - 1e-9, 2.0)).is_some(), "xi {xi}");
            assert_eq!(model.project(&at_angle(end + 1e-9, 2.0)), None, "xi {xi}");
        }
        let widest = 1.0 / 3.0_f64.sqrt() * KITTI_360_K[0][0] + KITTI_360_K[0][2];
        let model = model(&[2.0, 0.0, 0.0, 0.0, 0.0]);
        assert!(model.unproject(&Point2::new(widest - 1e-3, KITTI_360_K[1][2])).is_some());
        assert_eq!(model.unproject(&Point2::new(widest + 1e-3, KITTI_360_K[1][2])), None);
    }

    #[test]
    fn strange_input_is_out_of_view() {
        refuses_strange_input(&model(&KITTI_360));
        refuses_strange_input(&model(&MIRROR));
    }

    #[test]
    fn wrong_coefficients_are_refused() {
        let error = |coefficients: &[f64]| {
            Mei::new(Intrinsics::from_matrix(&KITTI_360_K).unwrap(), coefficients)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(error(&[1.0; 4]), "Mei distortion: 4 coefficients, expected 5");
        assert_eq!(error(&[-1.0, 0.0, 0.0, 0.0, 0.0]), "Mei xi: -1, expected more than -1");
    }
}
