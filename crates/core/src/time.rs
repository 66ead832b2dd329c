//! Points in time.

use serde::{Deserialize, Serialize};

/// Nanoseconds since the log's epoch.
///
/// Times stay integers until the last moment, so that two sweeps with the same stamp are the same
/// time on every machine (labels.md section 1).
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct Timestamp(pub i64);

impl Timestamp {
    /// The time of a stamp in microseconds, as nuScenes and Waymo write it.
    pub fn from_micros(micros: i64) -> Self {
        Self(micros.saturating_mul(1000))
    }

    /// Seconds from `earlier` to `self`: one division of the integer difference.
    pub fn seconds_since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 / 1e9
    }

    /// Seconds between two times, never negative.
    pub fn seconds_apart(self, other: Self) -> f64 {
        self.seconds_since(other).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_1_spans_are_one_division_of_integers() {
        let (a, b) = (Timestamp(1_532_402_927_647_951_000), Timestamp(1_532_402_927_697_951_000));
        assert_eq!(b.seconds_since(a), 0.05);
        assert_eq!(a.seconds_since(b), -0.05);
        assert_eq!(a.seconds_apart(b), 0.05);
    }

    #[test]
    fn hostile_stamps_saturate() {
        assert_eq!(Timestamp::from_micros(i64::MAX), Timestamp(i64::MAX));
        assert!(Timestamp(i64::MIN).seconds_apart(Timestamp(i64::MAX)) > 9e9);
    }
}
