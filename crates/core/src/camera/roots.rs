//! Roots in one unknown: where a polynomial stops being positive, and where a function crosses
//! zero.

/// Relative step below which [`crossing`] is done; its steps shrink quadratically, so the error is
/// far smaller.
const STEP_TOLERANCE: f64 = 1e-13;

/// Bisection alone needs fewer than this to exhaust f64 over any range used here.
const MAX_STEPS: usize = 200;

/// Value of a polynomial with ascending coefficients (Horner's scheme).
pub(super) fn evaluate(polynomial: &[f64], x: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |value, a| value * x + a)
}

/// Value and first derivative of a polynomial with ascending coefficients.
pub(super) fn evaluate_with_slope(polynomial: &[f64], x: f64) -> (f64, f64) {
    polynomial.iter().rev().fold((0.0, 0.0), |(value, slope), a| (value * x + a, slope * x + value))
}

/// How far from 0 a polynomial with positive constant term stays positive: its first root in
/// (0, `upper`), as sharp as f64 can tell its sign, or infinity if it has none there.
///
/// Between neighbouring roots of its derivative a polynomial is monotone, so a bisection there
/// misses none.
pub(super) fn positive_until(polynomial: &[f64], upper: f64) -> f64 {
    sign_changes(polynomial, upper).first().copied().unwrap_or(f64::INFINITY)
}

/// Where in (0, `upper`) a polynomial turns from positive to not positive or back, ascending.
fn sign_changes(polynomial: &[f64], upper: f64) -> Vec<f64> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let turns = sign_changes(&derivative(polynomial), upper);
    let ends: Vec<f64> = [0.0].into_iter().chain(turns).chain([upper]).collect();
    ends.windows(2).filter_map(|pair| sign_change(polynomial, pair[0], pair[1])).collect()
}

/// Ascending coefficients of the derivative.
fn derivative(polynomial: &[f64]) -> Vec<f64> {
    let powers = 1..polynomial.len();
    powers.map(|power| power as f64 * polynomial[power]).collect()
}

/// The last number below the sign change of a polynomial that is monotone in [`low`, `high`].
fn sign_change(polynomial: &[f64], mut low: f64, mut high: f64) -> Option<f64> {
    let positive = |x: f64| evaluate(polynomial, x) > 0.0;
    let before = positive(low);
    if positive(high) == before {
        return None;
    }
    loop {
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high {
            return Some(low);
        }
        if positive(middle) == before {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Where a function that is not positive at 0 crosses zero in [0, `upper`]; `None` if it is still
/// negative there.
///
/// `function` gives value and slope. Newton's steps, kept inside a shrinking bracket: where a step
/// leaves it or does not halve the step before, the bracket is halved (`rtsafe` of Press et al.,
/// Numerical Recipes, 9.4).
pub(super) fn crossing(
    function: impl Fn(f64) -> (f64, f64),
    start: f64,
    upper: f64,
) -> Option<f64> {
    let reached = function(upper).0 >= 0.0;
    if !reached {
        return None;
    }
    let (mut low, mut high, mut x, mut last_step) = (0.0, upper, start.min(upper), upper);
    for _ in 0..MAX_STEPS {
        let (value, slope) = function(x);
        if value < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let good = low <= newton && newton <= high && 2.0 * (newton - x).abs() <= last_step;
        let next = if good { newton } else { low + (high - low) / 2.0 };
        last_step = (next - x).abs();
        x = next;
        if last_step <= STEP_TOLERANCE * x {
            break;
        }
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ascending coefficients of the product of (1 - x / root).
    fn with_roots(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |polynomial, root| {
            let mut product = polynomial.clone();
            product.push(0.0);
            for (power, a) in polynomial.iter().enumerate() {
                product[power + 1] -= a / root;
            }
            product
        })
    }

    #[test]
    fn first_root_is_found_near_and_far() {
        let mut found = 0;
        for first in [1e-9, 1e-3, 0.4, 1.0, 37.0, 1e5, 1e9] {
            for others in
                [vec![], vec![2.0], vec![1.001], vec![1.5, 3.0], vec![-1.0, 1.1, 1e3, -5.0]]
            {
                let roots: Vec<f64> =
                    [1.0].into_iter().chain(others).map(|ratio| ratio * first).collect();
                let limit = positive_until(&with_roots(&roots), 1e16);
                let error = (limit / first - 1.0).abs();
                assert!(error < 1e-9, "roots {roots:?}: found {limit}, {error:e} off");
                found += 1;
            }
        }
        assert_eq!(found, 35);
    }

    #[test]
    fn no_root_is_infinity() {
        assert_eq!(positive_until(&[1.0], 1e16), f64::INFINITY);
        assert_eq!(positive_until(&[1.0, 0.0, 0.0], 1e16), f64::INFINITY);
        assert_eq!(positive_until(&[1.0, -1.0, 1.0], 1e16), f64::INFINITY, "complex roots");
        assert_eq!(positive_until(&[1.0, -0.1], 9.0), f64::INFINITY, "beyond the range");
    }

    #[test]
    fn a_touching_root_counts() {
        // Found to 1e-7 only: nearer than that, (1 - x)^2 itself is rounding.
        let limit = positive_until(&[1.0, -2.0, 1.0], 1e16);
        assert!((limit - 1.0).abs() < 1e-7, "{limit}");
    }

    #[test]
    fn first_root_agrees_with_a_dense_scan() {
        let mut random = crate::camera::checks::Random::new(7);
        let (mut with_root, mut without) = (0, 0);
        for _ in 0..300 {
            let polynomial: Vec<f64> =
                [1.0].into_iter().chain((0..6).map(|_| random.within(-2.0, 2.0))).collect();
            let scanned =
                (1..40_000).map(|i| f64::from(i) * 1e-4).find(|&x| evaluate(&polynomial, x) <= 0.0);
            let limit = positive_until(&polynomial, 4.0);
            match scanned {
                Some(x) => {
                    assert!(x - 1.001e-4 < limit && limit <= x, "{polynomial:?}: {limit}, scan {x}")
                }
                None => assert!(limit > 3.999, "{polynomial:?}: {limit}, scan finds none"),
            }
            if scanned.is_some() { with_root += 1 } else { without += 1 }
        }
        assert!(with_root > 100 && without > 50, "{with_root} with a root, {without} without");
    }

    #[test]
    fn crossing_survives_bad_starts_and_flat_slopes() {
        let seventh = |x: f64| (libm::pow(x, 7.0) - 1e-7, 7.0 * libm::pow(x, 6.0));
        let mut solved = 0;
        for start in [0.0, 1e-300, 1e-3, 0.1, 5.0, 1e8] {
            let x = crossing(seventh, start, 1e8).unwrap();
            assert!((x - 0.1).abs() < 1e-13, "from {start}: {x}");
            solved += 1;
        }
        assert_eq!(solved, 6);
        assert_eq!(crossing(|x| (x - 3.0, 1.0), 0.0, 2.0), None);
        assert_eq!(crossing(|x| (x, 1.0), 0.0, 2.0), Some(0.0));
    }
}
