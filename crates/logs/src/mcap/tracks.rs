//! The tracks of a recording.

use std::collections::BTreeSet;

use occlabel_core::{Box3, BoxTrack, Fault, Loss, McapSettings, Timestamp};

use super::frames::checked_pose;
use super::layout::FrameRoles;
use super::messages::Cube;
use super::recording::Recording;
use crate::ReadOptions;
use crate::notes::Notes;
use crate::tracks::{TrackBox, TrackBoxes, UNKNOWN_CATEGORY, checked_size};

/// What can be done about categories that the taxonomy does not name.
const CATEGORIES_HINT: &str = "`reader.mcap.taxonomy` names another taxonomy, \
    `[reader.mcap.categories]` what they mean, `--unknown-as CLASS` a class for all";

/// The tracks, 1..N in byte order of their ids. A box that is none is refused; a track that has no
/// other is left out. One that is said again, all the same, counts once.
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
    let mut tracks = TrackBoxes::default();
    for cube in &recording.cubes {
        let located = |rule, expected, found| fault(recording, cube, rule, expected, found);
        let Some(boxed) = accept_box(recording, roles, cube, notes) else { continue };
        let (track, time) = (cube.track.as_str(), cube.header.time);
        if tracks.at(track, time) != Some(&boxed) {
            let category = settings.categories.get(&cube.category).unwrap_or(&cube.category);
            tracks.add(TrackBox { track, category, time, boxed }, notes, located)?;
        }
    }
    let tracks = tracks.tracks(read, &recording.file, notes).map_err(|fault| match fault.rule {
        UNKNOWN_CATEGORY => fault.hint(CATEGORIES_HINT),
        _ => fault,
    })?;
    notes.hint(UNKNOWN_CATEGORY, CATEGORIES_HINT);
    Ok(tracks)
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
        fault(recording, cube, rule, expected.into(), found)
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
    let size_m = checked_size(cube.size_m.into()).map_err(|found| ("box-size", found))?;
    let (frame_from_box, _) = checked_pose(&cube.pose).map_err(|found| ("box-pose", found))?;
    let frame = cube.header.frame.as_str();
    let world_from_box = match frame == roles.world {
        true => frame_from_box,
        false => {
            let world_from_frame = recording.frames.pose(&roles.world, frame, cube.header.time);
            world_from_frame.map_err(|found| ("box-pose", found))? * frame_from_box
        }
    };
    Ok(Box3 { world_from_box, size_m })
}

/// The times at which there are boxes, or none were found.
pub(super) fn annotated_times(recording: &Recording) -> BTreeSet<Timestamp> {
    recording.annotated.iter().copied().collect()
}

fn fault(
    recording: &Recording,
    cube: &Cube,
    rule: &'static str,
    expected: String,
    found: String,
) -> Fault {
    let record = format!("box of `{}` at {} ns", cube.track, cube.header.time.0);
    Fault::new(rule, &recording.file, expected, found).record(record)
}
