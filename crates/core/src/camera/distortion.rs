//! Radial and tangential lens distortion on the normalised image plane.

use nalgebra::{Matrix2, Point2, Vector2};

use super::polar;
use super::roots::{crossing, evaluate, evaluate_with_slope, positive_until};

/// Radii beyond this are not told from infinity: 1e-8 rad from the image plane of a pinhole.
const FAR_RADIUS: f64 = 1e8;

/// An inversion searches up to this part of the limit, so as not to round past a pole.
const BEFORE_LIMIT: f64 = 1.0 - 1e-12;

/// Residual of an inversion, relative to 1 + radius, at which one last Newton step is taken.
const RESIDUAL_TOLERANCE: f64 = 1e-12;

/// Newton's steps before an inversion is given up; realistic lenses need 3 to 6.
const MAX_STEPS: usize = 50;

/// Distortion by Brown and Conrady, with OpenCV's rational radial factor.
///
/// ```text
/// s  = x^2 + y^2
/// g  = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
/// x' = x g + 2 p1 x y + p2 (s + 2 x^2)
/// y' = y g + p1 (s + 2 y^2) + 2 p2 x y
/// ```
///
/// Valid below the first radius r at which r g stops growing: beyond it the image folds back.
/// Source: OpenCV, calib3d, "Detailed Description"; Brown 1966, Decentering Distortion of Lenses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distortion {
    /// Ascending powers of s, led by 1: k1 k2 k3.
    numerator: [f64; 4],
    /// Ascending powers of s, led by 1: k4 k5 k6.
    denominator: [f64; 4],
    p1: f64,
    p2: f64,
    /// First radius that is not in the valid range; infinite if the image never folds.
    limit: f64,
}

impl Distortion {
    /// From k1..k6 and p1 p2, which the model's constructor has found to be finite.
    pub(super) fn new([k1, k2, k3, k4, k5, k6]: [f64; 6], [p1, p2]: [f64; 2]) -> Self {
        let (numerator, denominator) = ([1.0, k1, k2, k3], [1.0, k4, k5, k6]);
        let limit = growth_limit(&numerator, &denominator);
        Self { numerator, denominator, p1, p2, limit }
    }

    /// k1..k6 and p1 p2: the inverse of [`Self::new`].
    pub(super) fn coefficients(&self) -> ([f64; 6], [f64; 2]) {
        let ([_, k1, k2, k3], [_, k4, k5, k6]) = (self.numerator, self.denominator);
        ([k1, k2, k3, k4, k5, k6], [self.p1, self.p2])
    }

    /// Where the lens images a plane point; `None` from the radius on where the image folds back.
    pub(super) fn distort(&self, plane: &Point2<f64>) -> Option<Point2<f64>> {
        let s = plane.coords.norm_squared();
        let factor = evaluate(&self.numerator, s) / evaluate(&self.denominator, s);
        let valid = s < self.limit * self.limit;
        valid.then(|| plane * factor + self.tangential(plane, s))
    }

    /// The plane point of the valid range that the lens images here; `None` if there is none.
    ///
    /// Newton's method, started at the exact inverse of the radial part.
    pub(super) fn undistort(&self, image: &Point2<f64>) -> Option<Point2<f64>> {
        let mut plane = self.undistort_radially(image);
        let tolerance = RESIDUAL_TOLERANCE * (1.0 + image.coords.norm());
        for _ in 0..MAX_STEPS {
            let (value, jacobian) = self.linearise(&plane);
            let residual = value - image;
            plane -= jacobian.try_inverse()? * residual;
            if residual.amax() <= tolerance {
                return (plane.coords.norm() < self.limit).then_some(plane);
            }
        }
        None
    }

    /// The inverse without the tangential part. An image point that the radial part does not reach
    /// gets half the valid radius: seen from there, Newton's steps do not overshoot the fold.
    fn undistort_radially(&self, image: &Point2<f64>) -> Point2<f64> {
        let (target, direction) = polar::polar(image.x, image.y);
        let upper = self.limit.min(FAR_RADIUS) * BEFORE_LIMIT;
        let beyond = |r: f64| {
            let (factor, slope) = self.radial(r * r);
            (r * factor - target, factor + 2.0 * r * r * slope)
        };
        polar::at(crossing(beyond, target, upper).unwrap_or(upper / 2.0), &direction)
    }

    /// The radial factor g and its derivative by s.
    fn radial(&self, s: f64) -> (f64, f64) {
        let (above, above_slope) = evaluate_with_slope(&self.numerator, s);
        let (below, below_slope) = evaluate_with_slope(&self.denominator, s);
        let factor = above / below;
        (factor, (above_slope - factor * below_slope) / below)
    }

    /// The shift of a plane point by decentred lens elements.
    fn tangential(&self, plane: &Point2<f64>, s: f64) -> Vector2<f64> {
        let &Self { p1, p2, .. } = self;
        let (x, y) = (plane.x, plane.y);
        Vector2::new(
            2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
            p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    /// The image of a plane point and the Jacobian there, whatever the range.
    fn linearise(&self, plane: &Point2<f64>) -> (Point2<f64>, Matrix2<f64>) {
        let &Self { p1, p2, .. } = self;
        let (x, y, s) = (plane.x, plane.y, plane.coords.norm_squared());
        let (factor, slope) = self.radial(s);
        let across = 2.0 * (x * y * slope + p1 * x + p2 * y);
        let jacobian = Matrix2::new(
            factor + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            across,
            across,
            factor + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        (plane * factor + self.tangential(plane, s), jacobian)
    }
}

/// First radius at which r N(s) / D(s) stops growing, s = r^2, or at which D vanishes.
///
/// The sign of the derivative by r is that of N D + 2 s (N' D - N D'), a polynomial in s.
fn growth_limit(numerator: &[f64; 4], denominator: &[f64; 4]) -> f64 {
    let mut growth = [0.0; 7];
    for (i, above) in numerator.iter().enumerate() {
        for (j, below) in denominator.iter().enumerate() {
            growth[i + j] += above * below * (1.0 + 2.0 * i as f64 - 2.0 * j as f64);
        }
    }
    let upper = FAR_RADIUS * FAR_RADIUS;
    positive_until(&growth, upper).min(positive_until(denominator, upper)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radial(k: [f64; 6]) -> Distortion {
        Distortion::new(k, [0.0; 2])
    }

    #[test]
    fn limit_of_one_coefficient_is_known() {
        // r (1 + k1 r^2) stops growing at 1 + 3 k1 r^2 = 0.
        for k1 in [-1e15, -3.0, -0.3, -1e-6, -1e-12] {
            let (limit, expected) =
                (radial([k1, 0.0, 0.0, 0.0, 0.0, 0.0]).limit, (-1.0 / (3.0 * k1)).sqrt());
            assert!(
                (limit / expected - 1.0).abs() < 1e-14,
                "k1 {k1}: {limit}, expected {expected}"
            );
        }
        assert_eq!(radial([0.3, 0.0, 0.0, 0.0, 0.0, 0.0]).limit, f64::INFINITY);
        assert_eq!(radial([0.0; 6]).limit, f64::INFINITY);
    }

    #[test]
    fn a_pole_ends_the_range() {
        // r / (1 - 4 r^2) grows up to its pole at r = 1/2; r / (1 + r^2) stops growing at r = 1.
        let pole = radial([0.0, 0.0, 0.0, -4.0, 0.0, 0.0]).limit;
        assert!((pole - 0.5).abs() < 1e-15, "{pole}");
        let hill = radial([0.0, 0.0, 0.0, 1.0, 0.0, 0.0]).limit;
        assert!((hill - 1.0).abs() < 1e-15, "{hill}");
    }

    #[test]
    fn limit_agrees_with_a_dense_scan() {
        let mut random = crate::camera::checks::Random::new(3);
        let mut limited = 0;
        for _ in 0..300 {
            let lens = radial([(); 6].map(|()| random.within(-0.5, 0.5)));
            let image = |i: u32| {
                let r = f64::from(i) * 1e-3;
                let (factor, _) = lens.radial(r * r);
                (r, r * factor, evaluate(&lens.denominator, r * r))
            };
            let fold = (1..3000).find(|&i| image(i).1 <= image(i - 1).1 || image(i).2 <= 0.0);
            let Some((scanned, ..)) = fold.map(image) else {
                assert!(lens.limit > 2.998, "{lens:?}: the scan finds no fold");
                continue;
            };
            assert!((lens.limit - scanned).abs() < 2.1e-3, "{lens:?}: scan {scanned}");
            limited += 1;
        }
        assert!(limited > 150, "{limited} with a limit");
    }

    #[test]
    fn strong_lenses_invert_up_to_their_fold() {
        let mut random = crate::camera::checks::Random::new(4);
        let mut inverted = 0;
        for _ in 0..200 {
            let k = [(); 6].map(|()| random.within(-0.5, 0.5));
            let p = [(); 2].map(|()| random.within(-3e-3, 3e-3));
            let lens = Distortion::new(k, p);
            for _ in 0..50 {
                let radius = random.within(0.0, 0.9 * lens.limit.min(2.0));
                let plane = polar::at(
                    radius,
                    &polar::polar(random.within(-1.0, 1.0), random.within(-1.0, 1.0)).1,
                );
                let image = lens.distort(&plane).unwrap();
                let back = lens
                    .undistort(&image)
                    .unwrap_or_else(|| panic!("{lens:?}: {plane} -> {image}"));
                let off = (lens.distort(&back).unwrap() - image).norm();
                assert!(
                    off < 1e-12 * (1.0 + image.coords.norm()),
                    "{lens:?}: {plane} is {off:e} off"
                );
                inverted += 1;
            }
        }
        assert_eq!(inverted, 10_000);
    }

    #[test]
    fn beyond_the_fold_there_is_nothing() {
        // r (1 - r^2 / 3) peaks at r = 1 with 2/3.
        let lens = radial([-1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(lens.distort(&Point2::new(1.0 + 1e-12, 0.0)), None);
        assert!(lens.distort(&Point2::new(0.0, 1.0 - 1e-12)).is_some());
        assert_eq!(lens.undistort(&Point2::new(0.667, 0.0)), None);
        let image = Point2::new(0.99 * (1.0 - 0.99 * 0.99 / 3.0), 0.0);
        let plane = lens.undistort(&image).unwrap();
        assert!((plane.x - 0.99).abs() < 1e-12, "{plane}");
    }
}
