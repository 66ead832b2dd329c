//! From where a perspective picture is taken.

use nalgebra::{Point3, Vector3};
use occlabel_core::GridSpec;

use crate::picture::lens::{Lens, TAN_HALF_VIEW};
use crate::picture::painted::Painted;
use crate::picture::plate::body_width_px;

/// A camera on a sphere around a target, in the grid frame.
///
/// ```text
///   elevation 90 deg: from straight above        azimuth 0: from ahead, looking back
///   elevation  0 deg: level                      azimuth 90 deg: from the left; 180 deg: from behind
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Orbit {
    /// What the camera looks at, metres.
    pub target: Point3<f64>,
    /// From where it looks, seen from the target: from x towards y.
    pub azimuth_rad: f64,
    /// How high above the target's level it stands.
    pub elevation_rad: f64,
    /// How far from the target it stands.
    pub distance_m: f64,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
}

impl Orbit {
    /// From behind and above, a little from the right; the grid fills the picture.
    pub fn behind(spec: &GridSpec, width: u32, height: u32) -> Self {
        let scene = body_width_px(width);
        Self { width, ..Aim::default().orbit(spec, (scene, height)) }
    }

    /// The same direction, with the target and the distance that bring every corner of the grid into
    /// the picture, with a little room, and as large as can be.
    pub fn fitted(self, spec: &GridSpec) -> Self {
        self.fitted_to(spec, body_width_px(self.width))
    }

    /// The same where the scene is drawn `width` pixels wide.
    fn fitted_to(self, spec: &GridSpec, width: u32) -> Self {
        let [right, up, forward] = self.axes();
        let tan_half_width = TAN_HALF_VIEW * f64::from(width) / f64::from(self.height.max(1));
        let corners = corners(spec).map(|corner| corner - self.target);
        let side = fit(corners.map(|p| (p.dot(&right), p.dot(&forward))), tan_half_width);
        let rise = fit(corners.map(|p| (p.dot(&up), p.dot(&forward))), TAN_HALF_VIEW);
        Self {
            target: self.target + right * side.0 + up * rise.0,
            distance_m: side.1.max(rise.1) * 1.04,
            ..self
        }
    }

    /// Right, up and forward of the camera, of length 1, in the grid frame.
    fn axes(&self) -> [Vector3<f64>; 3] {
        let (sin_a, cos_a) = libm::sincos(self.azimuth_rad);
        let (sin_e, cos_e) = libm::sincos(self.elevation_rad);
        let right = Vector3::new(-sin_a, cos_a, 0.0);
        let forward = -Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e);
        [right, right.cross(&forward), forward]
    }

    /// The lens of a picture of this camera, of its own size.
    pub(crate) fn lens(&self) -> Lens {
        let [right, up, forward] = self.axes();
        let eye = self.target - forward * self.distance_m;
        Lens::new(eye, [right, up, forward], self.width, self.height)
    }
}

/// From which side a picture is taken.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// As that of an [`Orbit`].
    pub azimuth_rad: f64,
    /// As that of an [`Orbit`].
    pub elevation_rad: f64,
    /// How far from the grid's middle; if not told, so that the grid fills the picture.
    pub distance_m: Option<f64>,
}

impl Default for Aim {
    /// From behind and above, a little from the right.
    fn default() -> Self {
        let [azimuth_rad, elevation_rad] = [200.0_f64, 35.0].map(f64::to_radians);
        Self { azimuth_rad, elevation_rad, distance_m: None }
    }
}

impl Aim {
    /// The same, its azimuth counted from the ego's forward.
    pub(crate) fn at(&self, labels: &Painted, size: (u32, u32)) -> Orbit {
        let azimuth_rad = self.azimuth_rad + labels.heading_rad.unwrap_or(0.0);
        Self { azimuth_rad, ..*self }.orbit(labels.spec, size)
    }

    /// The camera of a picture of this size, without a legend.
    pub(crate) fn orbit(&self, spec: &GridSpec, (width, height): (u32, u32)) -> Orbit {
        let orbit = Orbit {
            target: nalgebra::center(&spec.min_m(), &spec.max_m()),
            azimuth_rad: self.azimuth_rad,
            elevation_rad: self.elevation_rad,
            distance_m: self.distance_m.unwrap_or(0.0),
            width,
            height,
        };
        if self.distance_m.is_some() { orbit } else { orbit.fitted_to(spec, width) }
    }
}

/// The corners of a grid.
fn corners(spec: &GridSpec) -> [Point3<f64>; 8] {
    let (low, high) = (spec.min_m(), spec.max_m());
    std::array::from_fn(|corner| {
        let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
        Point3::new(side(0), side(1), side(2))
    })
}

/// How far to move the target along one axis of the picture, and from how far to look, so that all
/// points (along that axis, forward) are just in view.
///
/// A point at `a` is in view from distance D if |a - shift| <= tan * (forward + D). So D has to be at
/// least `plus - shift / tan` and at least `minus + shift / tan`; it is least where both are equal.
fn fit(points: [(f64, f64); 8], tan: f64) -> (f64, f64) {
    let reach = |sign: f64| {
        let reaches = points.map(|(a, forward)| sign * a / tan - forward);
        reaches.into_iter().fold(f64::NEG_INFINITY, f64::max)
    };
    let (plus, minus) = (reach(1.0), reach(-1.0));
    (tan * (plus - minus) / 2.0, (plus + minus) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_fills_the_picture() {
        let spec = GridSpec::new([-40.0, -40.0, -1.0], [40.0, 40.0, 5.4], [0.4; 3]).unwrap();
        for (width, height) in [(500, 300), (500, 2000), (300, 200)] {
            let lens = Orbit::behind(&spec, width, height).lens();
            let at = corners(&spec).map(|corner| lens.project(&corner).unwrap());
            let low = at.iter().fold(at[0], |low, p| low.inf(p));
            let high = at.iter().fold(at[0], |high, p| high.sup(p));
            let (width, height) = (f64::from(width), f64::from(height));
            assert!(low.x > 0.0 && low.y > 0.0 && high.x < width && high.y < height);
            let share = ((high.x - low.x) / width).max((high.y - low.y) / height);
            assert!(share > 0.9, "{share} of {width} x {height}");
        }
    }

    #[test]
    fn azimuth_and_elevation_say_where_the_camera_stands() {
        let orbit = Orbit {
            target: Point3::new(1.0, 2.0, 3.0),
            azimuth_rad: std::f64::consts::FRAC_PI_2,
            elevation_rad: std::f64::consts::FRAC_PI_6,
            distance_m: 10.0,
            width: 200,
            height: 100,
        };
        let lens = orbit.lens();
        let eye = Point3::new(1.0, 2.0 + 10.0 * 0.75_f64.sqrt(), 3.0 + 5.0);
        assert!((lens.eye - eye).norm() < 1e-12);
        let ahead = lens.project(&Point3::new(2.0, 2.0, 3.0)).unwrap();
        assert!(ahead.x < 100.0, "from the left of the ego, ahead is left: {ahead}");
    }
}
