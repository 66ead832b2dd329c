//! A box around points, and how far others are from all places in it.
//!
//! Every bound holds for distances as computed, not only for true ones: subtraction, square and sum
//! round monotonically, so what is farther on every axis is never computed to be nearer.

use nalgebra::Point3;

/// Whatever lies between two corners. Metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    const NOTHING: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// The smallest box that holds all the points.
    pub(crate) fn of<'a>(points: impl Iterator<Item = &'a Point3<f64>>) -> Self {
        points.fold(Self::NOTHING, |all, p| {
            all.with(&Self { low: p.coords.into(), high: p.coords.into() })
        })
    }

    /// The smallest box that holds both.
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| lower(self.low[axis], other.low[axis])),
            high: std::array::from_fn(|axis| higher(self.high[axis], other.high[axis])),
        }
    }

    /// The middle.
    pub(crate) fn center(&self) -> Point3<f64> {
        Point3::from(std::array::from_fn(|axis| 0.5 * self.low[axis] + 0.5 * self.high[axis]))
    }

    /// The lowest corner and the highest.
    pub(crate) fn corners(&self) -> [Point3<f64>; 2] {
        [self.low, self.high].map(Point3::from)
    }

    /// No place in this box has a smaller squared distance to any in the other.
    #[inline]
    pub(crate) fn least_squared(&self, other: &Self) -> f64 {
        sum_of_squares(|axis| {
            let gap = higher(other.low[axis] - self.high[axis], self.low[axis] - other.high[axis]);
            higher(gap, 0.0)
        })
    }

    /// No place in this box has a smaller squared distance to `p`.
    #[inline]
    pub(crate) fn least_squared_to(&self, p: &Point3<f64>) -> f64 {
        self.least_squared(&Self { low: p.coords.into(), high: p.coords.into() })
    }

    /// No place in this box has a greater squared distance to `p`.
    #[inline]
    pub(crate) fn most_squared_to(&self, p: &Point3<f64>) -> f64 {
        sum_of_squares(|axis| higher(p[axis] - self.low[axis], self.high[axis] - p[axis]))
    }
}

/// The squared distance of two points, in the one order of operations that decides labels.
#[inline]
pub(crate) fn distance_squared(a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    sum_of_squares(|axis| a[axis] - b[axis])
}

#[inline]
fn sum_of_squares(of_axis: impl Fn(usize) -> f64) -> f64 {
    let [x, y, z] = [of_axis(0), of_axis(1), of_axis(2)];
    x * x + y * y + z * z
}

/// The higher of two numbers: one instruction, which `f64::max` with its rule for NaN is not.
#[inline]
fn higher(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline]
fn lower(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell;

    fn point() -> impl Strategy<Value = Point3<f64>> {
        let coordinate = prop_oneof![(-3_i32..4).prop_map(|i| 0.1 * f64::from(i)), -1e6..1e6_f64];
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Point3::from)
    }

    #[test]
    fn distances_as_computed_lie_between_the_least_and_the_most() {
        let pairs = Cell::new(0);
        let clouds = (prop::collection::vec(point(), 1..6), prop::collection::vec(point(), 1..6));
        proptest!(ProptestConfig::with_cases(500), |((these, those) in clouds)| {
            let (here, there) = (Bounds::of(these.iter()), Bounds::of(those.iter()));
            for (a, b) in these.iter().flat_map(|a| those.iter().map(move |b| (a, b))) {
                let distance = distance_squared(a, b);
                prop_assert!(here.least_squared(&there) <= here.least_squared_to(b));
                prop_assert!(here.least_squared_to(b) <= distance);
                prop_assert!(distance <= here.most_squared_to(b));
                pairs.set(pairs.get() + 1);
            }
        });
        assert!(pairs.get() > 2_000, "{} pairs", pairs.get());
    }
}
