//! A scene from its drive: the reader's conductor.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

use occlabel_core::{Fault, Loss, PointsOf, Pose, Scene, SweepHeader};
use occlabel_disk as disk;

use super::LIDAR;
use super::calibration::Calibration;
use super::cameras::read_cameras;
use super::layout::Drive;
use super::poses::{At, Poses};
use super::stamps::Stamps;
use super::tracks::read_tracks;
use crate::ReadOptions;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;

/// A scene, and what reading its points takes.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) scene: Scene,
    /// By frame: the lidar's motion of the turn before, `now_from_before`.
    pub(super) motions: BTreeMap<usize, Pose>,
    /// Files of fused clouds, and the frames of each.
    pub(super) windows: Vec<(String, RangeInclusive<usize>)>,
}

impl Loaded {
    /// Reads everything of a scene but its points (labels.md section 2).
    ///
    /// A frame that has a pose but no scan is a sweep all the same: a missing one. One without a pose
    /// is left out, and noted.
    ///
    /// # Errors
    /// If the drive's name cannot be that of a folder, or a file that it cannot do without is absent
    /// or broken.
    pub(super) fn read(root: &Path, options: &ReadOptions, name: &str) -> Result<Self, Fault> {
        if !is_folder_name(name) {
            let expected = "a folder's name of A-Z, a-z, 0-9, `.`, `_` and `-`";
            return Err(Fault::new("scene-name", name, expected, format!("`{name}`")));
        }
        let (drive, mut notes) = (Drive(name), Notes::default());
        let calibration = Calibration::read(root)?;
        let stamps = Stamps::read(root, drive.stamps())?;
        let poses = Poses::read(root, &drive, &calibration, &mut notes)?;
        let windows = drive.windows(root)?;
        let parts = Parts { root, drive: &drive, calibration: &calibration, stamps: &stamps };
        let by_frame = parts.sweeps(&poses, &windows, &mut notes)?;
        let motions = parts.motions(&by_frame, &poses, &mut notes);
        let boxes = drive.boxes();
        let tracks = read_tracks((root, &boxes), options, &stamps, &by_frame, &mut notes)?;
        let (cameras, exposures) = read_cameras(root, &drive, &calibration, &poses, &mut notes);
        let mut sweeps: Vec<SweepHeader> = by_frame.into_values().collect();
        sweeps.sort_by(|a, b| (a.time, &a.file).cmp(&(b.time, &b.file)));
        let keyframes =
            keyframes(&options.keyframes, name, &sweeps, |_| false, &exposures, &notes)?;
        let (warnings, refused) = notes.finish();
        let name = name.to_owned();
        let scene =
            Scene { name, sweeps, tracks, cameras, keyframes, exposures, warnings, refused };
        Ok(Self { scene, motions, windows })
    }
}

/// What sweeps are made of.
struct Parts<'a> {
    root: &'a Path,
    drive: &'a Drive<'a>,
    calibration: &'a Calibration,
    stamps: &'a Stamps,
}

impl Parts<'_> {
    fn sweeps(
        &self,
        poses: &Poses,
        windows: &[(String, RangeInclusive<usize>)],
        notes: &mut Notes,
    ) -> Result<BTreeMap<usize, SweepHeader>, Fault> {
        let mut frames = self.drive.frames(self.root)?;
        frames.extend(poses.frames());
        let mut sweeps = BTreeMap::new();
        for frame in frames {
            let pose = match poses.at(frame, self.stamps) {
                At::Known(pose) => pose,
                At::Between(pose) => {
                    notes.warn(self.no_pose(frame, "none: it is put between its neighbours"));
                    pose
                }
                At::Nowhere => {
                    notes.warn(self.no_pose(frame, "none: it is left out"));
                    continue;
                }
            };
            let is_fused = windows.iter().any(|(_, frames)| frames.contains(&frame));
            let sweep = self.sweep(frame, pose, is_fused);
            sweeps.extend(notes.accept(Loss::Keyframe, sweep).map(|sweep| (frame, sweep)));
        }
        Ok(sweeps)
    }

    /// Rules are told apart by what became of the frame, so that each stands once with its count.
    fn no_pose(&self, frame: usize, found: &str) -> Fault {
        let rule = if found.ends_with("out") { "pose-absent" } else { "pose-between" };
        let [file, _] = self.drive.poses();
        Fault::new(rule, file, "a pose of each scan", found).record(format!("frame {frame}"))
    }

    fn sweep(
        &self,
        frame: usize,
        world_from_ego: Pose,
        is_fused: bool,
    ) -> Result<SweepHeader, Fault> {
        Ok(SweepHeader {
            time: self.stamps.time(frame)?,
            lidar: LIDAR.to_owned(),
            source_id: format!("{}/{frame:010}", self.drive.0),
            file: self.drive.scan(frame),
            world_from_ego,
            ego_from_lidar: self.calibration.ego_from_lidar,
            labelled: is_fused || disk::is_file(&self.root.join(self.drive.labels(frame))),
            points_of: PointsOf::Moment,
        })
    }

    /// From the frame before, or as if the motion to the frame after had gone on so.
    fn motions(
        &self,
        sweeps: &BTreeMap<usize, SweepHeader>,
        poses: &Poses,
        notes: &mut Notes,
    ) -> BTreeMap<usize, Pose> {
        let lidar_at = |frame: Option<usize>| match poses.at(frame?, self.stamps) {
            At::Known(pose) | At::Between(pose) => Some(pose * self.calibration.ego_from_lidar),
            At::Nowhere => None,
        };
        let mut motions = BTreeMap::new();
        for (&frame, sweep) in sweeps {
            let now = sweep.world_from_lidar();
            let before = lidar_at(frame.checked_sub(1)).map(|before| now.inverse() * before);
            let after = || lidar_at(frame.checked_add(1)).map(|after| after.inverse() * now);
            match before.or_else(after) {
                Some(motion) => drop(motions.insert(frame, motion)),
                None => {
                    let expected = "a pose of the frame before or after";
                    let fault = Fault::new("scan-motion", &sweep.file, expected, "none");
                    notes.warn(fault.record("its points are taken as they are"));
                }
            }
        }
        motions
    }
}
