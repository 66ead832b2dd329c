//! A mean that does not depend on the order of its terms.

use std::ops::AddAssign;

use crate::exact_sum::ExactSum;

/// A sum of numbers, and how many there were; the same in any order of adding.
///
/// Terms are 0 or more, and the sum below 2^64: shares, metres and metres per second are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ExactMean {
    total: ExactSum,
    count: u64,
}

impl ExactMean {
    /// Adds a term.
    #[inline]
    pub(crate) fn add(&mut self, term: f64) {
        self.total.add(term);
        self.count += 1;
    }

    /// How many terms there were.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Their sum.
    pub(crate) fn sum(&self) -> f64 {
        self.total.value()
    }

    /// Their mean; none without terms.
    pub(crate) fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum() / self.count as f64)
    }
}

impl AddAssign for ExactMean {
    fn add_assign(&mut self, other: Self) {
        self.total += other.total;
        self.count += other.count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_terms_does_not_matter() {
        let terms: Vec<f64> = (1..2000).map(|i| 1.0 / f64::from(i)).collect();
        let (mut forth, mut back) = (ExactMean::default(), ExactMean::default());
        terms.iter().for_each(|term| forth.add(*term));
        terms.iter().rev().for_each(|term| back.add(*term));
        assert_eq!(forth, back);
        assert_ne!(terms.iter().sum::<f64>(), terms.iter().rev().sum::<f64>(), "floats differ");
        let exact = terms.iter().rev().sum::<f64>() / terms.len() as f64;
        assert!((forth.mean().unwrap() - exact).abs() < 1e-15);
    }

    #[test]
    fn nothing_has_no_mean() {
        assert_eq!(ExactMean::default().mean(), None);
    }
}
