//! When a sensor works.

use occlabel_core::{Fault, Timestamp};

use crate::check::within;

/// Regular times: sweep or image k begins at `offset + k / rate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    rate_hz: f64,
    offset_s: f64,
}

impl Clock {
    /// A clock, its first time at least 0.
    ///
    /// # Errors
    /// If the rate is not in 0.01 to 1000 Hz, or the offset not in 0 to 100 s.
    pub fn new(rate_hz: f64, offset_s: f64) -> Result<Self, Fault> {
        within("rate_hz", rate_hz, 0.01, 1000.0)?;
        within("offset_s", offset_s, 0.0, 100.0)?;
        Ok(Self { rate_hz, offset_s })
    }

    /// Times per second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The k-th time and a share of a period, to the whole microsecond that log formats keep.
    pub fn tick(&self, k: usize, share: f64) -> Timestamp {
        let seconds = self.offset_s + (k as f64 + share) / self.rate_hz;
        Timestamp((seconds * 1e6).round() as i64 * 1000)
    }

    /// All times before the end of a drive.
    pub fn ticks(&self, duration_s: f64) -> impl Iterator<Item = Timestamp> + use<> {
        let (clock, end) = (*self, Timestamp((duration_s * 1e9).round() as i64));
        (0..).map(move |k| clock.tick(k, 0.0)).take_while(move |time| *time < end)
    }
}
