//! The rays of a lidar that never was: every pitch at every azimuth.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;
use occlabel_core::Fault;

/// As many pitches as a word has bits.
pub(super) const MOST_PITCHES: usize = 64;
/// Pitches downwards whose tangents are 1, 1/2, ... 1/10.
const STEEP_PITCHES: u32 = 10;
/// Pitches are added until one is not below this, rad.
const HIGHEST_PITCH_RAD: f64 = 0.21;
/// Azimuths of the published set, a degree apart.
const AZIMUTHS: u32 = 360;

/// Directions that are cast from every origin: all pairs of a pitch and an azimuth.
///
/// ```text
///   x = cos(pitch) cos(azimuth)     z up
///   y = cos(pitch) sin(azimuth)     azimuth from x towards y
///   z = sin(pitch)
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// Sine and cosine, from the lowest pitch to the highest.
    pitches: Vec<[f64; 2]>,
    /// Sine and cosine.
    azimuths: Vec<[f64; 2]>,
}

impl RaySet {
    /// The 39 pitches and 360 azimuths of RayIoU: 14 040 rays, from 45 degrees down to 12.4 up.
    ///
    /// After the steep ones, pitches go on by the last difference.
    pub fn published() -> Self {
        let mut pitches_rad: Vec<f64> =
            (1..=STEEP_PITCHES).map(|k| -(FRAC_PI_2 - libm::atan(f64::from(k)))).collect();
        while let [.., before, last] = pitches_rad[..]
            && last < HIGHEST_PITCH_RAD
        {
            pitches_rad.push(last + (last - before));
        }
        let azimuths_rad = (0..AZIMUTHS).map(|degrees| f64::from(degrees) * (PI / 180.0));
        Self::of(&pitches_rad, azimuths_rad)
    }

    /// A set of pitches in ascending order, and azimuths, rad.
    ///
    /// # Errors
    /// If there are more than 64 pitches, one is not above the one before it or beyond straight down
    /// or up, or an azimuth is not finite.
    pub fn new(pitches_rad: &[f64], azimuths_rad: &[f64]) -> Result<Self, Fault> {
        let fault = |expected: &str, found| Err(Fault::new("ray-set", "rays", expected, found));
        if pitches_rad.len() > MOST_PITCHES {
            return fault("at most 64 pitches", format!("{}", pitches_rad.len()));
        }
        let is_pitch = |pitch: &f64| pitch.abs() <= FRAC_PI_2;
        if !(pitches_rad.iter().all(is_pitch) && pitches_rad.is_sorted_by(|a, b| a < b)) {
            let expected = "ascending pitches from -pi/2 to pi/2 rad";
            return fault(expected, format!("{pitches_rad:?}"));
        }
        match azimuths_rad.iter().find(|azimuth| !azimuth.is_finite()) {
            Some(strange) => fault("finite azimuths", format!("{strange} rad")),
            None => Ok(Self::of(pitches_rad, azimuths_rad.iter().copied())),
        }
    }

    fn of(pitches_rad: &[f64], azimuths_rad: impl Iterator<Item = f64>) -> Self {
        let sine_cosine = |angle_rad: f64| [libm::sin(angle_rad), libm::cos(angle_rad)];
        Self {
            pitches: pitches_rad.iter().map(|pitch| sine_cosine(*pitch)).collect(),
            azimuths: azimuths_rad.map(sine_cosine).collect(),
        }
    }

    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.pitches.len() * self.azimuths.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All directions of unit length: the azimuths of the lowest pitch first.
    pub fn directions(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let azimuths = 0..self.azimuths.len();
        let row = move |pitch| azimuths.clone().map(move |azimuth| self.direction(pitch, azimuth));
        (0..self.pitches.len()).flat_map(row)
    }

    /// The direction of a pitch and an azimuth, of unit length.
    #[inline]
    pub(super) fn direction(&self, pitch: usize, azimuth: usize) -> Vector3<f64> {
        let ([up, level], [y, x]) = (self.pitches[pitch], self.azimuths[azimuth]);
        Vector3::new(level * x, level * y, up)
    }

    /// Sine and cosine of every pitch, ascending.
    pub(super) fn pitches(&self) -> &[[f64; 2]] {
        &self.pitches
    }

    /// Sine and cosine of every azimuth.
    pub(super) fn azimuths(&self) -> &[[f64; 2]] {
        &self.azimuths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_set_has_39_pitches_and_14_040_rays() {
        let set = RaySet::published();
        assert_eq!((set.pitches.len(), set.azimuths.len(), set.len()), (39, 360, 14_040));
        assert_eq!(set.directions().count(), 14_040);
        assert!(set.directions().all(|d| (d.norm() - 1.0).abs() < 1e-15));
        let tangents = set.pitches[..10].iter().zip(1..);
        assert!(
            tangents
                .clone()
                .all(|([up, level], k)| (up / level * f64::from(k) + 1.0).abs() < 1e-14)
        );
        let pitches: Vec<f64> = set.pitches.iter().map(|[up, _]| libm::asin(*up)).collect();
        assert!(pitches[9..].windows(2).all(|two| (two[1] - two[0] - 0.010_989).abs() < 1e-6));
        assert!(pitches[37] < 0.21 && pitches[38] >= 0.21, "{:?}", &pitches[37..]);
    }

    #[test]
    fn strange_sets_are_faults() {
        assert!(RaySet::new(&[-0.1, 0.2], &[0.0, 7.0]).is_ok());
        for pitches in [&[0.1, 0.1][..], &[0.2, 0.1], &[f64::NAN], &[2.0], &[0.0; 65]] {
            assert_eq!(RaySet::new(pitches, &[0.0]).unwrap_err().rule, "ray-set");
        }
        assert!(RaySet::new(&[0.0], &[f64::INFINITY]).is_err());
    }
}
