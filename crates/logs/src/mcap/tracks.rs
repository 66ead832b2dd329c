//! The tracks of a recording.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss, McapSettings, Timestamp, TrackId};

use super::frames::checked_pose;
use super::layout::FrameRoles;
use super::messages::Cube;
use super::recording::Recording;
use crate::ReadOptions;
use crate::notes::Notes;

/// A track's boxes, as they come.
struct Boxes<'a> {
    category: &'a str,
    boxes: BTreeMap<Timestamp, Box3>,
}

/// The tracks, 1..N in byte order of their ids. A box that is none is refused; a track that has no
/// other is left out.
///
/// # Errors
/// If a track has two boxes at a time, a category is unknown, or there are more than 65535 tracks.
pub(super) fn tracks(
    recording: &Recording,
    options: (&ReadOptions, &McapSettings),
    roles: &FrameRoles,
    notes: &mut Notes,
) -> Result<Vec<BoxTrack>, Fault> {
    let (read, settings) = options;
    let by_id = boxes_by_id(recording, roles, notes)?;
    let name = |raw: &str| settings.categories.get(raw).map_or(raw, String::as_str).to_owned();
    check_categories(recording, read, by_id.values().map(|track| name(track.category)), notes)?;
    let mut tracks = Vec::with_capacity(by_id.len());
    for (source_id, track) in by_id {
        let category = name(track.category);
        let Ok(id) = u16::try_from(tracks.len() + 1) else {
            let expected = format!("at most {} tracks in a scene", u16::MAX);
            return Err(Fault::new("track-count", &recording.file, expected, "more"));
        };
        let Some(meaning) = read.box_meaning(&category) else { continue };
        let boxes = track.boxes.into_iter().collect();
        tracks.push(BoxTrack {
            id: TrackId(id),
            source_id: source_id.to_owned(),
            category,
            meaning,
            boxes,
        });
    }
    Ok(tracks)
}

fn boxes_by_id<'a>(
    recording: &'a Recording,
    roles: &FrameRoles,
    notes: &mut Notes,
) -> Result<BTreeMap<&'a str, Boxes<'a>>, Fault> {
    let mut by_id: BTreeMap<&str, Boxes<'_>> = BTreeMap::new();
    for cube in &recording.cubes {
        let Some(boxed) = accept_box(recording, roles, cube, notes) else { continue };
        let empty = || Boxes { category: &cube.category, boxes: BTreeMap::new() };
        let track = by_id.entry(&cube.track).or_insert_with(empty);
        if track.category != cube.category {
            let expected = format!("category `{}`", track.category);
            let found = format!("`{}`", cube.category);
            notes.refuse(
                Loss::Annotation,
                fault(recording, cube, "track-category", &expected, found),
            );
            continue;
        }
        let before = track.boxes.insert(cube.header.time, boxed.clone());
        if before.is_some_and(|before| before != boxed) {
            let expected = "one box of a track at a time";
            return Err(fault(recording, cube, "track-time", expected, "two".into()));
        }
    }
    Ok(by_id)
}

fn accept_box(
    recording: &Recording,
    roles: &FrameRoles,
    cube: &Cube,
    notes: &mut Notes,
) -> Option<Box3> {
    let boxed = read_box(recording, roles, cube);
    let loss = match boxed {
        Err(("box-pose", _)) => recording.loss_without_pose(Loss::Annotation),
        _ => Loss::Annotation,
    };
    let boxed = boxed.map_err(|(rule, found)| {
        let expected = "a box with an id, sides above 0 and a place in the world";
        fault(recording, cube, rule, expected, found)
    });
    notes.accept(loss, boxed)
}

/// A box in world, or the broken rule and what was found.
fn read_box(
    recording: &Recording,
    roles: &FrameRoles,
    cube: &Cube,
) -> Result<Box3, (&'static str, String)> {
    if cube.track.is_empty() {
        return Err(("box-id", "no id".into()));
    }
    if !cube.size_m.iter().all(|side| side.is_finite() && *side > 0.0) {
        return Err(("box-size", format!("sides of {:?} m", cube.size_m)));
    }
    let (frame_from_box, _) = checked_pose(&cube.pose).map_err(|found| ("box-pose", found))?;
    let frame = cube.header.frame.as_str();
    let world_from_box = match frame == roles.world {
        true => frame_from_box,
        false => {
            let world_from_frame = recording.frames.pose(&roles.world, frame, cube.header.time);
            world_from_frame.map_err(|found| ("box-pose", found))? * frame_from_box
        }
    };
    Ok(Box3 { world_from_box, size_m: Vector3::from(cube.size_m) })
}

/// Refuses or notes the categories that the taxonomy does not name.
fn check_categories(
    recording: &Recording,
    read: &ReadOptions,
    categories: impl Iterator<Item = String>,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let mut unknown: BTreeMap<String, usize> = BTreeMap::new();
    for category in categories.filter(|name| !read.taxonomy.boxes.contains_key(name)) {
        *unknown.entry(category).or_default() += 1;
    }
    if unknown.is_empty() {
        return Ok(());
    }
    let list = unknown.iter().map(|(name, count)| format!("`{name}` of {count} tracks"));
    let (expected, found) = ("box categories of the taxonomy", list.collect::<Vec<_>>().join(", "));
    let fault = Fault::new("unknown-category", &recording.file, expected, found);
    let hint =
        "`reader.mcap.taxonomy` names another taxonomy, `[reader.mcap.categories]` what they mean";
    notes.warn(read.unknown(fault).map_err(|fault| fault.hint(hint))?);
    Ok(())
}

/// The times at which there are boxes, or none were found.
pub(super) fn annotated_times(recording: &Recording) -> BTreeSet<Timestamp> {
    recording.annotated.iter().copied().collect()
}

fn fault(
    recording: &Recording,
    cube: &Cube,
    rule: &'static str,
    expected: &str,
    found: String,
) -> Fault {
    let record = format!("box of `{}` at {} ns", cube.track, cube.header.time.0);
    Fault::new(rule, &recording.file, expected, found).record(record)
}
