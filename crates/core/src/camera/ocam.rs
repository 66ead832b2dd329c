//! The omnidirectional camera of Scaramuzza's OCamCalib toolbox.

use std::f64::consts::PI;

use nalgebra::{Matrix2, Point2, Point3, Vector2, Vector3};

use super::CameraError;
use super::error::{check, check_finite};
use super::polar::{at, polar};
use super::roots::{crossing, evaluate, evaluate_with_slope, positive_until};

/// Sensor radii beyond this, in pixels, are not told from infinity: no image is as large.
const FAR_RADIUS_PX: f64 = 1e9;

/// An omnidirectional camera whose viewing rays are a Taylor polynomial of the sensor radius:
///
/// ```text
/// ray of sensor point (x, y):   (x, y, f(rho))     f(rho) = a0 + a1 rho + a2 rho^2 + ...
/// pixel = [c d; e 1] (x, y) + centre               rho = sqrt(x^2 + y^2), in pixels
/// ```
///
/// z looks forward: a polynomial with a0 < 0, as OCamCalib writes it, is taken negated.
/// Omnidirectional: in view is every direction up to the largest angle of the calibration, as far
/// as rho grows with the angle (f - rho f' > 0).
///
/// Source: Scaramuzza, Martinelli and Siegwart 2006, A Flexible Technique for Accurate
/// Omnidirectional Camera Calibration and Structure from Motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Ocam {
    /// Ascending powers of rho; a0 > 0.
    polynomial: Vec<f64>,
    centre: Point2<f64>,
    pixel_from_sensor: Matrix2<f64>,
    sensor_from_pixel: Matrix2<f64>,
    max_angle_rad: f64,
    /// Sensor radius at which the angle stops growing, or the far radius.
    max_rho: f64,
}

impl Ocam {
    /// From the polynomial (ascending powers of rho), the centre (column, row), the affine part
    /// c, d, e, and the largest angle from the optical axis.
    ///
    /// # Errors
    /// If a number is not finite, a0 is 0 or missing, the affine part has no inverse, or the
    /// largest angle is not in (0, pi].
    pub fn new(
        polynomial: &[f64],
        centre: [f64; 2],
        [c, d, e]: [f64; 3],
        max_angle_rad: f64,
    ) -> Result<Self, CameraError> {
        check_finite("OCam centre", &centre)?;
        check_finite("OCam affine part", &[c, d, e])?;
        check("OCam largest angle", max_angle_rad, "in (0, pi]", |max| max > 0.0 && max <= PI)?;
        let polynomial = looking_forward(polynomial)?;
        let pixel_from_sensor = Matrix2::new(c, d, e, 1.0);
        Ok(Self {
            max_rho: growth_limit(&polynomial),
            polynomial,
            centre: Point2::from(centre),
            pixel_from_sensor,
            sensor_from_pixel: inverse(&pixel_from_sensor)?,
            max_angle_rad,
        })
    }

    /// The polynomial, ascending powers of rho; a0 is above 0.
    pub fn polynomial(&self) -> &[f64] {
        &self.polynomial
    }

    /// The centre: column, row, pixels.
    pub fn centre(&self) -> [f64; 2] {
        self.centre.into()
    }

    /// The affine part c, d, e.
    pub fn affine(&self) -> [f64; 3] {
        let affine = &self.pixel_from_sensor;
        [affine.m11, affine.m12, affine.m21]
    }

    /// The largest angle from the optical axis, radians.
    pub fn max_angle_rad(&self) -> f64 {
        self.max_angle_rad
    }

    pub(super) fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let (across, direction) = polar(point.x, point.y);
        let angle = libm::atan2(across, point.z);
        if angle > self.max_angle_rad {
            return None;
        }
        let sensor = at(self.rho_of(angle)?, &direction);
        Some(self.centre + self.pixel_from_sensor * sensor.coords)
    }

    pub(super) fn unproject(&self, pixel: &Point2<f64>) -> Option<Vector3<f64>> {
        let sensor: Vector2<f64> = self.sensor_from_pixel * (pixel - self.centre);
        let rho = libm::hypot(sensor.x, sensor.y);
        let height = evaluate(&self.polynomial, rho);
        let seen = rho < self.max_rho && libm::atan2(rho, height) <= self.max_angle_rad;
        seen.then(|| Vector3::new(sensor.x, sensor.y, height))
    }

    /// The sensor radius at which the viewing ray (rho, f(rho)) has an angle from the axis.
    ///
    /// It is where the ray's cross product with that angle's direction changes sign. The start is
    /// the equidistant lens of focal length a0, which most such lenses resemble.
    fn rho_of(&self, angle: f64) -> Option<f64> {
        let (sine, cosine) = libm::sincos(angle);
        let beyond = |rho: f64| {
            let (height, slope) = evaluate_with_slope(&self.polynomial, rho);
            (rho * cosine - height * sine, cosine - slope * sine)
        };
        crossing(beyond, self.polynomial[0] * angle, self.max_rho)
    }
}

/// The polynomial with the sign that makes a0 positive.
fn looking_forward(polynomial: &[f64]) -> Result<Vec<f64>, CameraError> {
    check_finite("OCam polynomial", polynomial)?;
    let a0 = polynomial.first().copied().unwrap_or(0.0);
    check("OCam polynomial a0", a0, "a number other than 0", |a0| a0 != 0.0)?;
    Ok(polynomial.iter().map(|a| a * a0.signum()).collect())
}

/// First rho at which f - rho f' = a0 - a2 rho^2 - 2 a3 rho^3 - ... stops being positive.
fn growth_limit(polynomial: &[f64]) -> f64 {
    let powers = polynomial.iter().enumerate();
    let growth: Vec<f64> = powers.map(|(power, a)| a * (1.0 - power as f64)).collect();
    positive_until(&growth, FAR_RADIUS_PX).min(FAR_RADIUS_PX)
}

/// The inverse of the affine part.
fn inverse(affine: &Matrix2<f64>) -> Result<Matrix2<f64>, CameraError> {
    affine.try_inverse().ok_or(CameraError::Number {
        name: "OCam affine part's determinant c - d e",
        expected: "a number other than 0",
        found: affine.determinant(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::checks::*;
    use super::*;
    use crate::camera::CameraModel;

    /// A 190 degree fisheye of 1024 x 768, of the size of OCamCalib's example, in its sign (a0 <
    /// 0).
    const FISHEYE: [f64; 5] = [-214.7757, 0.0, 1.72172e-3, -1.38631e-6, 4.21399e-9];
    const CENTRE: [f64; 2] = [511.3, 383.4];
    const AFFINE: [f64; 3] = [1.000034, -0.000062, -0.000101];
    const MAX_ANGLE: f64 = 95.0 / 180.0 * PI;

    /// rho stops growing with the angle at rho = 200: f - rho f' = 100 - 0.0025 rho^2.
    const FOLDING: [f64; 3] = [100.0, 0.0, 0.0025];

    fn model(polynomial: &[f64], max_angle: f64) -> CameraModel {
        CameraModel::Ocam(Ocam::new(polynomial, CENTRE, AFFINE, max_angle).unwrap())
    }

    /// Walks rho outward in steps of 1/16 px until the ray's angle passes the point's, then
    /// bisects.
    fn oracle(point: &Point3<f64>, polynomial: &[f64], max_angle: f64) -> Option<Point2<f64>> {
        let sign = polynomial[0].signum();
        let angle_at = |rho: f64| {
            let f: f64 = polynomial
                .iter()
                .enumerate()
                .map(|(i, a)| sign * a * libm::pow(rho, i as f64))
                .sum();
            libm::atan2(rho, f)
        };
        let angle = libm::acos(point.z / point.coords.norm());
        let mut high = 0.0;
        while angle_at(high) < angle {
            high += 0.0625;
            if angle > max_angle || high > 2000.0 || angle_at(high) <= angle_at(high - 0.0625) {
                return None;
            }
        }
        let mut low = f64::max(high - 0.0625, 0.0);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if angle_at(middle) < angle { low = middle } else { high = middle }
        }
        let azimuth = libm::atan2(point.y, point.x);
        let (x, y) = (low * libm::cos(azimuth), low * libm::sin(azimuth));
        let [c, d, e] = AFFINE;
        Some(Point2::new(c * x + d * y + CENTRE[0], e * x + y + CENTRE[1]))
    }

    #[test]
    fn parabola_is_known_by_hand() {
        // f = 100 - rho^2 / 400 vanishes at rho = 200: 90 degrees. At 45 degrees rho = f(rho):
        // rho^2 + 400 rho - 40 000 = 0, rho = 200 (sqrt 2 - 1).
        let parabola = Ocam::new(&[100.0, 0.0, -0.0025], [0.0; 2], [1.0, 0.0, 0.0], PI).unwrap();
        let model = CameraModel::Ocam(parabola);
        let near = |point: [f64; 3], pixel: [f64; 2]| holds_frozen(&model, &[(point, pixel)]);
        near([3.0, 0.0, 0.0], [200.0, 0.0]);
        near([0.0, -7.0, 7.0], [0.0, -200.0 * (2.0_f64.sqrt() - 1.0)]);
        near([0.0, 0.0, 9.0], [0.0, 0.0]);
    }

    #[test]
    fn agrees_with_numpy() {
        // Smallest positive of numpy.roots (2.x) of R f(rho) - Z rho, printed to 10 digits.
        holds_frozen(
            &model(&FISHEYE, MAX_ANGLE),
            &[
                ([0.0, 0.0, 2.0], [511.3000000000, 383.4000000000]),
                ([1.0, 0.5, 4.0], [563.5804183052, 409.5348504258]),
                ([-2.0, 1.0, 5.0], [430.6837326494, 423.7136555307]),
                ([0.3, -0.9, 0.2], [606.1587263171, 98.8768354136]),
                ([1.5, 0.4, -0.1], [864.9931685793, 477.6808085063]),
                ([-1.0, -1.0, -0.1], [251.3609742763, 123.4799503565]),
            ],
        );
    }

    #[test]
    fn agrees_with_the_slow_oracle() {
        for (polynomial, max_angle) in [(&FISHEYE[..], MAX_ANGLE), (&FISHEYE, 3.1), (&FOLDING, PI)]
        {
            let seen = agrees_with(
                &model(polynomial, max_angle),
                |point| oracle(point, polynomial, max_angle),
                3_000,
            );
            assert!(seen > 400, "{seen} seen of {polynomial:?}");
        }
    }

    #[test]
    fn round_trips() {
        let exercised = round_trip_pixels(&model(&FISHEYE, MAX_ANGLE), 1024, 768, 4);
        assert!(exercised > 27_000, "{exercised}: the fisheye's disc");
        for (polynomial, max_angle) in [(&FISHEYE[..], MAX_ANGLE), (&FISHEYE, 3.1), (&FOLDING, PI)]
        {
            let exercised = round_trip_directions(&model(polynomial, max_angle), 20_000);
            assert!(exercised > 2_700, "{exercised} of {polynomial:?}");
        }
    }

    #[test]
    fn both_signs_are_one_camera() {
        let negated = FISHEYE.map(|a| -a);
        assert_eq!(model(&FISHEYE, MAX_ANGLE), model(&negated, MAX_ANGLE));
    }

    #[test]
    fn view_ends_at_the_largest_angle() {
        let model = model(&FISHEYE, MAX_ANGLE);
        for azimuth in [0.0, 1.0, 2.5, -2.0] {
            let widest = model.project(&at_angle(MAX_ANGLE - 1e-9, azimuth)).unwrap();
            assert_eq!(model.project(&at_angle(MAX_ANGLE + 1e-9, azimuth)), None);
            let centre = Point2::from(CENTRE);
            assert_eq!(model.unproject(&(centre + (widest - centre) * 1.00001)), None);
            assert!(model.unproject(&(centre + (widest - centre) * 0.99999)).is_some());
        }
    }

    #[test]
    fn view_ends_where_rho_stops_growing() {
        // At rho = 200 the ray is (200, f(200) = 200): 45 degrees.
        let (model, end) = (model(&FOLDING, PI), 0.25 * PI);
        assert!(model.project(&at_angle(end - 1e-9, 1.0)).is_some());
        assert_eq!(model.project(&at_angle(end + 1e-9, 1.0)), None);
        assert!(model.unproject(&Point2::new(CENTRE[0] + 199.9, CENTRE[1])).is_some());
        assert_eq!(model.unproject(&Point2::new(CENTRE[0] + 200.1, CENTRE[1])), None);
    }

    #[test]
    fn strange_input_is_out_of_view() {
        refuses_strange_input(&model(&FISHEYE, MAX_ANGLE));
        refuses_strange_input(&model(&FOLDING, PI));
        refuses_strange_input(&model(&[200.0], PI));
    }

    #[test]
    fn wrong_calibrations_are_refused() {
        let error = |polynomial: &[f64], affine, max_angle| {
            Ocam::new(polynomial, CENTRE, affine, max_angle).unwrap_err().to_string()
        };
        let nowhere = "OCam polynomial a0: 0, expected a number other than 0";
        assert_eq!(error(&[], AFFINE, 1.0), nowhere);
        assert_eq!(error(&[0.0, 1.0], AFFINE, 1.0), nowhere);
        assert_eq!(
            error(&[1.0, f64::INFINITY], AFFINE, 1.0),
            "OCam polynomial: inf, expected a finite number"
        );
        assert_eq!(
            error(&FISHEYE, [1.0, 1.0, 1.0], 1.0),
            "OCam affine part's determinant c - d e: 0, expected a number other than 0"
        );
        assert_eq!(error(&FISHEYE, AFFINE, 4.0), "OCam largest angle: 4, expected in (0, pi]");
        assert_eq!(
            error(&FISHEYE, AFFINE, f64::NAN),
            "OCam largest angle: NaN, expected in (0, pi]"
        );
    }
}
