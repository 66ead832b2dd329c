//! Mean and percentiles of sizes, from integers that add up in any order.

use std::collections::BTreeMap;

/// The largest size told apart from larger ones; also what stands for a size that is no number.
const LARGEST: f64 = 1000.0;

/// Sizes from 0 to 1000, rounded: to a millionth for the mean, to a thousandth for percentiles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Histogram {
    thousandths: BTreeMap<u32, u64>,
    sum_millionths: u64,
    count: u64,
}

impl Histogram {
    /// Takes in one more size, not below 0.
    pub(crate) fn insert(&mut self, size: f64) {
        // `min` takes NaN to the other number.
        let size = size.min(LARGEST);
        *self.thousandths.entry((size * 1e3).round() as u32).or_default() += 1;
        self.sum_millionths += (size * 1e6).round() as u64;
        self.count += 1;
    }

    /// How many sizes there are.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Their mean, if there are any.
    pub(crate) fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum_millionths as f64 / self.count as f64 / 1e6)
    }

    /// The smallest size that 95 of 100 sizes do not exceed, to a thousandth, if there are any.
    pub(crate) fn percentile_95(&self) -> Option<f64> {
        let rank = (self.count * 95).div_ceil(100);
        let mut below = 0;
        let bin = self.thousandths.iter().find(|(_, count)| {
            below += **count;
            below >= rank
        });
        bin.map(|(&bin, _)| f64::from(bin) / 1e3)
    }

    /// Takes in all sizes of another.
    pub(crate) fn add(&mut self, other: &Self) {
        for (&bin, &count) in &other.thousandths {
            *self.thousandths.entry(bin).or_default() += count;
        }
        self.sum_millionths += other.sum_millionths;
        self.count += other.count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(sizes: impl IntoIterator<Item = f64>) -> Histogram {
        let mut histogram = Histogram::default();
        sizes.into_iter().for_each(|size| histogram.insert(size));
        histogram
    }

    #[test]
    fn of_one_to_a_hundred_the_95th_is_95() {
        let all = histogram((1..=100).map(f64::from));
        assert_eq!((all.mean(), all.percentile_95()), (Some(50.5), Some(95.0)));
        let few = histogram([0.25, 0.5]);
        assert_eq!((few.mean(), few.percentile_95()), (Some(0.375), Some(0.5)));
    }

    #[test]
    fn nothing_has_no_mean() {
        assert_eq!(Histogram::default().mean(), None);
        assert_eq!(Histogram::default().percentile_95(), None);
    }

    #[test]
    fn what_is_no_number_shows_as_the_largest() {
        assert_eq!(histogram([f64::NAN]).mean(), Some(LARGEST));
        assert_eq!(histogram([f64::INFINITY]).percentile_95(), Some(LARGEST));
    }

    #[test]
    fn halves_add_up_to_the_whole_either_way() {
        let size = |i: u32| f64::from(i * 7919 % 1000) * 0.003_1;
        let (low, high) = (histogram((0..500).map(size)), histogram((500..1000).map(size)));
        let (mut one, mut other) = (low.clone(), high.clone());
        one.add(&high);
        other.add(&low);
        assert_eq!(one, other);
        assert_eq!(one, histogram((0..1000).map(size)));
    }
}
