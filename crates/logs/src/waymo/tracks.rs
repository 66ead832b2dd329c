//! The tracks of a segment.

use std::collections::BTreeMap;

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use occlabel_core::{Box3, BoxTrack, Fault, Loss, Pose, Timestamp, TrackId};

use super::classes::box_type;
use super::segment::{BoxLabel, Frame};
use crate::ReadOptions;
use crate::notes::Notes;

/// A track's boxes, as they come.
struct Boxes<'a> {
    kind: i64,
    boxes: BTreeMap<Timestamp, Box3>,
    first: &'a Frame,
}

/// The tracks of a segment, 1..N in byte order of their ids. A box that is none is refused; a track
/// that has no other is left out.
///
/// # Errors
/// If a track has two boxes in a frame, a type is unknown, or there are more than 65535 tracks.
pub(super) fn scene_tracks(
    options: &ReadOptions,
    scene: &str,
    frames: &[Frame],
    notes: &mut Notes,
) -> Result<Vec<BoxTrack>, Fault> {
    let by_id = boxes_by_id(frames, notes)?;
    check_types(options, scene, &by_id, notes)?;
    let mut tracks = Vec::with_capacity(by_id.len());
    for (source_id, track) in by_id {
        let id = TrackId(track_number(tracks.len() + 1, track.first, scene)?);
        let category = box_type(track.kind);
        let Some(meaning) = options.box_meaning(&category) else { continue };
        let boxes = track.boxes.into_iter().collect();
        tracks.push(BoxTrack { id, source_id, category, meaning, boxes });
    }
    Ok(tracks)
}

fn boxes_by_id<'a>(
    frames: &'a [Frame],
    notes: &mut Notes,
) -> Result<BTreeMap<String, Boxes<'a>>, Fault> {
    let mut by_id: BTreeMap<String, Boxes<'a>> = BTreeMap::new();
    for frame in frames {
        for label in &frame.boxes {
            let Some(boxed) = notes.accept(Loss::Annotation, read_box(frame, label)) else {
                continue;
            };
            let empty = || Boxes { kind: label.kind, boxes: BTreeMap::new(), first: frame };
            let track = by_id.entry(label.track.clone()).or_insert_with(empty);
            if track.kind != label.kind {
                let expected = format!("type {} of `{}`", box_type(track.kind), label.track);
                let fault = label.place.fault("track-type", expected, box_type(label.kind));
                notes.refuse(Loss::Annotation, fault);
            } else if track.boxes.insert(frame.time, boxed).is_some() {
                let found = format!("two of `{}`", label.track);
                return Err(label.place.fault("track-time", "one box of a track at a time", found));
            }
        }
    }
    Ok(by_id)
}

/// A box in world: it stands upright in the vehicle's frame.
fn read_box(frame: &Frame, label: &BoxLabel) -> Result<Box3, Fault> {
    let BoxLabel { track, center_m, size_m, heading_rad, .. } = label;
    if track.is_empty() {
        return Err(label.place.fault("box-id", "a box with an id", "none"));
    }
    if !size_m.iter().all(|side| side.is_finite() && *side > 0.0) {
        let found = format!("{} x {} x {} m of `{track}`", size_m.x, size_m.y, size_m.z);
        return Err(label.place.fault("box-size", "length, width and height above 0", found));
    }
    if !center_m.iter().chain([heading_rad]).all(|number| number.is_finite()) {
        let found = format!("{:?}, {heading_rad} of `{track}`", center_m.as_slice());
        return Err(label.place.fault("box-pose", "a finite centre and heading", found));
    }
    let world_from_box = frame.world_from_ego * upright(center_m, *heading_rad);
    Ok(Box3 { world_from_box, size_m: *size_m })
}

fn upright(center_m: &Vector3<f64>, heading_rad: f64) -> Pose {
    let half = heading_rad / 2.0;
    let turn = Quaternion::new(libm::cos(half), 0.0, 0.0, libm::sin(half));
    Pose::from_parts(Translation3::from(*center_m), UnitQuaternion::new_normalize(turn))
}

fn track_number(number: usize, first: &Frame, scene: &str) -> Result<u16, Fault> {
    u16::try_from(number).map_err(|_| {
        let expected = format!("at most {} tracks in a scene", u16::MAX);
        Fault::new("track-count", &first.place.file, expected, "more").record(scene)
    })
}

/// Refuses or notes the types that the taxonomy does not name, with how many boxes are theirs.
fn check_types(
    options: &ReadOptions,
    scene: &str,
    by_id: &BTreeMap<String, Boxes<'_>>,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let mut unknown: BTreeMap<String, (usize, &Frame)> = BTreeMap::new();
    for track in by_id.values() {
        let name = box_type(track.kind);
        if !options.taxonomy.boxes.contains_key(&name) {
            unknown.entry(name).or_insert((0, track.first)).0 += track.boxes.len();
        }
    }
    let Some((_, first)) = unknown.values().next() else { return Ok(()) };
    let list =
        |(name, (count, _)): (&String, &(usize, &Frame))| format!("`{name}` of {count} boxes");
    let found = unknown.iter().map(list).collect::<Vec<_>>().join(", ");
    let expected = "box types of the taxonomy";
    let fault = Fault::new("unknown-category", &first.place.file, expected, found).record(scene);
    notes.warn(options.unknown(fault)?);
    Ok(())
}
