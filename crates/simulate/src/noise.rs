//! Chance that depends on nothing but what it is asked about.
//!
//! Each ray draws from a hash of its own number, not from a stream that threads would share: any
//! number of threads gives the same noise.

use std::f64::consts::TAU;

/// The chance of one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chance(u64);

impl Chance {
    /// From all that tells one ray from another.
    pub(crate) fn new(seed: u64, lidar: usize, sweep: usize, ray: usize) -> Self {
        let numbers = [lidar as u64, sweep as u64, ray as u64];
        Self(numbers.into_iter().fold(mix(seed), |hash, number| mix(hash ^ number)))
    }

    /// A number in [0, 1), another one for each `draw`.
    pub(crate) fn uniform(&self, draw: u64) -> f64 {
        (mix(self.0 ^ draw) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A normally distributed number of deviation 1 (Box & Muller 1958), of draws 1 and 2.
    pub(crate) fn normal(&self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.uniform(1))).sqrt();
        radius * libm::cos(TAU * self.uniform(2))
    }
}

/// One step of SplitMix64 (Steele, Lea & Flood 2014).
fn mix(state: u64) -> u64 {
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
    fn every_number_of_a_ray_matters() {
        let drawn = |seed, lidar, sweep, ray| Chance::new(seed, lidar, sweep, ray).uniform(0);
        let all = [drawn(1, 0, 0, 0), drawn(0, 1, 0, 0), drawn(0, 0, 1, 0), drawn(0, 0, 0, 1)];
        assert!((1..4).all(|at| !all[..at].contains(&all[at])), "{all:?}");
    }
}
