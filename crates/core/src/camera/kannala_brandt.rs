//! The fisheye camera of OpenCV.

use std::f64::consts::PI;

use nalgebra::{Point2, Point3, Vector3};

use super::error::exactly;
use super::polar::{at, polar};
use super::roots::{crossing, evaluate, evaluate_with_slope, positive_until};
use super::{CameraError, Intrinsics};

/// A fisheye whose image radius is a polynomial of the angle t from the optical axis:
///
/// ```text
/// r(t) = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)        on the normalised image plane
/// ```
///
/// Omnidirectional: in view is every direction below the first angle at which r stops growing,
/// behind the image plane too, but not the axis's own backward direction.
///
/// Source: Kannala and Brandt 2006, A Generic Camera Model and Calibration Method, in the form of
/// OpenCV, "Fisheye camera model".
#[derive(Clone, Debug, PartialEq)]
pub struct KannalaBrandt {
    intrinsics: Intrinsics,
    /// Ascending powers of t^2, led by 1.
    growth: [f64; 5],
    /// First angle that is not in view, at most pi.
    limit: f64,
}

impl KannalaBrandt {
    /// From coefficients k1 k2 k3 k4.
    ///
    /// # Errors
    /// If there are not 4 coefficients, or one is not finite.
    pub fn new(intrinsics: Intrinsics, coefficients: &[f64]) -> Result<Self, CameraError> {
        let [k1, k2, k3, k4] = exactly("Kannala-Brandt distortion", "4", coefficients)?;
        let slope = [1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4];
        let limit = positive_until(&slope, PI * PI).sqrt().min(PI);
        Ok(Self { intrinsics, growth: [1.0, k1, k2, k3, k4], limit })
    }

    /// The pinhole part.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// The coefficients k1 k2 k3 k4.
    pub fn coefficients(&self) -> [f64; 4] {
        let [_, k1, k2, k3, k4] = self.growth;
        [k1, k2, k3, k4]
    }

    pub(super) fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let (across, direction) = polar(point.x, point.y);
        let angle = libm::atan2(across, point.z);
        let radius = angle * evaluate(&self.growth, angle * angle);
        (angle < self.limit).then(|| self.intrinsics.pixel(&at(radius, &direction)))
    }

    pub(super) fn unproject(&self, pixel: &Point2<f64>) -> Option<Vector3<f64>> {
        let plane = self.intrinsics.plane(pixel);
        let (radius, direction) = polar(plane.x, plane.y);
        let angle = self.angle_of(radius).filter(|&angle| angle < self.limit)?;
        let across = at(libm::sin(angle), &direction);
        Some(Vector3::new(across.x, across.y, libm::cos(angle)))
    }

    /// The angle from the axis that is imaged at a radius.
    fn angle_of(&self, radius: f64) -> Option<f64> {
        let beyond = |angle: f64| {
            let square = angle * angle;
            let (factor, slope) = evaluate_with_slope(&self.growth, square);
            (angle * factor - radius, factor + 2.0 * square * slope)
        };
        crossing(beyond, radius, self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::super::checks::*;
    use super::*;
    use crate::camera::CameraModel;

    const TUM_VI_K: [[f64; 3]; 3] = [
        [190.97847715128717, 0.0, 254.93170605935475],
        [0.0, 190.9733070521226, 256.8974428996504],
        [0.0, 0.0, 1.0],
    ];

    const TUM_VI: [f64; 4] = [
        0.0034823894022493434,
        0.0007150348452162257,
        -0.0020532361418706202,
        0.00020293673591811182,
    ];

    /// Folds near 107 degrees.
    const FOLDING: [f64; 4] = [-0.09, -0.002, 0.0, 0.0];

    fn model(coefficients: &[f64]) -> CameraModel {
        let intrinsics = Intrinsics::from_matrix(&TUM_VI_K).unwrap();
        CameraModel::KannalaBrandt(KannalaBrandt::new(intrinsics, coefficients).unwrap())
    }

    fn limit(coefficients: &[f64]) -> f64 {
        let CameraModel::KannalaBrandt(model) = model(coefficients) else { unreachable!() };
        model.limit
    }

    /// The paper's formula by powers; in view if r(t) grew at each of many steps from the axis to
    /// the point.
    fn oracle(point: &Point3<f64>, [k1, k2, k3, k4]: [f64; 4]) -> Option<Point2<f64>> {
        let angle = libm::acos(point.z / point.coords.norm());
        let terms = |t: f64| {
            [(k1, 3.0), (k2, 5.0), (k3, 7.0), (k4, 9.0)].map(|(k, power)| k * libm::pow(t, power))
        };
        let radius = |t: f64| t + terms(t).iter().sum::<f64>();
        let at_step = |i: u32| radius(angle * f64::from(i) / 5000.0);
        if (1..=5000).any(|i| at_step(i) <= at_step(i - 1)) {
            return None;
        }
        let azimuth = libm::atan2(point.y, point.x);
        let [[fx, _, cx], [_, fy, cy], _] = TUM_VI_K;
        let (x, y) = (radius(angle) * libm::cos(azimuth), radius(angle) * libm::sin(azimuth));
        Some(Point2::new(fx * x + cx, fy * y + cy))
    }

    #[test]
    fn agrees_with_opencv() {
        // cv2.fisheye.projectPoints of OpenCV 5.0.0, no rotation, no translation, printed to 10
        // digits.
        holds_frozen(
            &model(&TUM_VI),
            &[
                ([0.0, 0.0, 2.0], [254.9317060594, 256.8974428997]),
                ([1.0, 0.5, 4.0], [301.5003798020, 280.1811494260]),
                ([-2.0, 1.0, 5.0], [183.0525243581, 292.8360608069]),
                ([0.3, -0.9, 3.0], [273.4347501527, 201.3898133425]),
                ([1.5, 0.4, 2.5], [357.5851966679, 284.2709659959]),
                ([-1.0, -1.0, 3.0], [195.4032620725, 197.3706104449]),
            ],
        );
    }

    #[test]
    fn equidistant_lens_sees_backwards() {
        // Without coefficients r = t: 135 degrees to the right lie 3/4 pi focal lengths right of
        // the centre.
        let model = model(&[0.0; 4]);
        let pixel = model.project(&Point3::new(1.0, 0.0, -1.0)).unwrap();
        assert!((pixel.x - TUM_VI_K[0][2] - 0.75 * PI * TUM_VI_K[0][0]).abs() < 1e-10, "{pixel}");
        assert_eq!(
            model.project(&Point3::new(0.0, 0.0, -1.0)),
            None,
            "straight back has no azimuth"
        );
        assert!(model.project(&at_angle(PI - 1e-6, 1.0)).is_some());
    }

    #[test]
    fn agrees_with_the_slow_oracle() {
        for coefficients in [TUM_VI, FOLDING] {
            let seen =
                agrees_with(&model(&coefficients), |point| oracle(point, coefficients), 4_000);
            assert!(seen > 2_000, "{seen} seen of {coefficients:?}");
        }
    }

    #[test]
    fn round_trips() {
        let exercised = round_trip_pixels(&model(&TUM_VI), 512, 512, 2);
        assert_eq!(exercised, 256 * 256, "the corners are 107 degrees off the axis");
        for coefficients in [TUM_VI, FOLDING] {
            let exercised = round_trip_directions(&model(&coefficients), 20_000);
            assert!(exercised > 12_000, "{exercised} of {coefficients:?}");
        }
    }

    #[test]
    fn beyond_the_fold_there_is_nothing() {
        let (model, limit) = (model(&FOLDING), limit(&FOLDING));
        assert!((limit - 1.82).abs() < 0.1, "{limit}");
        for azimuth in [0.0, 1.0, 2.5, -2.0] {
            assert!(model.project(&at_angle(limit - 1e-9, azimuth)).is_some());
            assert_eq!(model.project(&at_angle(limit + 1e-9, azimuth)), None);
        }
        let widest = model.project(&at_angle(limit - 1e-9, 0.0)).unwrap();
        assert_eq!(model.unproject(&Point2::new(widest.x + 1e-3, widest.y)), None);
    }

    #[test]
    fn strange_input_is_out_of_view() {
        refuses_strange_input(&model(&TUM_VI));
        refuses_strange_input(&model(&FOLDING));
    }

    #[test]
    fn wrong_coefficients_are_refused() {
        let intrinsics = Intrinsics::from_matrix(&TUM_VI_K).unwrap();
        let error = KannalaBrandt::new(intrinsics, &[0.1; 5]).unwrap_err();
        assert_eq!(error.to_string(), "Kannala-Brandt distortion: 5 coefficients, expected 4");
    }
}
