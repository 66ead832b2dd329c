//! The tracks of a log.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss, Pose, Timestamp, TrackId};

use super::poses::poses;
use super::table::Table;
use crate::ReadOptions;
use crate::notes::Notes;

/// Boxes by track: the category, and each time's box.
type Boxes = BTreeMap<String, (String, BTreeMap<Timestamp, Box3>)>;

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
    let by_id = boxes_by_id(root, file, ego_poses, notes)?;
    check_categories(file, options, &by_id, notes)?;
    let times = by_id.values().flat_map(|(_, boxes)| boxes.keys().copied()).collect();
    let mut tracks = Vec::with_capacity(by_id.len());
    for (source_id, (category, boxes)) in by_id {
        let id = u16::try_from(tracks.len() + 1).map_err(|_| {
            let expected = format!("at most {} tracks in a scene", u16::MAX);
            Fault::new("track-count", file, expected, "more")
        })?;
        let Some(meaning) = options.box_meaning(&category) else { continue };
        let boxes = boxes.into_iter().collect();
        tracks.push(BoxTrack { id: TrackId(id), source_id, category, meaning, boxes });
    }
    Ok((tracks, times))
}

fn boxes_by_id(
    root: &Path,
    file: &str,
    ego_poses: &HashMap<i64, Pose>,
    notes: &mut Notes,
) -> Result<Boxes, Fault> {
    let table = Table::read(root, file)?;
    let (times, ids) = (table.integers("timestamp_ns")?, table.texts("track_uuid")?);
    let (categories, poses) = (table.texts("category")?, poses(&table)?);
    let sides = ["length_m", "width_m", "height_m"].map(|name| table.reals(name));
    let [length, width, height] = sides;
    let (length, width, height) = (length?, width?, height?);
    let mut by_id = Boxes::new();
    for (row, ego_from_box) in poses.into_iter().enumerate() {
        let located = |fault: Fault| fault.record(format!("row {row}, {}", ids[row]));
        let size_m = Vector3::new(length[row], width[row], height[row]);
        let ego = ego_poses.get(&times[row]);
        let boxed = read_box(file, ego, ego_from_box, size_m).map_err(located);
        let Some(boxed) = notes.accept(Loss::Annotation, boxed) else { continue };
        let empty = || (categories[row].clone(), BTreeMap::new());
        let (category, boxes) = by_id.entry(ids[row].clone()).or_insert_with(empty);
        if *category != categories[row] {
            let fault = Fault::new("track-type", file, category.clone(), &categories[row]);
            notes.refuse(Loss::Annotation, located(fault));
        } else if boxes.insert(Timestamp(times[row]), boxed).is_some() {
            let expected = "one box of a track at a time";
            return Err(located(Fault::new("track-time", file, expected, "two")));
        }
    }
    Ok(by_id)
}

/// A box in world: annotations stand in the ego frame of their time.
fn read_box(
    file: &str,
    world_from_ego: Option<&Pose>,
    ego_from_box: Result<Pose, String>,
    size_m: Vector3<f64>,
) -> Result<Box3, Fault> {
    if !size_m.iter().all(|side| side.is_finite() && *side > 0.0) {
        let found = format!("{} x {} x {} m", size_m.x, size_m.y, size_m.z);
        return Err(Fault::new("box-size", file, "length, width and height above 0", found));
    }
    let ego_from_box =
        ego_from_box.map_err(|found| Fault::new("box-pose", file, "a pose", found))?;
    let without = || Fault::new("ego-pose", file, "an ego pose of the box's time", "none");
    Ok(Box3 { world_from_box: world_from_ego.ok_or_else(without)? * ego_from_box, size_m })
}

/// Refuses or notes the categories that the taxonomy does not name, with how many boxes are theirs.
fn check_categories(
    file: &str,
    options: &ReadOptions,
    by_id: &Boxes,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let mut unknown: BTreeMap<&str, usize> = BTreeMap::new();
    for (category, boxes) in by_id.values() {
        if !options.taxonomy.boxes.contains_key(category) {
            *unknown.entry(category).or_default() += boxes.len();
        }
    }
    if unknown.is_empty() {
        return Ok(());
    }
    let told = |(name, count): (&&str, &usize)| format!("`{name}` of {count} boxes");
    let found = unknown.iter().map(told).collect::<Vec<_>>().join(", ");
    let fault = Fault::new("unknown-category", file, "categories of the taxonomy", found);
    notes.warn(options.unknown(fault)?);
    Ok(())
}
