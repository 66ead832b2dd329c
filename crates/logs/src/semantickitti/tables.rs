//! The text files of a sequence.

use std::path::Path;

use occlabel_core::{Fault, Pose, Timestamp};

use super::mounting::ego_from_camera;
use super::sequences::Sequence;
use crate::files::check_present;
use crate::number_rows::{numbers, read_lines};
use crate::transform::pose_from_rows;

/// What a row of a pose has to be.
const A_POSE: &str = "12 numbers of a rigid transform";
/// Farthest time from the beginning, seconds: such a number of nanoseconds fits an integer.
const LATEST_S: f64 = 9e9;

/// Mounting, poses and times of a sequence; a scan's number is its line.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) ego_from_lidar: Pose,
    poses: Vec<String>,
    times: Vec<String>,
    files: [String; 3],
}

impl Tables {
    /// Reads the three files.
    ///
    /// # Errors
    /// If one cannot be read, or calib.txt holds no usable `Tr`.
    pub(super) fn read(root: &Path, sequence: &Sequence) -> Result<Self, Fault> {
        let files = sequence.tables();
        check_present(root, &files)?;
        let [calib, poses, times] = &files;
        let lines = read_lines(root, calib)?;
        let row = lines.iter().find_map(|line| line.trim_start().strip_prefix("Tr:"));
        let camera_from_lidar = row
            .ok_or_else(|| "no such line".to_owned())
            .and_then(pose)
            .map_err(|found| Fault::new("lidar-pose", calib, format!("Tr: {A_POSE}"), found))?;
        Ok(Self {
            ego_from_lidar: ego_from_camera() * camera_from_lidar,
            poses: read_lines(root, poses)?,
            times: read_lines(root, times)?,
            files,
        })
    }

    /// How many scans have a pose.
    pub(super) fn posed(&self) -> usize {
        self.poses.len()
    }

    /// The ego vehicle's pose at a scan. World is the ego vehicle's frame at pose zero: at the first
    /// scan, as a rule.
    ///
    /// # Errors
    /// If the scan has no line, or that is no rigid transform.
    pub(super) fn world_from_ego(&self, scan: usize) -> Result<Pose, Fault> {
        let row =
            self.poses.get(scan).ok_or_else(|| no_line(&self.poses)).and_then(|row| pose(row));
        let first_from_now =
            row.map_err(|found| line_fault("scan-pose", &self.files[1], scan, A_POSE, found))?;
        Ok(ego_from_camera() * first_from_now * ego_from_camera().inverse())
    }

    /// When a scan was taken.
    ///
    /// # Errors
    /// If the scan has no line, or that is no time.
    pub(super) fn time(&self, scan: usize) -> Result<Timestamp, Fault> {
        let line = self.times.get(scan).ok_or_else(|| no_line(&self.times));
        line.and_then(|line| time(line)).map_err(|found| {
            line_fault("scan-time", &self.files[2], scan, "a time in seconds", found)
        })
    }
}

pub(crate) fn pose(row: &str) -> Result<Pose, String> {
    pose_from_rows(&numbers(row)?)
}

pub(crate) fn time(line: &str) -> Result<Timestamp, String> {
    let [seconds] = numbers(line)?;
    match seconds.abs() < LATEST_S {
        true => Ok(Timestamp((seconds * 1e9).round() as i64)),
        false => Err(format!("{seconds} s")),
    }
}

fn no_line(lines: &[String]) -> String {
    format!("{} lines", lines.len())
}

fn line_fault(rule: &'static str, file: &str, scan: usize, expected: &str, found: String) -> Fault {
    Fault::new(rule, file, expected, found).record(format!("line {}", scan + 1))
}
