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
        /// So many times more shots, and beams between the beams: see [`Pattern::denser`].
        #[serde(default = "once")]
        density: usize,
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
        /// The square of it times more shots: see [`Pattern::denser`].
        #[serde(default = "once")]
        density: usize,
    },
}

fn once() -> usize {
    1
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
    /// How many are given.
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

    /// Elevation of a ring of a denser pattern: every `density`-th is a given beam.
    fn dense_elevation_rad(&self, ring: usize, density: usize) -> f64 {
        let (beam, between) = (ring / density, ring % density);
        let below_rad = self.elevation_rad(beam);
        if between == 0 {
            return below_rad;
        }
        let step_rad = self.elevation_rad(beam + 1) - below_rad;
        below_rad + step_rad * between as f64 / density as f64
    }
}

impl Pattern {
    /// The pattern with `factor` times its density: it holds all its rays and, evenly between
    /// them, about the square of the factor times as many. Ring r becomes ring `factor * r`, shot
    /// s shot `factor * s` (of a rosette the factor's square times s).
    pub fn denser(&self, factor: usize) -> Self {
        let mut denser = self.clone();
        match &mut denser {
            Self::Spinning { density, .. } | Self::Rosette { density, .. } => *density *= factor,
        }
        denser
    }

    /// How many shots a sweep has.
    pub fn shots(&self) -> usize {
        match *self {
            Self::Spinning { azimuths, density, .. } => azimuths.saturating_mul(density),
            Self::Rosette { shots, density, .. } => {
                shots.saturating_mul(density.saturating_mul(density))
            }
        }
    }

    /// How many rays a shot has; a ray's place in its shot is its ring.
    pub fn rings(&self) -> usize {
        match self {
            Self::Spinning { beams, density, .. } => {
                beams.count().saturating_sub(1).saturating_mul(*density) + beams.count().min(1)
            }
            Self::Rosette { .. } => ROSETTE_LASERS,
        }
    }

    /// Unit direction of a ray in the lidar's frame.
    pub fn direction(&self, sweep: usize, shot: usize, ring: usize) -> Vector3<f64> {
        match *self {
            Self::Spinning { ref beams, azimuths, density } => {
                let step = shot as f64 / density as f64;
                let azimuth_rad = TAU * (step + 0.3) / azimuths as f64;
                towards(azimuth_rad, beams.dense_elevation_rad(ring, density))
            }
            Self::Rosette { min_rad, max_rad, .. } => {
                let sweeps = sweep as f64 + shot as f64 / self.shots() as f64;
                let quarter = ring as f64 / ROSETTE_LASERS as f64;
                let nod = libm::sin(TAU * (sweeps * ROSETTE_NODS + quarter).fract());
                let elevation_rad = min_rad + (max_rad - min_rad) * (nod + 1.0) / 2.0;
                towards(TAU * (sweeps * ROSETTE_TURNS + quarter).fract(), elevation_rad)
            }
        }
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        let (Self::Spinning { density, .. } | Self::Rosette { density, .. }) = self;
        need("density", *density >= 1, "at least 1", density)?;
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
        let pattern = Pattern::Spinning { beams, azimuths: 8, density: 1 };
        for (ring, expected) in [(0, -0.4), (2, -0.1), (4, 0.2)] {
            let found = libm::asin(pattern.direction(3, 5, ring).z);
            assert!((found - expected).abs() < 1e-12, "{found}");
        }
        let quarter = pattern.direction(0, 2, 2).xy().perp(&pattern.direction(0, 4, 2).xy());
        assert!((quarter - libm::cos(0.1) * libm::cos(0.1)).abs() < 1e-12, "{quarter}");
    }

    #[test]
    fn a_rosette_stays_in_its_band_and_never_repeats() {
        let pattern = Pattern::Rosette { shots: 500, min_rad: -0.12, max_rad: 0.9, density: 1 };
        let sweep = |k| (0..500).map(|shot| pattern.direction(k, shot, 0)).collect::<Vec<_>>();
        let (first, second) = (sweep(0), sweep(1));
        let elevations: Vec<f64> = first.iter().map(|ray| libm::asin(ray.z)).collect();
        assert!(elevations.iter().all(|e| (-0.12 - 1e-9..=0.9 + 1e-9).contains(e)));
        let near = |ray: &Vector3<f64>| first.iter().any(|known| (known - ray).norm() < 1e-4);
        assert_eq!(second.iter().filter(|ray| near(ray)).count(), 0);
    }

    #[test]
    fn a_denser_pattern_holds_the_rays_of_the_sparser_one() {
        let uneven = Beams::ElevationsRad(vec![-0.5, -0.2, -0.1, 0.3]);
        let even = Beams::Even { count: 5, min_rad: -0.4, max_rad: 0.2 };
        let spinning = |beams| Pattern::Spinning { beams, azimuths: 7, density: 1 };
        let rosette = Pattern::Rosette { shots: 50, min_rad: -0.1, max_rad: 0.9, density: 1 };
        for (pattern, shots, rings) in
            [(spinning(uneven), 3, 3), (spinning(even), 3, 3), (rosette, 9, 1)]
        {
            let dense = pattern.denser(3);
            assert_eq!(dense.shots(), shots * pattern.shots());
            assert_eq!(dense.rings(), rings * (pattern.rings() - 1) + 1);
            for (shot, ring) in (0..pattern.shots() * pattern.rings())
                .map(|ray| (ray / pattern.rings(), ray % pattern.rings()))
            {
                let off = pattern.direction(4, shot, ring)
                    - dense.direction(4, shots * shot, rings * ring);
                assert!(off.norm() < 1e-9, "{pattern:?} {shot} {ring}: {off:?}");
            }
        }
        let beam =
            Pattern::Spinning { beams: Beams::ElevationsRad(vec![0.1]), azimuths: 4, density: 2 };
        assert_eq!((beam.rings(), beam.shots()), (1, 8));
    }
}
