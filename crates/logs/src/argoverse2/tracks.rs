//! The tracks of a log.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss, Pose, Timestamp};

use super::poses::poses;
use super::table::Table;
use crate::ReadOptions;
use crate::notes::Notes;
use crate::tracks::{A_SIZE, TrackBox, TrackBoxes, checked_size};

/// The tracks, 1..N in byte order of their ids, and the annotated times. A box that is none is
/// refused.
///
/// # Errors
/// If the file cannot be used, a track has two boxes at a time, or a category is unknown.
pub(super) fn read_tracks(
    root: &Path,
    file: &str,
    options: &ReadOptions,
    ego_poses: &HashMap<i64, Pose>,
    notes: &mut Notes,
) -> Result<(Vec<BoxTrack>, BTreeSet<Timestamp>), Fault> {
    let tracks = gather(root, file, ego_poses, notes)?.tracks(options, file, notes)?;
    let boxes = tracks.iter().flat_map(|track| &track.boxes);
    let times = boxes.map(|(time, _)| *time).collect();
    Ok((tracks, times))
}

fn gather(
    root: &Path,
    file: &str,
    ego_poses: &HashMap<i64, Pose>,
    notes: &mut Notes,
) -> Result<TrackBoxes, Fault> {
    let table = Table::read(root, file)?;
    let (times, ids) = (table.integers("timestamp_ns")?, table.texts("track_uuid")?);
    let (categories, poses) = (table.texts("category")?, poses(&table)?);
    let sides = ["length_m", "width_m", "height_m"].map(|name| table.reals(name));
    let [length, width, height] = sides;
    let (length, width, height) = (length?, width?, height?);
    let mut tracks = TrackBoxes::default();
    for (row, ego_from_box) in poses.into_iter().enumerate() {
        let located = |fault: Fault| fault.record(format!("row {row}, {}", ids[row]));
        let size_m = Vector3::new(length[row], width[row], height[row]);
        let ego = ego_poses.get(&times[row]);
        let boxed = read_box(file, ego, ego_from_box, size_m).map_err(located);
        let Some(boxed) = notes.accept(Loss::Annotation, boxed) else { continue };
        let (track, category) = (ids[row].as_str(), categories[row].as_str());
        let row = TrackBox { track, category, time: Timestamp(times[row]), boxed };
        tracks.add(row, notes, |rule, expected, found| {
            located(Fault::new(rule, file, expected, found))
        })?;
    }
    Ok(tracks)
}

/// A box in world: annotations stand in the ego frame of their time.
fn read_box(
    file: &str,
    world_from_ego: Option<&Pose>,
    ego_from_box: Result<Pose, String>,
    size_m: Vector3<f64>,
) -> Result<Box3, Fault> {
    let size_m =
        checked_size(size_m).map_err(|found| Fault::new("box-size", file, A_SIZE, found))?;
    let ego_from_box =
        ego_from_box.map_err(|found| Fault::new("box-pose", file, "a pose", found))?;
    let without = || Fault::new("ego-pose", file, "an ego pose of the box's time", "none");
    Ok(Box3 { world_from_box: world_from_ego.ok_or_else(without)? * ego_from_box, size_m })
}
