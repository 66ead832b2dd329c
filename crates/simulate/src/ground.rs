//! The ground: a solid without end below a surface of planes and kerbs.
//!
//! ```text
//!   z = height_m + slope . (x, y) + profile(x) + raise_m of the band of y
//!
//!                   +--- sidewalk ---   profile    __/--- (flat beyond its ends)
//!    ---- road -----+ kerb                     ___/
//!    ------------------------------ y        ------------- x
//! ```
//!
//! Kerbs are upright and everything else is planes, so that a ray meets it in closed form.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use occlabel_core::{Fault, Pose};
use serde::Deserialize;

use crate::check::{angles, each, metres, need};
use crate::rotation::yaw_pitch_roll;
use crate::trajectory::Place;
use crate::{Impact, Ray};

/// A step between two pieces of ground that is smaller is rounding, metres.
const LEAST_KERB_M: f64 = 1e-9;

/// The `[ground]` of a world, checked.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// Height at the world's origin, before profile and bands.
    #[serde(default)]
    pub height_m: f64,
    /// Rise per metre along x and along y.
    #[serde(default)]
    pub slope: [f64; 2],
    /// Places along x and the height added there, x rising; straight between them.
    #[serde(default)]
    pub profile_m: Vec<[f64; 2]>,
    /// Classes along y, from -infinity on; the last one reaches to +infinity.
    pub bands: Vec<Band>,
}

/// A strip of ground along x.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Band {
    /// The y at which the next band begins; left out in the last one only.
    #[serde(default = "endless")]
    pub until_y_m: f64,
    /// What it is made of, a raw point label of the taxonomy.
    pub class: String,
    /// Height added to the band.
    #[serde(default)]
    pub raise_m: f64,
}

fn endless() -> f64 {
    f64::INFINITY
}

/// A piece of the surface: `z = level_m + slope . (x, y)`.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    level_m: f64,
    slope: [f64; 2],
}

impl Plane {
    /// How far a point is above it, along z.
    pub(crate) fn gap_m(&self, p: &Point3<f64>) -> f64 {
        p.z - (self.level_m + self.slope[0] * p.x + self.slope[1] * p.y)
    }

    /// Upwards.
    pub(crate) fn normal(&self) -> Vector3<f64> {
        Vector3::new(-self.slope[0], -self.slope[1], 1.0).normalize()
    }
}

impl Ground {
    /// Where a ray first is in the ground, at most `max_m` away, and the number of the band.
    pub fn cast(&self, ray: &Ray, max_m: f64) -> Option<(Impact, usize)> {
        let ends = self.pieces(ray, max_m);
        ends.windows(2).find_map(|piece| {
            let middle = ray.at((piece[0] + piece[1]) / 2.0);
            let band = self.band(middle.y);
            Some((meet(ray, piece[0], piece[1], &self.plane(middle.x, band))?, band))
        })
    }

    /// The band of a place, if the place is in the ground or on its surface.
    pub fn contains(&self, p: &Point3<f64>) -> Option<usize> {
        let band = self.band(p.y);
        (self.plane(p.x, band).gap_m(p) <= 0.0).then_some(band)
    }

    /// The band and the plane over or under which a point is.
    pub(crate) fn piece(&self, p: &Point3<f64>) -> (usize, Plane) {
        let band = self.band(p.y);
        (band, self.plane(p.x, band))
    }

    /// How far, on the map, the border of that piece is.
    pub(crate) fn border_m(&self, p: &Point3<f64>) -> f64 {
        let band = self.bands.partition_point(|band| band.until_y_m <= p.y);
        let fold = self.profile_m.partition_point(|point| point[0] <= p.x);
        let kerbs = [band.checked_sub(1), Some(band)]
            .map(|at| at.and_then(|at| self.bands.get(at)).map(|band| band.until_y_m - p.y));
        let folds = [fold.checked_sub(1), Some(fold)]
            .map(|at| at.and_then(|at| self.profile_m.get(at)).map(|point| point[0] - p.x));
        kerbs.into_iter().chain(folds).flatten().map(f64::abs).fold(f64::INFINITY, f64::min)
    }

    /// Height of the ground at a place, without what bands add, metres.
    pub fn terrain_m(&self, x_m: f64, y_m: f64) -> f64 {
        -self.plane_of(x_m, 0.0).gap_m(&Point3::new(x_m, y_m, 0.0))
    }

    /// Height of the ground's surface at a place, bands and all, metres.
    pub fn surface_m(&self, x_m: f64, y_m: f64) -> f64 {
        self.terrain_m(x_m, y_m) + self.bands[self.band(y_m)].raise_m
    }

    /// The pose of something that stands on the terrain, at the middle between its four feet, which
    /// are `reach_m` ahead, behind, to the left and to the right.
    pub(crate) fn stand(&self, place: &Place, reach_m: [f64; 2]) -> Pose {
        let foot = |ahead: f64, left: f64| {
            let (sin, cos) = libm::sincos(place.yaw_rad);
            let (x, y) = (ahead * cos - left * sin, ahead * sin + left * cos);
            self.terrain_m(place.x_m + x, place.y_m + y)
        };
        let [ahead, aside] = reach_m;
        let feet = [foot(ahead, 0.0), foot(-ahead, 0.0), foot(0.0, aside), foot(0.0, -aside)];
        let pitch = -libm::atan2(feet[0] - feet[1], 2.0 * ahead);
        let roll = libm::atan2((feet[2] - feet[3]) * libm::cos(pitch), 2.0 * aside);
        let rotation: UnitQuaternion<f64> = yaw_pitch_roll(place.yaw_rad, pitch, roll);
        let z_m = feet.iter().sum::<f64>() / 4.0;
        Pose::from_parts(Translation3::new(place.x_m, place.y_m, z_m), rotation)
    }

    /// Distances between which a ray stays over one plane: 0, the borders it crosses, `max_m`.
    fn pieces(&self, ray: &Ray, max_m: f64) -> Vec<f64> {
        let along = |axis: usize, at: f64| (at - ray.origin[axis]) / ray.direction[axis];
        let kerbs = self.bands.iter().map(|band| along(1, band.until_y_m));
        let folds = self.profile_m.iter().map(|&[x, _]| along(0, x));
        let crossed = kerbs.chain(folds).filter(|&t| t > 0.0 && t < max_m);
        let mut ends: Vec<f64> = crossed.chain([0.0, max_m]).collect();
        ends.sort_by(f64::total_cmp);
        ends
    }

    fn band(&self, y_m: f64) -> usize {
        self.bands.partition_point(|band| band.until_y_m <= y_m).min(self.bands.len() - 1)
    }

    /// The plane of a band over x.
    pub(crate) fn plane(&self, x_m: f64, band: usize) -> Plane {
        self.plane_of(x_m, self.bands[band].raise_m)
    }

    fn plane_of(&self, x_m: f64, raise_m: f64) -> Plane {
        let (at_zero_m, rise) = self.profile_line(x_m);
        let level_m = self.height_m + raise_m + at_zero_m;
        Plane { level_m, slope: [self.slope[0] + rise, self.slope[1]] }
    }

    /// The straight line of the profile at x: its height at x = 0 and its rise per metre.
    fn profile_line(&self, x_m: f64) -> (f64, f64) {
        let next = self.profile_m.partition_point(|point| point[0] <= x_m);
        match (next.checked_sub(1).map(|at| self.profile_m[at]), self.profile_m.get(next).copied())
        {
            (Some([xa, za]), Some([xb, zb])) => {
                let rise = (zb - za) / (xb - xa);
                (za - rise * xa, rise)
            }
            (Some([_, z]), None) | (None, Some([_, z])) => (z, 0.0),
            (None, None) => (0.0, 0.0),
        }
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        metres("height_m", &[self.height_m])?;
        angles("slope", &self.slope)?;
        metres("profile_m", self.profile_m.as_flattened())?;
        let rises = self.profile_m.windows(2).all(|pair| pair[1][0] - pair[0][0] > 1e-6);
        need("profile_m", rises, "x rising from point to point", "x that does not rise")?;
        each("bands", &self.bands, |band| metres("raise_m", &[band.raise_m]))?;
        let in_order = self.bands.windows(2).all(|pair| pair[0].until_y_m < pair[1].until_y_m);
        let Some((last, others)) = self.bands.split_last() else {
            return need("bands", false, "at least one band", "none");
        };
        let is_endless = last.until_y_m == f64::INFINITY;
        need("bands", is_endless, "a last band without until_y_m", last.until_y_m)?;
        need("bands", in_order, "until_y_m rising from band to band", "one that does not rise")?;
        each("bands", others, |band| metres("until_y_m", &[band.until_y_m])).map(|_| ())
    }
}

/// Where a ray goes into the ground between two distances, over one plane.
fn meet(ray: &Ray, from_m: f64, to_m: f64, plane: &Plane) -> Option<Impact> {
    let [first, last] = [from_m, to_m].map(|at| plane.gap_m(&ray.at(at)));
    if first <= 0.0 {
        let kerb = Vector3::new(0.0, -ray.direction.y.signum(), 0.0);
        let normal = if first < -LEAST_KERB_M { kerb } else { plane.normal() };
        let met = Impact { distance_m: from_m, normal };
        return Some(if from_m > 0.0 { met } else { Impact::inside(ray) });
    }
    let distance_m = from_m + (to_m - from_m) * first / (first - last);
    (last <= 0.0).then(|| Impact { distance_m, normal: plane.normal() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn street() -> Ground {
        let band =
            |until_y_m, class: &str, raise_m| Band { until_y_m, class: class.into(), raise_m };
        Ground {
            height_m: 0.5,
            slope: [0.0, 0.0],
            profile_m: vec![[10.0, 0.0], [20.0, 1.0], [30.0, 1.0]],
            bands: vec![band(4.0, "road", 0.0), band(f64::INFINITY, "sidewalk", 0.2)],
        }
    }

    #[track_caller]
    fn assert_met(origin: [f64; 3], way: [f64; 3], at_m: [f64; 3], normal: [f64; 3], band: usize) {
        let ray = Ray { origin: origin.into(), direction: Vector3::from(way).normalize() };
        let (met, found) = street().cast(&ray, 200.0).expect("ground");
        assert!((ray.at(met.distance_m) - Point3::from(at_m)).norm() < 1e-9, "{met:?}");
        assert!((met.normal - Vector3::from(normal).normalize()).norm() < 1e-9, "{met:?}");
        assert_eq!(found, band);
    }

    #[test]
    fn rays_meet_road_kerb_sidewalk_and_slope() {
        let up = [0.0, 0.0, 1.0];
        assert_met([0.0, 0.0, 1.5], [1.0, 0.5, -0.5], [2.0, 1.0, 0.5], up, 0);
        assert_met([0.0, 0.0, 0.6], [0.0, 1.0, 0.0], [0.0, 4.0, 0.6], [0.0, -1.0, 0.0], 1);
        assert_met([0.0, 6.0, 1.7], [1.0, 0.0, -1.0], [1.0, 6.0, 0.7], up, 1);
        assert_met([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [15.0, 0.0, 1.0], [-0.1, 0.0, 1.0], 0);
        assert_met([40.0, 0.0, 3.0], [-1.0, 0.0, -0.1], [25.0, 0.0, 1.5], up, 0);
    }

    #[test]
    fn rays_above_and_rays_from_below() {
        let cast = |z: f64, way: Vector3<f64>| {
            street().cast(&Ray { origin: Point3::new(0.0, 0.0, z), direction: way }, 200.0)
        };
        assert!(cast(3.0, Vector3::x()).is_none());
        assert!(cast(3.0, Vector3::z()).is_none());
        assert_eq!(cast(0.4, Vector3::z()).unwrap().0.distance_m, 0.0);
    }

    #[test]
    fn the_ground_is_solid_below_its_surface() {
        let at = |x, y, z| street().contains(&Point3::new(x, y, z));
        assert_eq!((at(0.0, 0.0, 0.49), at(0.0, 0.0, 0.51)), (Some(0), None));
        assert_eq!((at(0.0, 5.0, 0.69), at(0.0, 5.0, 0.71)), (Some(1), None));
        assert_eq!((at(15.0, 0.0, 0.99), at(15.0, 0.0, 1.01)), (Some(0), None));
    }

    #[test]
    fn things_stand_along_the_slope() {
        let place = Place { x_m: 15.0, y_m: 0.0, yaw_rad: 0.0 };
        let pose = street().stand(&place, [1.0, 0.5]);
        let ahead = pose * Vector3::x();
        assert!((ahead.z / ahead.x - 0.1).abs() < 1e-12, "{ahead:?}");
        let aside =
            street().stand(&Place { yaw_rad: std::f64::consts::FRAC_PI_2, ..place }, [1.0, 0.5]);
        let up = aside * Vector3::z();
        assert!((up - Vector3::new(-0.1, 0.0, 1.0).normalize()).norm() < 1e-9, "{up:?}");
    }
}
