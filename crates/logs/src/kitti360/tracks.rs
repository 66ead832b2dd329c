//! The tracks of a drive, from its boxes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use occlabel_core::{Box3, BoxTrack, Fault, Loss, SweepHeader, Timestamp, TrackId};

use super::boxes::{Frames, Object, read_objects};
use super::classes::movable_name;
use super::stamps::Stamps;
use crate::ReadOptions;
use crate::files::read_file;
use crate::notes::Notes;

/// Boxes by track: its category, and the box of each time.
type Boxes = BTreeMap<String, (&'static str, BTreeMap<Timestamp, Box3>)>;

/// The tracks of what may move, 1..N in byte order of their ids; none, and a word, if the file is
/// absent. `sweeps` are those of the drive by frame: what stands still has its box at each of them.
///
/// # Errors
/// If the file cannot be used, or a category is unknown.
pub(super) fn read_tracks(
    (root, file): (&Path, &str),
    options: &ReadOptions,
    stamps: &Stamps,
    sweeps: &BTreeMap<usize, SweepHeader>,
    notes: &mut Notes,
) -> Result<Vec<BoxTrack>, Fault> {
    if !root.join(file).is_file() {
        notes.warn(Fault::new("boxes-absent", file, "the boxes of the drive", "none"));
        return Ok(Vec::new());
    }
    let mut by_id = Boxes::new();
    for object in read_objects(&read_file(root, file)?, file)? {
        let Some(category) = movable_name(object.class) else { continue };
        let id = format!("{category}-{}", object.instance);
        let (_, boxes) = by_id.entry(id.clone()).or_insert((category, BTreeMap::new()));
        let added = add(object, file, boxes, stamps, sweeps);
        notes.accept(Loss::Annotation, added.map_err(|fault| fault.record(id)));
    }
    by_id.retain(|_, (_, boxes)| !boxes.is_empty());
    check_categories(file, options, &by_id, notes)?;
    tracks(by_id, file, options)
}

/// Refuses or notes the categories that the taxonomy does not name.
fn check_categories(
    file: &str,
    options: &ReadOptions,
    by_id: &Boxes,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let categories: BTreeSet<&str> = by_id.values().map(|(category, _)| *category).collect();
    let is_unknown = |name: &&str| !options.taxonomy.boxes.contains_key(*name);
    let unknown = categories.into_iter().filter(is_unknown).map(|name| format!("`{name}`"));
    let found = unknown.collect::<Vec<_>>().join(", ");
    if !found.is_empty() {
        let fault = Fault::new("unknown-category", file, "categories of the taxonomy", found);
        notes.warn(options.unknown(fault)?);
    }
    Ok(())
}

/// Adds the boxes of an object to its track.
fn add(
    object: Object,
    file: &str,
    boxes: &mut BTreeMap<Timestamp, Box3>,
    stamps: &Stamps,
    sweeps: &BTreeMap<usize, SweepHeader>,
) -> Result<(), Fault> {
    let expected = "a box with a size and a place";
    let boxed = object.boxed.map_err(|found| Fault::new("box-pose", file, expected, found))?;
    match object.frames {
        Frames::At(frame) => {
            if boxes.insert(stamps.time(frame)?, boxed).is_some() {
                let expected = "one box of a track at a time";
                return Err(Fault::new("track-time", file, expected, format!("two at {frame}")));
            }
        }
        // Windows overlap: the first that has the object places it.
        Frames::From(first, last) => {
            let times = sweeps.range(first..=last.max(first)).map(|(_, sweep)| sweep.time);
            for time in times {
                boxes.entry(time).or_insert_with(|| boxed.clone());
            }
        }
    }
    Ok(())
}

fn tracks(by_id: Boxes, file: &str, options: &ReadOptions) -> Result<Vec<BoxTrack>, Fault> {
    let mut tracks = Vec::with_capacity(by_id.len());
    for (source_id, (category, boxes)) in by_id {
        let id = u16::try_from(tracks.len() + 1).map_err(|_| {
            let expected = format!("at most {} tracks in a scene", u16::MAX);
            Fault::new("track-count", file, expected, "more")
        })?;
        let Some(meaning) = options.box_meaning(category) else { continue };
        let (id, category, boxes) = (TrackId(id), category.to_owned(), boxes.into_iter().collect());
        tracks.push(BoxTrack { id, source_id, category, meaning, boxes });
    }
    Ok(tracks)
}
