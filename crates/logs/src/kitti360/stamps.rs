//! Files of dates and times, a frame a line.

use std::path::Path;

use occlabel_core::{Fault, Timestamp};

use crate::number_rows::read_lines;

/// What a line has to be.
const A_TIME: &str = "a time as 2013-05-28 08:46:02.904523776";

/// The times of frames.
#[derive(Debug)]
pub(super) struct Stamps {
    file: String,
    lines: Vec<String>,
}

impl Stamps {
    /// Reads a file of the log.
    ///
    /// # Errors
    /// If it is absent or cannot be read.
    pub(super) fn read(root: &Path, file: String) -> Result<Self, Fault> {
        let lines = read_lines(root, &file)?;
        Ok(Self { file, lines })
    }

    /// When a frame was taken.
    ///
    /// # Errors
    /// If it has no line, or that is no time.
    pub(super) fn time(&self, frame: usize) -> Result<Timestamp, Fault> {
        let found = match self.lines.get(frame) {
            Some(line) => match time(line) {
                Some(time) => return Ok(time),
                None => format!("`{}`", line.chars().take(40).collect::<String>()),
            },
            None => format!("{} lines", self.lines.len()),
        };
        let fault = Fault::new("scan-time", &self.file, A_TIME, found);
        Err(fault.record(format!("line {}", frame + 1)))
    }
}

/// The time of `YEAR-MONTH-DAY HOUR:MINUTE:SECOND[.FRACTION]`, counted from 1970 without leap seconds.
fn time(line: &str) -> Option<Timestamp> {
    let (date, clock) = line.trim().split_once(' ')?;
    let [year, month, day] = whole_numbers(date, '-')?;
    let (clock, fraction) = clock.split_once('.').unwrap_or((clock, ""));
    let [hour, minute, second] = whole_numbers(clock, ':')?;
    let is_time = (1900..2200).contains(&year)
        && (1..=12).contains(&month)
        && (1..=31).contains(&day)
        && hour < 24
        && minute < 60
        && second < 61;
    if !is_time || fraction.len() > 9 || !fraction.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let nanoseconds: i64 = format!("{fraction:0<9}").parse().ok()?;
    let seconds = ((days(year, month, day) * 24 + hour) * 60 + minute) * 60 + second;
    Some(Timestamp(seconds * 1_000_000_000 + nanoseconds))
}

fn whole_numbers(text: &str, separator: char) -> Option<[i64; 3]> {
    let number = |part: &str| part.parse::<u16>().ok().map(i64::from);
    let parts: Option<Vec<i64>> = text.split(separator).map(number).collect();
    parts?.try_into().ok()
}

/// Days from 1970-01-01 to a date of the Gregorian calendar, whose years begin in March here.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let of_year = (153 * month + 2) / 5 + day - 1;
    let leap_days = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    year * 365 + leap_days + of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_count_from_1970() {
        let cases = [
            ("1970-01-01 00:00:00", 0),
            ("2013-05-28 08:46:02.904523776", 1_369_730_762_904_523_776),
            ("2000-02-29 23:59:59.5", 951_868_799_500_000_000),
            ("2000-03-01 00:00:00.000000001", 951_868_800_000_000_001),
        ];
        for (line, expected) in cases {
            assert_eq!(time(line), Some(Timestamp(expected)), "{line}");
        }
    }

    #[test]
    fn what_is_no_time_is_none() {
        let broken = ["", "2013-05-28", "2013-05 08:46:02", "2013-13-28 08:46:02", "a-b-c d:e:f"];
        let more = ["2013-05-28 24:00:00", "2013-05-28 08:46:02.1234567890", "2013-05-28 8:4:2.x"];
        assert!(broken.into_iter().chain(more).all(|line| time(line).is_none()));
    }
}
