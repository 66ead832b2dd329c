//! Where a lidar's rays go, and when.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use occlabel_core::Fault;
use serde::Deserialize;

use crate::check::{need, within};

/// More rays than this in one sweep are refused.
const MOST_RAYS: usize = 1 << 24;
/// Lasers of a rosette that fire at once.
const ROSETTE_LASERS: usize = 4;
/// Turns of a rosette's mirror in a sweep: 20, and a bit that no number of sweeps makes whole (the
/// golden ratio's fraction), so that no sweep repeats another.
const ROSETTE_TURNS: f64 = 20.618_033_988_749_895;
/// Nods of a rosette's prism in a sweep, out of step with its turns alike (the root of 2).
const ROSETTE_NODS: f64 = 282.414_213_562_373_1;

/// The rays of one sweep. Rays that fire at once form a shot; shots are evenly spread in time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Pattern {
    /// Beams one above the other that turn once a sweep, counter-clockwise from the x axis.
    Spinning {
        /// How the beams stand.
        beams: Beams,
        /// Shots per revolution. They stand 0.3 steps off the axes, so that no ray runs in a plane
        /// of voxel faces.
        azimuths: usize,
    },
    /// A pattern that never repeats, as of Livox' MID360: four lasers a quarter turn apart nod up
    /// and down as they turn.
    Rosette {
        /// Shots per sweep, of four rays each.
        shots: usize,
        /// Lowest elevation, radians above the xy plane.
        min_rad: f64,
        /// Highest elevation.
        max_rad: f64,
    },
}

/// Elevations of beams, radians above the xy plane.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Beams {
    /// One by one, ring 0 first.
    ElevationsRad(Vec<f64>),
    /// Evenly spread.
    Even {
        /// How many, at least 2.
        count: usize,
        /// Elevation of ring 0.
        min_rad: f64,
        /// Elevation of the last ring.
        max_rad: f64,
    },
}

impl Beams {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::ElevationsRad(list) => list.len(),
            Self::Even { count, .. } => *count,
        }
    }

    fn elevation_rad(&self, ring: usize) -> f64 {
        match *self {
            Self::ElevationsRad(ref list) => list[ring],
            Self::Even { count, min_rad, max_rad } => {
                min_rad + (max_rad - min_rad) * ring as f64 / (count - 1) as f64
            }
        }
    }
}

impl Pattern {
    /// How many shots a sweep has.
    pub fn shots(&self) -> usize {
        match self {
            Self::Spinning { azimuths, .. } => *azimuths,
            Self::Rosette { shots, .. } => *shots,
        }
    }

    /// How many rays a shot has; a ray's place in its shot is its ring.
    pub fn rings(&self) -> usize {
        match self {
            Self::Spinning { beams, .. } => beams.count(),
            Self::Rosette { .. } => ROSETTE_LASERS,
        }
    }

    /// Unit direction of a ray in the lidar's frame.
    pub fn direction(&self, sweep: usize, shot: usize, ring: usize) -> Vector3<f64> {
        match self {
            Self::Spinning { beams, azimuths } => {
                let azimuth_rad = TAU * (shot as f64 + 0.3) / *azimuths as f64;
                towards(azimuth_rad, beams.elevation_rad(ring))
            }
            Self::Rosette { shots, min_rad, max_rad } => {
                let sweeps = sweep as f64 + shot as f64 / *shots as f64;
                let quarter = ring as f64 / ROSETTE_LASERS as f64;
                let nod = libm::sin(TAU * (sweeps * ROSETTE_NODS + quarter).fract());
                let elevation_rad = min_rad + (max_rad - min_rad) * (nod + 1.0) / 2.0;
                towards(TAU * (sweeps * ROSETTE_TURNS + quarter).fract(), elevation_rad)
            }
        }
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        let (shots, rings) = (self.shots(), self.rings());
        let rays = shots.saturating_mul(rings);
        need("rays", (1..=MOST_RAYS).contains(&rays), "1 to 2^24 rays a sweep", rays)?;
        let steep = TAU / 4.0;
        let elevation = |key: &str, value: &f64| within(key, *value, -steep, steep);
        match self {
            Self::Spinning { beams: Beams::ElevationsRad(list), .. } => {
                list.iter().try_for_each(|value| elevation("spinning.beams.elevations-rad", value))
            }
            Self::Spinning { beams: Beams::Even { count, min_rad, max_rad }, .. } => {
                need("spinning.beams.even.count", *count >= 2, "at least 2", count)?;
                elevation("spinning.beams.even.min_rad", min_rad)?;
                elevation("spinning.beams.even.max_rad", max_rad)
            }
            Self::Rosette { min_rad, max_rad, .. } => {
                elevation("rosette.min_rad", min_rad)?;
                elevation("rosette.max_rad", max_rad)
            }
        }
    }
}

fn towards(azimuth_rad: f64, elevation_rad: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(azimuth_rad);
    let (up, out) = libm::sincos(elevation_rad);
    Vector3::new(out * cos, out * sin, up)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beams_span_the_elevations_and_azimuths_the_turn() {
        let beams = Beams::Even { count: 5, min_rad: -0.4, max_rad: 0.2 };
        let pattern = Pattern::Spinning { beams, azimuths: 8 };
        for (ring, expected) in [(0, -0.4), (2, -0.1), (4, 0.2)] {
            let found = libm::asin(pattern.direction(3, 5, ring).z);
            assert!((found - expected).abs() < 1e-12, "{found}");
        }
        let quarter = pattern.direction(0, 2, 2).xy().perp(&pattern.direction(0, 4, 2).xy());
        assert!((quarter - libm::cos(0.1) * libm::cos(0.1)).abs() < 1e-12, "{quarter}");
    }

    #[test]
    fn a_rosette_stays_in_its_band_and_never_repeats() {
        let pattern = Pattern::Rosette { shots: 500, min_rad: -0.12, max_rad: 0.9 };
        let sweep = |k| (0..500).map(|shot| pattern.direction(k, shot, 0)).collect::<Vec<_>>();
        let (first, second) = (sweep(0), sweep(1));
        let elevations: Vec<f64> = first.iter().map(|ray| libm::asin(ray.z)).collect();
        assert!(elevations.iter().all(|e| (-0.12 - 1e-9..=0.9 + 1e-9).contains(e)));
        let near = |ray: &Vector3<f64>| first.iter().any(|known| (known - ray).norm() < 1e-4);
        assert_eq!(second.iter().filter(|ray| near(ray)).count(), 0);
    }
}
