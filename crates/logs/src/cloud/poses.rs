//! The poses of a scene: `poses.txt`, in the layout of the TUM benchmark.

use occlabel_core::{Pose, Timestamp};

use super::json::Placement;
use crate::number_rows::numbers;

/// What a line of a pose has to be.
pub(super) const A_POSE: &str = "timestamp tx ty tz qx qy qz qw, a unit quaternion";

/// The time and the pose of a line, `world_from_ego`; none if it is a comment.
///
/// # Errors
/// What was found, if it is neither.
pub(crate) fn pose(line: &str) -> Result<Option<(Timestamp, Pose)>, String> {
    let line = line.trim();
    if line.is_empty() || line.starts_with('#') {
        return Ok(None);
    }
    let (time, rest) = line.split_once(char::is_whitespace).ok_or("one word")?;
    let [x, y, z, qx, qy, qz, qw] = numbers(rest)?;
    let placement = Placement { translation: [x, y, z], rotation: [qw, qx, qy, qz] };
    Ok(Some((nanoseconds(time)?, placement.pose()?)))
}

/// Seconds to the last digit: f64 would round a time since 1970 to a quarter of a microsecond. Digits
/// beyond nanoseconds are cut off.
fn nanoseconds(word: &str) -> Result<Timestamp, String> {
    let found = || format!("`{}` seconds", word.chars().take(40).collect::<String>());
    let (sign, digits) = match word.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, word),
    };
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let is_empty = whole.is_empty() && part.is_empty();
    if is_empty || !is_number(whole) || !is_number(part) {
        return Err(found());
    }
    let part: String = part.chars().chain("000000000".chars()).take(9).collect();
    let nanoseconds: i64 = format!("{whole}{part}").parse().map_err(|_| found())?;
    Ok(Timestamp(sign * nanoseconds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn times_are_exact_to_the_nanosecond() {
        for (word, time) in [
            ("1403636579.763555584", 1_403_636_579_763_555_584),
            ("0.1", 100_000_000),
            ("-2.5", -2_500_000_000),
            ("7", 7_000_000_000),
            (".25", 250_000_000),
            ("1.0000000019", 1_000_000_001),
        ] {
            assert_eq!(nanoseconds(word), Ok(Timestamp(time)), "{word}");
        }
        for word in ["", "-", ".", "1e9", "nan", "1.2.3", "99999999999999999999", "+1", "1_0"] {
            assert!(nanoseconds(word).is_err(), "{word}");
        }
    }

    #[test]
    fn a_line_moves_points_of_the_ego_into_the_world() {
        let (time, pose) = pose("2 1 2 3 0 0 0.70710678 0.70710678").unwrap().unwrap();
        assert_eq!(time, Timestamp(2_000_000_000));
        assert!((pose * Point3::new(1.0, 0.0, 0.5) - Point3::new(1.0, 3.0, 3.5)).norm() < 1e-7);
        assert_eq!(super::pose("# timestamp tx ty"), Ok(None));
    }

    #[test]
    fn lines_that_are_no_poses_are_refused() {
        for line in [
            "1 2 3",
            "1 0 0 0 0 0 0 0",
            "1 0 0 0 0 0 0 2",
            "1 nan 0 0 0 0 0 1",
            "1 1e300 0 0 0 0 0 1",
        ] {
            assert!(pose(line).is_err(), "{line}");
        }
    }
}
