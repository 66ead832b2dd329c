//! A ratio that adds up.

use std::ops::AddAssign;

/// How many of how many, exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Share {
    /// Those that are so.
    pub(crate) right: u64,
    /// Those that were asked.
    pub(crate) of: u64,
}

impl Share {
    /// Asks one more.
    #[inline]
    pub(crate) fn count(&mut self, is_right: bool) {
        self.right += u64::from(is_right);
        self.of += 1;
    }

    /// The ratio, from 0 to 1; none if nothing was asked.
    pub(crate) fn ratio(self) -> Option<f64> {
        (self.of > 0).then(|| self.right as f64 / self.of as f64)
    }
}

impl AddAssign for Share {
    fn add_assign(&mut self, other: Self) {
        self.right += other.right;
        self.of += other.of;
    }
}

/// The mean of the ratios of those shares that were asked at all, in their order.
pub(crate) fn mean_ratio(shares: &[Share]) -> Option<f64> {
    let ratios: Vec<f64> = shares.iter().filter_map(|share| share.ratio()).collect();
    (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_share_has_no_ratio() {
        assert_eq!(Share::default().ratio(), None);
        assert_eq!(mean_ratio(&[Share::default()]), None);
    }

    #[test]
    fn a_mean_weighs_each_share_alike() {
        let shares = [Share { right: 1, of: 1 }, Share::default(), Share { right: 0, of: 99 }];
        assert_eq!(mean_ratio(&shares), Some(0.5));
    }
}
