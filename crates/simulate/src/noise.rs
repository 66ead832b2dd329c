//! Chance that depends on nothing but what it is asked about.
//!
//! Each ray draws from a hash of its own number, not from a stream that threads would share: any
//! number of threads gives the same noise.

use std::f64::consts::TAU;

use nalgebra::Vector3;

/// The chance of one ray, or of one thing that an annotator does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chance(u64);

/// What a chance is about, if not a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// A mover's box at a keyframe.
    Box,
    /// A keyframe.
    Keyframe,
    /// A mover, all its boxes.
    Mover,
    /// A lidar's mounting.
    Lidar,
    /// A camera's mounting.
    Camera,
    /// The drift of the ego's pose.
    Drift,
    /// A pixel of an exposure.
    Pixel,
    /// A mover's mesh at a keyframe.
    Mesh,
}

impl Chance {
    /// From all that tells one ray from another.
    pub(crate) fn new(seed: u64, lidar: usize, sweep: usize, ray: usize) -> Self {
        let numbers = [lidar as u64, sweep as u64, ray as u64];
        Self(numbers.into_iter().fold(mix(seed), |hash, number| mix(hash ^ number)))
    }

    /// From all that tells one thing of a kind from another; no lidar's number is that large.
    pub(crate) fn of(seed: u64, kind: Kind, first: usize, second: usize) -> Self {
        Self::new(seed, usize::MAX - kind as usize, first, second)
    }

    /// A number in [0, 1), another one for each `draw`.
    pub(crate) fn uniform(&self, draw: u64) -> f64 {
        (mix(self.0 ^ draw) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A normally distributed number of deviation 1, of draws 1 and 2.
    pub(crate) fn normal(&self) -> f64 {
        self.normal_of(0)
    }

    /// The same, another one for each number n, of draws 2n + 1 and 2n + 2 (Box & Muller 1958).
    pub(crate) fn normal_of(&self, n: u64) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.uniform(2 * n + 1))).sqrt();
        radius * libm::cos(TAU * self.uniform(2 * n + 2))
    }

    /// A unit vector, any as likely, of draws 2n + 1 and 2n + 2.
    pub(crate) fn direction(&self, n: u64) -> Vector3<f64> {
        let z = 2.0 * self.uniform(2 * n + 1) - 1.0;
        let (sin, cos) = libm::sincos(TAU * self.uniform(2 * n + 2));
        let across = (1.0 - z * z).sqrt();
        Vector3::new(across * cos, across * sin, z)
    }
}

/// One step of SplitMix64 (Steele, Lea & Flood 2014).
pub(crate) fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_is_level_and_normal() {
        let rays = 40_000;
        let chances = || (0..rays).map(|ray| Chance::new(7, 1, 2, ray));
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / rays as f64;
        let level = mean(&mut chances().map(|chance| chance.uniform(0)));
        let middle = mean(&mut chances().map(|chance| chance.normal()));
        let spread = mean(&mut chances().map(|chance| chance.normal() * chance.normal()));
        // Three standard errors: 0.29 / 200, 1 / 200, 1.41 / 200.
        assert!((level - 0.5).abs() < 0.0044, "{level}");
        assert!(middle.abs() < 0.015 && (spread - 1.0).abs() < 0.022, "{middle} {spread}");
    }

    #[test]
    fn directions_are_unit_and_lean_nowhere() {
        let of = |at| Chance::of(7, Kind::Box, at, 0).direction(0);
        assert!((0..10_000).all(|at| (of(at).norm() - 1.0).abs() < 1e-12));
        let mean = (0..10_000).map(of).sum::<Vector3<f64>>() / 1e4;
        // Four standard errors of an axis: 4 / sqrt(3) / 100.
        assert!(mean.amax() < 0.0231, "{mean}");
    }

    #[test]
    fn every_number_of_a_ray_matters() {
        let drawn = |seed, lidar, sweep, ray| Chance::new(seed, lidar, sweep, ray).uniform(0);
        let all = [drawn(1, 0, 0, 0), drawn(0, 1, 0, 0), drawn(0, 0, 1, 0), drawn(0, 0, 0, 1)];
        assert!((1..4).all(|at| !all[..at].contains(&all[at])), "{all:?}");
    }
}
