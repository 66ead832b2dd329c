//! The tracks of a drive, from its boxes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use occlabel_core::{BoxTrack, Fault, Loss, SweepHeader, Timestamp};
use occlabel_disk as disk;

use super::boxes::{Frames, Object, read_objects};
use super::classes::movable_name;
use super::stamps::Stamps;
use crate::ReadOptions;
use crate::files::read_file;
use crate::notes::Notes;
use crate::tracks::{TrackBox, TrackBoxes};

/// The tracks of what may move, 1..N in byte order of their ids; none, and a word, if the file is
/// absent. `sweeps` are those of the drive by frame: what stands still has its box at each of them.
///
/// # Errors
/// If the file cannot be used, a track has two boxes at a frame, or a category is unknown.
pub(super) fn read_tracks(
    (root, file): (&Path, &str),
    options: &ReadOptions,
    stamps: &Stamps,
    sweeps: &BTreeMap<usize, SweepHeader>,
    notes: &mut Notes,
) -> Result<Vec<BoxTrack>, Fault> {
    if !disk::is_file(&root.join(file)) {
        notes.warn(Fault::new("boxes-absent", file, "the boxes of the drive", "none"));
        return Ok(Vec::new());
    }
    let mut tracks = TrackBoxes::default();
    for object in read_objects(&read_file(root, file)?, file)? {
        let Some(category) = movable_name(object.class) else { continue };
        let track = format!("{category}-{}", object.instance);
        let fault = |rule, expected, found| Fault::new(rule, file, expected, found).record(&track);
        let times = times(&object, &track, &tracks, stamps, sweeps);
        let boxed = object
            .boxed
            .map_err(|found| fault("box-pose", "a box with a size and a place".to_owned(), found));
        let placed = boxed.and_then(|boxed| Ok((times?, boxed)));
        let Some((times, boxed)) = notes.accept(Loss::Annotation, placed) else { continue };
        for time in times {
            let row = TrackBox { track: &track, category, time, boxed: boxed.clone() };
            tracks.add(row, notes, fault)?;
        }
    }
    tracks.tracks(options, file, notes)
}

/// When an object stands where its box says: of what stands still, at the sweeps that have no box of
/// it yet, as windows overlap.
fn times(
    object: &Object,
    track: &str,
    tracks: &TrackBoxes,
    stamps: &Stamps,
    sweeps: &BTreeMap<usize, SweepHeader>,
) -> Result<BTreeSet<Timestamp>, Fault> {
    match object.frames {
        Frames::At(frame) => Ok([stamps.time(frame)?].into()),
        Frames::From(first, last) => {
            let times = sweeps.range(first..=last.max(first)).map(|(_, sweep)| sweep.time);
            Ok(times.filter(|time| tracks.at(track, *time).is_none()).collect())
        }
    }
}
