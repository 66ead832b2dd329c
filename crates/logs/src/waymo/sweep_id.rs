//! The ids of sweeps: `segment/microseconds/LIDAR`.

use std::fmt;

use super::segment::Lidar;

/// What tells a sweep from all others of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SweepId {
    pub(super) segment: String,
    /// The frame's time.
    pub(super) micros: i64,
    pub(super) lidar: Lidar,
}

impl SweepId {
    /// The id behind a text, if it is one.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut parts = text.rsplitn(3, '/');
        let lidar = Lidar::of_name(parts.next()?)?;
        let micros = parts.next()?.parse().ok()?;
        Some(Self { segment: parts.next()?.to_owned(), micros, lidar })
    }
}

impl fmt::Display for SweepId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}", self.segment, self.micros, self.lidar.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_is_read_as_it_was_written() {
        for text in ["a_b/1550083467346370/TOP", "a/b/-1/REAR"] {
            assert_eq!(SweepId::parse(text).unwrap().to_string(), text);
        }
        for text in ["", "TOP", "1/TOP", "a/x/TOP", "a/1/top"] {
            assert_eq!(SweepId::parse(text), None, "{text}");
        }
    }
}
