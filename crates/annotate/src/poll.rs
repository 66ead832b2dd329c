//! The vote of the nearest for four places at once, where rounding cannot change it.
//!
//! Squared distances are computed in f32 from one center, and the class stands in the lowest bits of
//! each, so that one minimum and one maximum keep a distance and its class in order. What lies so
//! close together that rounding may have changed the order is left to the exact vote.
//!
//! The bound: let all coordinates be at most `e` from the center and `u` = 2^-24. A coordinate is
//! rounded by at most `u e`, a difference of two by `2 u e` more, so it errs by `4 u e`; a squared
//! distance, at most `12 e^2`, errs by less than `48 u e^2 + 4 u d`. Taking its lowest eight bits for
//! the class lowers it by less than `2^-15 d`. Two that are more than `2^-14 d + 2^-16 e^2` apart, twice all that,
//! are in their true order.

use nalgebra::Point3;
use occlabel_core::ClassId;
use wide::f32x4;

use crate::bounds::Bounds;
use crate::groups::relative;
use crate::labelled_tree::Labelled;

/// Places that are asked about at once.
pub(crate) const PLACES: usize = 4;

/// Bits of a key that hold the class.
const CLASS_BITS: u32 = 0xff;

/// Set in a result where there is no class.
const NOBODY: u32 = 0x100;

/// Set in a result where rounding might matter.
const UNSURE: u32 = 0x200;

/// A key of no point: beyond all squared distances, square metres.
const BEYOND: f32 = 1e30;

/// Groups may extend so far from their center for squares to stay below [`BEYOND`], metres.
const MAX_EXTENT_M: f32 = 1e12;

/// Groups count as so wide for squares to stay above the smallest floats, metres.
const MIN_EXTENT_M: f32 = 1e-6;

/// Whom the vote of the nearest gives a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// A class has won.
    Won(ClassId),
    /// No point is in reach.
    Nobody,
    /// Distances are too much alike for this arithmetic.
    Unsure,
}

/// The points that can vote for places in a box.
pub(crate) struct Poll {
    center: Point3<f64>,
    voters: Vec<Voter>,
    k: usize,
    reach_squared: f32,
    /// `2^-16 e^2`, square metres.
    margin: f32,
}

#[derive(Clone, Copy)]
struct Voter {
    at_m: [f32; 3],
    class: f32,
}

impl Poll {
    /// A poll of `k` among the points for places in `bounds`; `None` if it would never be sure.
    pub(crate) fn new(
        points: &[Labelled],
        bounds: &Bounds,
        k: usize,
        reach_squared: f64,
    ) -> Option<Self> {
        let center = bounds.center();
        let voters: Vec<Voter> = points.iter().map(|point| Voter::new(point, &center)).collect();
        let corners = bounds.corners().map(|corner| relative(&corner, &center));
        let all = voters.iter().map(|voter| voter.at_m).chain(corners).flatten();
        let extent_m = all.fold(MIN_EXTENT_M, |most, x| most.max(x.abs()));
        let reach_squared = reach_squared.min(f64::from(BEYOND / 2.0)) as f32;
        let margin = extent_m * extent_m / 65_536.0;
        let poll = Self { center, voters, k, reach_squared, margin };
        (k < MANY && extent_m <= MAX_EXTENT_M).then_some(poll)
    }

    /// What the vote gives each of the places; those left over repeat one of them.
    pub(crate) fn outcomes(&self, places: &[Point3<f64>]) -> [Outcome; PLACES] {
        let last = places.len() - 1;
        let at: [[f32; 3]; PLACES] =
            std::array::from_fn(|i| relative(&places[i.min(last)], &self.center));
        let at_m = [0, 1, 2].map(|axis| f32x4::new(at.map(|place| place[axis])));
        let winners = if self.k < FEW {
            self.count::<FEW>(&at_m).winners()
        } else {
            self.count::<MANY>(&at_m).winners()
        };
        winners.to_array().map(Outcome::from_bits)
    }

    /// The first `N` keys of each place, in order.
    #[inline]
    fn count<const N: usize>(&self, at_m: &[f32x4; 3]) -> Count<'_, N> {
        let mut keys = [f32x4::splat(BEYOND); N];
        for voter in &self.voters {
            let mut key = voter.key(at_m);
            for kept in &mut keys {
                (*kept, key) = (kept.fast_min(key), kept.fast_max(key));
            }
        }
        Count { poll: self, keys }
    }
}

impl Voter {
    fn new((position, class): &Labelled, center: &Point3<f64>) -> Self {
        Self { at_m: relative(position, center), class: f32::from_bits(u32::from(class.0)) }
    }

    /// The squared distance to each place, its lowest bits replaced by the class.
    #[inline]
    fn key(&self, at_m: &[f32x4; 3]) -> f32x4 {
        let [x, y, z] = [0, 1, 2].map(|axis| at_m[axis] - f32x4::splat(self.at_m[axis]));
        let squared = x * x + y * y + z * z + f32x4::splat(f32::MIN_POSITIVE);
        (squared & bits(!CLASS_BITS)) | f32x4::splat(self.class)
    }
}

/// One more than the `k` for which so many keys are kept: of the first left out it must be sure, too.
const FEW: usize = 6;

/// The same for greater `k`.
const MANY: usize = 11;

/// The first keys of each place.
struct Count<'a, const N: usize> {
    poll: &'a Poll,
    keys: [f32x4; N],
}

impl<const N: usize> Count<'_, N> {
    /// The bits of a class, [`NOBODY`], or with [`UNSURE`] set.
    #[inline]
    fn winners(&self) -> f32x4 {
        let k = self.poll.k.min(self.poll.voters.len());
        let (mut winner, mut most) = (bits(NOBODY), f32x4::ZERO);
        let mut unsure = f32x4::ZERO;
        for i in 0..k.min(N - 1) {
            let votes = self.votes(i, k);
            let wins = votes.simd_gt(most);
            winner = wins.select(self.keys[i] & bits(CLASS_BITS), winner);
            most = most.fast_max(votes);
            unsure |= self.unsure_of_reach(i) | self.unsure_of_order(i, i + 1 == k);
        }
        winner | (unsure & bits(UNSURE))
    }

    /// How many of the first `k` within reach have the class of key `i`.
    #[inline]
    fn votes(&self, i: usize, k: usize) -> f32x4 {
        let mut votes = f32x4::ZERO;
        for key in &self.keys[..k.min(N - 1)] {
            let counts = self.class(i).simd_eq(class_of(*key)) & key.simd_le(self.reach());
            votes += counts & f32x4::ONE;
        }
        votes
    }

    /// Whether key `i` is so near the limit that it may be on its other side.
    #[inline]
    fn unsure_of_reach(&self, i: usize) -> f32x4 {
        (self.keys[i] - self.reach()).abs().simd_le(self.tolerance(i))
    }

    /// Whether key `i` is so near the next that their order matters and may be the other.
    #[inline]
    fn unsure_of_order(&self, i: usize, is_last: bool) -> f32x4 {
        let close = (self.keys[i + 1] - self.keys[i]).simd_le(self.tolerance(i + 1));
        let same_class = self.class(i).simd_eq(self.class(i + 1));
        if is_last { close } else { same_class.select(f32x4::ZERO, close) }
    }

    fn tolerance(&self, i: usize) -> f32x4 {
        self.keys[i] * f32x4::splat(1.0 / 16_384.0) + f32x4::splat(self.poll.margin)
    }

    fn reach(&self) -> f32x4 {
        f32x4::splat(self.poll.reach_squared)
    }

    fn class(&self, i: usize) -> f32x4 {
        class_of(self.keys[i])
    }
}

/// A number for each class of a key, to be compared only.
#[inline]
fn class_of(key: f32x4) -> f32x4 {
    (key & bits(CLASS_BITS)) | f32x4::ONE
}

#[inline]
fn bits(bits: u32) -> f32x4 {
    f32x4::splat(f32::from_bits(bits))
}

impl Outcome {
    fn from_bits(winner: f32) -> Self {
        match winner.to_bits() {
            bits if bits & UNSURE != 0 => Self::Unsure,
            bits if bits & NOBODY != 0 => Self::Nobody,
            bits => Self::Won(ClassId(bits as u8)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vote::vote;
    use proptest::prelude::*;
    use std::cell::Cell;

    fn labelled() -> impl Strategy<Value = Labelled> {
        let coordinate = prop_oneof![(-3_i32..4).prop_map(|i| 0.1 * f64::from(i)), -1.0..1.0_f64];
        let position = [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Point3::from);
        (position, (0_u8..4).prop_map(ClassId))
    }

    #[test]
    fn what_a_poll_is_sure_of_is_so() {
        let (sure, unsure) = (Cell::new(0), Cell::new(0));
        let points = prop::collection::vec(labelled(), 1..60);
        let setting =
            (points, 1_usize..MANY, -9..9_i32, prop_oneof![Just(f64::INFINITY), 0.0..2.0_f64]);
        proptest!(ProptestConfig::with_cases(1_000), |((points, k, scale, reach) in setting)| {
            let scaled = |p: &Point3<f64>| p * libm::exp10(f64::from(scale));
            let points: Vec<_> = points.iter().map(|(p, class)| (scaled(p), *class)).collect();
            let reach_squared = reach * libm::exp10(f64::from(2 * scale));
            let places: Vec<_> = points.iter().take(PLACES).map(|(p, _)| p * 0.7).collect();
            let bounds = Bounds::of(places.iter());
            let poll = Poll::new(&points, &bounds, k, reach_squared).unwrap();
            for (p, outcome) in places.iter().zip(poll.outcomes(&places)) {
                let expected = vote(&points, p, k, reach_squared).map_or(Outcome::Nobody, Outcome::Won);
                let count = if outcome == Outcome::Unsure { &unsure } else { &sure };
                count.set(count.get() + 1);
                prop_assert!(outcome == Outcome::Unsure || outcome == expected, "{outcome:?}, {expected:?}");
            }
        });
        assert!(sure.get() > 1_000, "sure {} times", sure.get());
        assert!(unsure.get() > 100, "unsure {} times", unsure.get());
    }

    #[test]
    fn a_poll_over_too_many_or_too_far_is_none() {
        let points = [(Point3::new(1e13, 0.0, 0.0), ClassId(1))];
        let bounds = Bounds::of([Point3::origin()].iter());
        assert!(Poll::new(&points, &bounds, 1, f64::INFINITY).is_none());
        assert!(Poll::new(&points[..0], &bounds, MANY, f64::INFINITY).is_none());
        assert!(Poll::new(&points[..0], &bounds, MANY - 1, f64::INFINITY).is_some());
    }
}
