//! Depth errors, summed so that the order of rays does not show.

use std::collections::BTreeMap;

/// Width of a bin of errors, metres: percentiles are known to half of it.
const BIN_M: f64 = 0.01;

/// Absolute depth errors of rays.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DepthErrors {
    rays: u64,
    sum_um: u64,
    /// How many errors fall into each bin.
    bins: BTreeMap<u32, u64>,
}

impl DepthErrors {
    /// Adds a ray that is wrong by so many metres.
    pub fn add(&mut self, error_m: f64) {
        self.rays += 1;
        self.sum_um += (error_m * 1e6).round() as u64;
        *self.bins.entry((error_m / BIN_M) as u32).or_default() += 1;
    }

    /// How many rays there are.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// The mean error, metres.
    pub fn mean_m(&self) -> Option<f64> {
        (self.rays > 0).then(|| self.sum_um as f64 / 1e6 / self.rays as f64)
    }

    /// The error that `percent` of the rays do not exceed, to half a centimetre, metres.
    pub fn percentile_m(&self, percent: u64) -> Option<f64> {
        let wanted = (self.rays * percent).div_ceil(100).max(1);
        let mut seen = 0;
        let bin = self.bins.iter().find(|(_, rays)| {
            seen += **rays;
            seen >= wanted
        });
        bin.map(|(bin, _)| (f64::from(*bin) + 0.5) * BIN_M)
    }
}

impl std::ops::AddAssign<&Self> for DepthErrors {
    fn add_assign(&mut self, other: &Self) {
        self.rays += other.rays;
        self.sum_um += other.sum_um;
        for (bin, rays) in &other.bins {
            *self.bins.entry(*bin).or_default() += rays;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_percentiles_of_known_errors() {
        let mut errors = DepthErrors::default();
        assert_eq!((errors.mean_m(), errors.percentile_m(50)), (None, None));
        (0..100).for_each(|cm| errors.add(f64::from(cm) / 100.0 + 0.002));
        assert!((errors.mean_m().unwrap() - 0.497).abs() < 1e-9);
        assert!((errors.percentile_m(50).unwrap() - 0.495).abs() < 1e-9);
        assert!((errors.percentile_m(95).unwrap() - 0.945).abs() < 1e-9);
    }

    #[test]
    fn sums_do_not_show_their_order() {
        let (mut a, mut b) = (DepthErrors::default(), DepthErrors::default());
        [0.3, 0.1].into_iter().for_each(|error| a.add(error));
        [0.2, 9.0].into_iter().for_each(|error| b.add(error));
        let (mut ab, mut ba) = (a.clone(), b.clone());
        ab += &b;
        ba += &a;
        assert_eq!(ab, ba);
        assert_eq!((ab.rays(), ab.mean_m()), (4, Some(2.4)));
    }
}
