//! Sums that do not depend on their order.

use std::ops::AddAssign;

/// A sum of numbers from 0 to 2^64, in units of 2^-64.
///
/// What is added is cut to the unit, so that all else is whole numbers. Sums too large stay at the
/// top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ExactSum(u128);

/// Units a one.
const ONE: f64 = (1_u128 << 64) as f64;

impl ExactSum {
    /// Adds a number; one below 0 and NaN count as 0.
    pub(crate) fn add(&mut self, number: f64) {
        *self += Self((number * ONE) as u128);
    }

    /// The sum, rounded once.
    pub(crate) fn value(self) -> f64 {
        self.0 as f64 / ONE
    }
}

impl AddAssign for ExactSum {
    fn add_assign(&mut self, other: Self) {
        self.0 = self.0.saturating_add(other.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(numbers: impl Iterator<Item = f64>) -> ExactSum {
        let mut sum = ExactSum::default();
        numbers.for_each(|number| sum.add(number));
        sum
    }

    #[test]
    fn the_order_does_not_matter() {
        let number = |i: u32| f64::from(i % 97) / 7.0 + libm::exp2(f64::from(i)).recip();
        let (forth, back) = (sum((0..1000).map(number)), sum((0..1000).rev().map(number)));
        assert_eq!(forth, back);
        let about: f64 = (0..1000).map(number).sum();
        assert!((forth.value() - about).abs() < 1e-9, "{} {about}", forth.value());
    }

    #[test]
    fn what_is_too_large_stays_at_the_top() {
        let mut top = sum([f64::MAX, f64::NAN, -1.0].into_iter());
        top.add(1.0);
        assert_eq!(top.value(), 2_f64 * (1_u64 << 63) as f64);
    }
}
