//! Which exposure serves a keyframe that names none.

use crate::Timestamp;

/// An exposure serves a keyframe up to this far in time, seconds (labels.md section 2).
pub const EXPOSURE_WITHIN_S: f64 = 0.1;

/// Of a camera's exposures in order of time the one nearest to a time, the earlier on ties, and the
/// first of one time; none if it is not near enough to serve a keyframe.
pub fn nearest_exposure<T>(
    exposures: &[T],
    time_of: impl Fn(&T) -> Timestamp,
    time: Timestamp,
) -> Option<&T> {
    nearest_exposure_within(exposures, time_of, time, EXPOSURE_WITHIN_S)
}

/// The same; none if it is farther away than `within_s` seconds.
pub fn nearest_exposure_within<T>(
    exposures: &[T],
    time_of: impl Fn(&T) -> Timestamp,
    time: Timestamp,
    within_s: f64,
) -> Option<&T> {
    let first_from = |from: Timestamp| exposures.partition_point(|one| time_of(one) < from);
    let later = first_from(time);
    let before = exposures[..later].last().map(|last| first_from(time_of(last)));
    let candidates = before.into_iter().chain([later]).filter_map(|place| exposures.get(place));
    let nearest = candidates.min_by_key(|one| time_of(one).0.abs_diff(time.0))?;
    (time_of(nearest).seconds_apart(time) <= within_s).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nearest(times_ms: &[i64], to_ms: i64) -> Option<usize> {
        let numbered: Vec<_> = times_ms.iter().copied().enumerate().collect();
        let time_of = |(_, ms): &(usize, i64)| Timestamp(ms * 1_000_000);
        nearest_exposure(&numbered, time_of, Timestamp(to_ms * 1_000_000)).map(|(place, _)| *place)
    }

    #[test]
    fn section_2_the_nearest_within_a_tenth_the_earlier_on_ties() {
        assert_eq!(nearest(&[0, 80, 160], 90), Some(1));
        assert_eq!(nearest(&[0, 80, 160], 120), Some(1), "as far from both");
        assert_eq!(nearest(&[0, 80, 80, 160], 81), Some(1), "the first of one time");
        assert_eq!(nearest(&[0, 80, 80], 80), Some(1));
        assert_eq!((nearest(&[0], 100), nearest(&[0], 101)), (Some(0), None));
        assert_eq!((nearest(&[300], 200), nearest(&[300], 199)), (Some(0), None));
        assert_eq!(nearest(&[], 0), None);
    }
}
