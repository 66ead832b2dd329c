//! The tracks of a segment.

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use occlabel_core::{Box3, BoxTrack, Fault, Loss, Pose};

use super::classes::box_type;
use super::segment::{BoxLabel, Frame};
use crate::ReadOptions;
use crate::notes::Notes;
use crate::tracks::{A_SIZE, TrackBox, TrackBoxes, checked_size};
use crate::transform::is_place;

/// The tracks of a segment, 1..N in byte order of their ids. A box that is none is refused; a track
/// that has no other is left out.
///
/// # Errors
/// If a track has two boxes in a frame, a type is unknown, or there are more than 65535 tracks.
pub(super) fn scene_tracks(
    options: &ReadOptions,
    frames: &[Frame],
    notes: &mut Notes,
) -> Result<Vec<BoxTrack>, Fault> {
    let mut tracks = TrackBoxes::default();
    for frame in frames {
        for label in &frame.boxes {
            let boxed = read_box(frame, label);
            let Some(boxed) = notes.accept(Loss::Annotation, boxed) else { continue };
            let category = &box_type(label.kind);
            let row = TrackBox { track: &label.track, category, time: frame.time, boxed };
            tracks.add(row, notes, |rule, expected, found| {
                label.place.fault(rule, expected, found)
            })?;
        }
    }
    let file = frames.first().map_or("", |frame| &frame.place.file);
    tracks.tracks(options, file, notes)
}

/// A box in world: it stands upright in the vehicle's frame.
fn read_box(frame: &Frame, label: &BoxLabel) -> Result<Box3, Fault> {
    let BoxLabel { track, center_m, size_m, heading_rad, .. } = label;
    if track.is_empty() {
        return Err(label.place.fault("box-id", "a box with an id", "none"));
    }
    let size_m = checked_size(*size_m)
        .map_err(|found| label.place.fault("box-size", A_SIZE, format!("{found} of `{track}`")))?;
    if !is_place(center_m) || !heading_rad.is_finite() {
        let found = format!("{:?}, {heading_rad} of `{track}`", center_m.as_slice());
        return Err(label.place.fault(
            "box-pose",
            "a finite heading, and a centre of at most 1e9 m",
            found,
        ));
    }
    let world_from_box = frame.world_from_ego * upright(center_m, *heading_rad);
    Ok(Box3 { world_from_box, size_m })
}

fn upright(center_m: &Vector3<f64>, heading_rad: f64) -> Pose {
    let half = heading_rad / 2.0;
    let turn = Quaternion::new(libm::cos(half), 0.0, 0.0, libm::sin(half));
    Pose::from_parts(Translation3::from(*center_m), UnitQuaternion::new_normalize(turn))
}
