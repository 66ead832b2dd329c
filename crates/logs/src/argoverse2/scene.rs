//! A scene from its log: the reader's conductor.

use std::collections::HashMap;
use std::path::Path;

use occlabel_core::{Fault, Loss, PointsOf, Pose, Scene, SweepHeader, Timestamp};
use occlabel_disk as disk;

use super::cameras::{LENSES, read_cameras};
use super::lidars::Lidars;
use super::poses::{Mountings, poses};
use super::table::Table;
use super::times::files_by_time;
use super::tracks::read_tracks;
use super::{LIDAR, POSES};
use crate::ReadOptions;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;

/// The boxes of a log; absent from logs of the test split.
const BOXES: &str = "annotations.feather";
/// The sensors' mountings.
pub(super) const MOUNTINGS: &str = "calibration/egovehicle_SE3_sensor.feather";
/// The sweeps.
const SWEEPS: &str = "sensors/lidar/";

/// The files of a log that are no sweep's.
pub(super) const TABLES: [&str; 4] = [POSES, BOXES, MOUNTINGS, LENSES];

/// Whether a folder is a log.
pub(super) fn is_log(folder: &Path) -> bool {
    disk::is_file(&folder.join(POSES))
}

/// Everything of a scene but its points (labels.md section 2). `folder` ends with a `/`, or is empty.
///
/// # Errors
/// If the name cannot be that of a folder, or a table cannot be used.
pub(super) fn build_scene(
    root: &Path,
    options: &ReadOptions,
    name: &str,
    folder: &str,
) -> Result<Scene, Fault> {
    if !is_folder_name(name) {
        let expected = "a log's name of A-Z, a-z, 0-9, `.`, `_` and `-`";
        return Err(Fault::new("scene-name", name, expected, format!("`{name}`")));
    }
    let mut notes = Notes::default();
    let mountings = Mountings::read(root, format!("{folder}{MOUNTINGS}"))?;
    let lidars = Lidars::of(&mountings)?;
    let ego_poses = ego_poses(root, &format!("{folder}{POSES}"), &mut notes)?;
    let boxes = format!("{folder}{BOXES}");
    let (tracks, annotated) = match disk::is_file(&root.join(&boxes)) {
        true => read_tracks(root, &boxes, options, &ego_poses, &mut notes)?,
        false => Default::default(),
    };
    let mut sweeps = Vec::new();
    for sweep in files_by_time(root, &format!("{folder}{SWEEPS}"), &[".feather"])? {
        let header = sweep_header(name, sweep, &lidars, &ego_poses);
        sweeps.extend(notes.accept(Loss::Keyframe, header));
    }
    let is_annotated = |sweep: &SweepHeader| annotated.contains(&sweep.time);
    let (cameras, exposures) = read_cameras((root, folder), &mountings, &ego_poses, &mut notes)?;
    let keyframes = keyframes(&options.keyframes, name, &sweeps, is_annotated, &exposures, &notes)?;
    let (warnings, refused) = notes.finish();
    let name = name.to_owned();
    Ok(Scene { name, sweeps, tracks, cameras, keyframes, exposures, warnings, refused })
}

/// Poses by time; one that is none is left out and noted.
fn ego_poses(root: &Path, file: &str, notes: &mut Notes) -> Result<HashMap<i64, Pose>, Fault> {
    let table = Table::read(root, file)?;
    let rows = table.integers("timestamp_ns")?.into_iter().zip(poses(&table)?);
    let mut by_time = HashMap::new();
    for (time_ns, pose) in rows {
        match pose {
            Ok(pose) => drop(by_time.insert(time_ns, pose)),
            Err(found) => {
                let fault = Fault::new("ego-pose", file, "a pose", found);
                notes.warn(fault.record(time_ns.to_string()));
            }
        }
    }
    Ok(by_time)
}

fn sweep_header(
    scene: &str,
    (time_ns, file): (i64, String),
    lidars: &Lidars,
    ego_poses: &HashMap<i64, Pose>,
) -> Result<SweepHeader, Fault> {
    let pose = ego_poses.get(&time_ns);
    let without = || Fault::new("ego-pose", &file, "an ego pose of the sweep's time", "none");
    Ok(SweepHeader {
        time: Timestamp(time_ns),
        lidar: LIDAR.to_owned(),
        source_id: format!("{scene}/{time_ns}"),
        world_from_ego: *pose.ok_or_else(without)?,
        ego_from_lidar: lidars.ego_from_up,
        labelled: false,
        file,
        points_of: PointsOf::Moment,
    })
}
