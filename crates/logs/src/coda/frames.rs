//! When frames were taken, and where the lidar stood then.

use std::path::Path;

use occlabel_core::{Fault, Pose, Timestamp};

use super::sequence::{Sequence, first_present};
use crate::notes::Notes;
use crate::number_rows::{numbers, read_lines};
use crate::transform::pose_from_quaternion;

/// What a line of poses has to be.
const A_POSE: &str = "a time, a place and a unit quaternion, w first";
/// Farthest time from the beginning, seconds: such a number of nanoseconds fits an integer.
const LATEST_S: f64 = 9e9;
/// A pose is of its frame if their times are at most so far apart, seconds: half a turn at 10 Hz.
const APART_S: f64 = 0.05;

/// Times and poses of a sequence; a frame's number is its line.
#[derive(Debug)]
pub(super) struct Frames {
    times: Lines,
    poses: Lines,
}

#[derive(Debug)]
struct Lines {
    file: String,
    lines: Vec<String>,
}

impl Frames {
    /// Reads both files.
    ///
    /// # Errors
    /// If one is absent or cannot be read.
    pub(super) fn read(root: &Path, sequence: &Sequence) -> Result<Self, Fault> {
        let lines = |files: [String; 2]| {
            let file = first_present(root, &files)?;
            Ok(Lines { lines: read_lines(root, &file)?, file })
        };
        Ok(Self { times: lines(sequence.times())?, poses: lines(sequence.poses())? })
    }

    /// How many frames have a pose.
    pub(super) fn posed(&self) -> usize {
        self.poses.lines.len()
    }

    /// When a frame was taken.
    ///
    /// # Errors
    /// If it has no line, or that is no time.
    pub(super) fn time(&self, frame: usize) -> Result<Timestamp, Fault> {
        let read = self.times.line(frame).and_then(time);
        read.map_err(|found| self.times.fault("frame-time", frame, "a time in seconds", found))
    }

    /// Where the lidar stood at a frame, in the world of the poses. A pose of another time is noted.
    ///
    /// # Errors
    /// If it has no line, or that is no pose.
    pub(super) fn world_from_lidar(&self, frame: usize, notes: &mut Notes) -> Result<Pose, Fault> {
        let read = self.poses.line(frame).and_then(pose);
        let (posed, pose) =
            read.map_err(|found| self.poses.fault("frame-pose", frame, A_POSE, found))?;
        let apart_s = self.time(frame)?.seconds_apart(posed);
        if apart_s > APART_S {
            let found = format!("{apart_s:.3} s apart");
            notes.warn(self.poses.fault("pose-time", frame, "the time of the frame", found));
        }
        Ok(pose)
    }
}

impl Lines {
    fn line(&self, frame: usize) -> Result<&str, String> {
        let line = self.lines.get(frame).map(String::as_str);
        line.ok_or_else(|| format!("{} lines", self.lines.len()))
    }

    fn fault(&self, rule: &'static str, frame: usize, expected: &str, found: String) -> Fault {
        let fault = Fault::new(rule, &self.file, expected, found);
        fault.record(format!("line {}", frame.saturating_add(1)))
    }
}

/// The time of a line: as its digits say, up to nanoseconds.
///
/// 64-bit floats tell a time of our days to a quarter of a microsecond, so that whatever is written in
/// another way is rounded to a microsecond.
pub(crate) fn time(line: &str) -> Result<Timestamp, String> {
    let [seconds] = numbers(line)?;
    if seconds.abs() >= LATEST_S {
        return Err(format!("{seconds} s"));
    }
    let rounded = (seconds * 1e6).round() as i64 * 1000;
    Ok(Timestamp(plain_nanoseconds(line.trim()).unwrap_or(rounded)))
}

/// The nanoseconds of plain digits with a point.
fn plain_nanoseconds(seconds: &str) -> Option<i64> {
    let (whole, part) = seconds.split_once('.')?;
    let is_plain = |digits: &str| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    if !is_plain(whole) || !is_plain(part) {
        return None;
    }
    let part: i64 = format!("{part:0<9}")[..9].parse().ok()?;
    whole.parse::<i64>().ok()?.checked_mul(1_000_000_000)?.checked_add(part)
}

/// The time and the pose of a line.
pub(crate) fn pose(line: &str) -> Result<(Timestamp, Pose), String> {
    let [_, x, y, z, qw, qx, qy, qz] = numbers(line)?;
    let at = time(line.split_whitespace().next().unwrap_or_default())?;
    Ok((at, pose_from_quaternion([qw, qx, qy, qz], [x, y, z])?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_keep_all_their_digits() {
        let ns = |line: &str| time(line).map(|time| time.0);
        assert_eq!(ns("1673884185.589118"), Ok(1_673_884_185_589_118_000));
        assert_eq!(ns(" 1673884185.589118123456\r"), Ok(1_673_884_185_589_118_123));
        assert_eq!(ns("1.673884185589118004e+09"), Ok(1_673_884_185_589_118_000));
        assert_eq!(
            (ns("0.066666667"), ns("-0.5"), ns("7")),
            (Ok(66_666_667), Ok(-500_000_000), Ok(7_000_000_000))
        );
        assert_eq!(ns("1e10"), Err("10000000000 s".into()));
        assert_eq!(ns("1 2"), Err("2 numbers".into()));
    }
}
