//! What every camera model's tests check alike. Each returns how many cases it exercised, to be
//! asserted.

use nalgebra::{Point2, Point3, Vector3};

use super::CameraModel;

/// Claimed accuracy of round trips and against oracles, in pixels.
const TOLERANCE_PX: f64 = 1e-6;

/// Numbers that look random and are the same on every machine (SplitMix64, Steele et al. 2014).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A point of the camera frame in any direction, evenly over the sphere, 0.1 to 100 m away.
    pub(super) fn point(&mut self) -> Point3<f64> {
        let z = self.within(-1.0, 1.0);
        let azimuth = self.within(0.0, std::f64::consts::TAU);
        let (sine, distance) = ((1.0 - z * z).sqrt(), libm::pow(10.0, self.within(-1.0, 2.0)));
        Point3::new(sine * libm::cos(azimuth), sine * libm::sin(azimuth), z) * distance
    }
}

/// Pixel centres of every `stride`-th row and column that have a direction; each must project back
/// to itself.
pub(super) fn round_trip_pixels(
    model: &CameraModel,
    width: u32,
    height: u32,
    stride: usize,
) -> usize {
    let mut exercised = 0;
    for (i, j) in
        (0..height).step_by(stride).flat_map(|j| (0..width).step_by(stride).map(move |i| (i, j)))
    {
        let pixel = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
        let Some(ray) = model.unproject(&pixel) else { continue };
        assert!((ray.norm() - 1.0).abs() < 1e-15, "ray of {pixel} is {} long", ray.norm());
        let back = model.project(&Point3::from(ray.into_inner() * 3.0));
        assert_near(back, pixel, &pixel);
        exercised += 1;
    }
    exercised
}

/// Random points whose pixel is within 10 000 px of the image's corner: the direction of the pixel
/// must project to the same pixel, and be the point's own. Left out are points near the end of the
/// view: tangential distortion moves the fold there, and two directions share a pixel.
pub(super) fn round_trip_directions(model: &CameraModel, count: usize) -> usize {
    let mut random = Random::new(1);
    let mut exercised = 0;
    for point in (0..count).map(|_| random.point()) {
        let pixel = model.project(&point).filter(is_near_image);
        let Some(pixel) = pixel.filter(|_| !is_at_end_of_view(model, &point, 0.03)) else {
            continue;
        };
        let ray = model.unproject(&pixel);
        let ray = ray.unwrap_or_else(|| panic!("no ray for {pixel}, where {point} is"));
        assert_near(model.project(&Point3::from(ray.into_inner())), pixel, &point);
        let off = (ray.into_inner() - point.coords.normalize()).norm();
        assert!(off < 1e-6, "ray of {pixel} is {off:e} off {point}");
        exercised += 1;
    }
    exercised
}

/// Random points: the model must see the same ones as the oracle, in the same pixels. Left out are
/// points near the end of the view, where the steps of the oracles are too coarse.
pub(super) fn agrees_with(
    model: &CameraModel,
    oracle: impl Fn(&Point3<f64>) -> Option<Point2<f64>>,
    count: usize,
) -> usize {
    let mut random = Random::new(2);
    let points = (0..count).map(|_| random.point());
    let mut seen = 0;
    for point in points.filter(|point| !is_at_end_of_view(model, point, 1e-3)) {
        let (found, expected) = (model.project(&point), oracle(&point));
        assert_eq!(found.is_some(), expected.is_some(), "{point}: {found:?}, oracle {expected:?}");
        let Some(expected) = expected.filter(is_near_image) else { continue };
        assert_near(found, expected, &point);
        seen += 1;
    }
    seen
}

/// Each frozen `(point, pixel)` pair must hold.
pub(super) fn holds_frozen(model: &CameraModel, frozen: &[([f64; 3], [f64; 2])]) {
    for &(point, pixel) in frozen {
        assert_near(model.project(&Point3::from(point)), Point2::from(pixel), &point);
    }
}

/// NaN, infinities and the camera's own position: `None`. Absurd magnitudes: `None` or finite.
pub(super) fn refuses_strange_input(model: &CameraModel) {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut point = Point3::new(0.1, 0.2, 1.0);
            point[axis] = bad;
            assert_eq!(model.project(&point), None);
        }
        assert_eq!(model.unproject(&Point2::new(bad, 100.0)), None);
        assert_eq!(model.unproject(&Point2::new(100.0, bad)), None);
    }
    assert_eq!(model.project(&Point3::origin()), None);
    let absurd = [0.0, -0.0, 5e-324, -1e-300, 1.0, -1.0, 1e154, -1e200, f64::MAX, f64::MIN];
    for (x, y) in absurd.iter().flat_map(|&x| absurd.map(|y| (x, y))) {
        for pixel in absurd.iter().filter_map(|&z| model.project(&Point3::new(x, y, z))) {
            assert!(pixel.x.is_finite() && pixel.y.is_finite(), "{x} {y}: {pixel}");
        }
        if let Some(ray) = model.unproject(&Point2::new(x, y)) {
            assert!((ray.norm() - 1.0).abs() < 1e-12, "{x} {y}: {ray:?}");
        }
    }
}

/// A point of the camera frame at an angle from the optical axis, 1 m away.
pub(super) fn at_angle(angle: f64, azimuth: f64) -> Point3<f64> {
    let sine = libm::sin(angle);
    let direction =
        Vector3::new(sine * libm::cos(azimuth), sine * libm::sin(azimuth), libm::cos(angle));
    Point3::from(direction)
}

/// Whether a pixel is near enough for the tolerance in pixels to be above f64's own.
fn is_near_image(pixel: &Point2<f64>) -> bool {
    pixel.coords.norm() < 1e4
}

/// Whether the view begins or ends within some angle of a point.
fn is_at_end_of_view(model: &CameraModel, point: &Point3<f64>, within: f64) -> bool {
    let angle = libm::atan2(libm::hypot(point.x, point.y), point.z);
    let azimuth = libm::atan2(point.y, point.x);
    let is_seen = |angle: f64| model.project(&at_angle(angle, azimuth)).is_some();
    is_seen((angle - within).max(0.0)) != is_seen((angle + within).min(std::f64::consts::PI))
}

#[track_caller]
fn assert_near(found: Option<Point2<f64>>, expected: Point2<f64>, what: &dyn std::fmt::Debug) {
    let found = found.unwrap_or_else(|| panic!("{what:?} is out of view, expected at {expected}"));
    let off = (found - expected).norm();
    assert!(off < TOLERANCE_PX, "{what:?}: {found}, expected {expected}, {off:e} px off");
}
