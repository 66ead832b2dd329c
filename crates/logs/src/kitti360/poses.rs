//! Where the vehicle was: known at some frames only.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{Fault, Loss, Pose, slerp};
use occlabel_disk as disk;

use super::calibration::Calibration;
use super::cameras::rectification;
use super::layout::Drive;
use super::stamps::Stamps;
use crate::notes::Notes;
use crate::number_rows::{numbers, read_lines};
use crate::transform::{pose_from_matrix, pose_from_rows};

/// Between poses farther apart than this nothing is known, seconds.
const LARGEST_GAP_S: f64 = 1.0;

/// `world_from_ego` by frame. World is the log's own, z up.
#[derive(Debug)]
pub(super) struct Poses {
    by_frame: BTreeMap<usize, Pose>,
}

/// A pose, and whether it stands between known ones.
pub(super) enum At {
    Known(Pose),
    Between(Pose),
    Nowhere,
}

impl Poses {
    /// Reads poses.txt, or cam0_to_world.txt where that is absent. A line that is no pose is
    /// refused.
    ///
    /// # Errors
    /// If neither can be read.
    pub(super) fn read(
        root: &Path,
        drive: &Drive,
        calibration: &Calibration,
        notes: &mut Notes,
    ) -> Result<Self, Fault> {
        let [of_imu, of_camera] = drive.poses();
        let imu_from_ego = calibration.ego_from_imu.inverse();
        if disk::is_file(&root.join(&of_imu)) || !disk::is_file(&root.join(&of_camera)) {
            let read = |line: &str| {
                let [number, rows @ ..] = numbers::<13>(line)?;
                let rows = rows.first_chunk().ok_or("no rows")?;
                Ok((frame(number)?, pose_from_rows(rows)? * imu_from_ego))
            };
            return Self::of_lines(root, &of_imu, read, notes);
        }
        let imu_from_camera = calibration.imu_from_camera("image_00")?;
        let camera_from_ego = rectification(root, 0)? * imu_from_camera.inverse() * imu_from_ego;
        let read = |line: &str| {
            let [number, rows @ ..] = numbers::<17>(line)?;
            Ok((frame(number)?, pose_from_matrix(&rows)? * camera_from_ego))
        };
        Self::of_lines(root, &of_camera, read, notes)
    }

    fn of_lines(
        root: &Path,
        file: &str,
        read: impl Fn(&str) -> Result<(usize, Pose), String>,
        notes: &mut Notes,
    ) -> Result<Self, Fault> {
        let mut by_frame = BTreeMap::new();
        for (number, line) in read_lines(root, file)?.iter().enumerate() {
            let pose = read(line).map_err(|found| {
                let fault = Fault::new("scan-pose", file, "a frame and its pose", found);
                fault.record(format!("line {}", number + 1))
            });
            by_frame.extend(notes.accept(Loss::Sweep, pose));
        }
        Ok(Self { by_frame })
    }

    /// The frames with a pose of their own.
    pub(super) fn frames(&self) -> impl Iterator<Item = usize> {
        self.by_frame.keys().copied()
    }

    /// The pose at a frame: its own, or by time between the nearest before and after.
    pub(super) fn at(&self, frame: usize, stamps: &Stamps) -> At {
        if let Some(pose) = self.by_frame.get(&frame) {
            return At::Known(*pose);
        }
        self.between(frame, stamps).map_or(At::Nowhere, At::Between)
    }

    fn between(&self, frame: usize, stamps: &Stamps) -> Option<Pose> {
        let (before, from) = self.by_frame.range(..frame).next_back()?;
        let (after, to) = self.by_frame.range(frame..).next()?;
        let time = |frame: usize| stamps.time(frame).ok();
        let (begin, now, end) = (time(*before)?, time(frame)?, time(*after)?);
        let gap_s = end.seconds_since(begin);
        let share = now.seconds_since(begin) / gap_s;
        if gap_s > LARGEST_GAP_S || !(0.0..=1.0).contains(&share) {
            return None;
        }
        Some(part_way(from, to, share))
    }
}

/// A frame's number, which ten digits hold in the names of files.
fn frame(number: f64) -> Result<usize, String> {
    let is_frame = (0.0..1e10).contains(&number) && number.fract() == 0.0;
    is_frame.then_some(number as usize).ok_or_else(|| format!("frame {number}"))
}

/// The pose at a share of the way: the place on a line, the rotation on an arc.
pub(super) fn part_way(from: &Pose, to: &Pose, share: f64) -> Pose {
    let place = from.translation.vector.lerp(&to.translation.vector, share);
    Pose::from_parts(place.into(), slerp(&from.rotation, &to.rotation, share))
}
