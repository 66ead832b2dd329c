//! The tracks of a sequence, from its frames' boxes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss, SweepHeader, Timestamp};
use serde::Deserialize;

use super::sequence::Sequence;
use crate::ReadOptions;
use crate::files::read_file;
use crate::notes::Notes;
use crate::tracks::{A_SIZE, TrackBox, TrackBoxes, checked_size};
use crate::transform::{A_PLACE, is_place, pose_from_angles};

/// An id that was not seen for more frames than this is given anew: it is another object's (CODa's data
/// report, "3D Bounding Box Annotations").
const ABSENT_FRAMES: usize = 30;

/// The boxes of a frame's file.
#[derive(Deserialize)]
struct FrameBoxes {
    #[serde(rename = "3dbbox")]
    boxes: Vec<Row>,
}

/// A box in the lidar's frame: centre, sides, and turns about x, y and z, radians.
#[derive(Deserialize)]
struct Row {
    #[serde(rename = "classId")]
    category: String,
    #[serde(rename = "instanceId")]
    instance: Instance,
    #[serde(rename = "cX")]
    x: f64,
    #[serde(rename = "cY")]
    y: f64,
    #[serde(rename = "cZ")]
    z: f64,
    #[serde(rename = "l")]
    length: f64,
    #[serde(rename = "w")]
    width: f64,
    #[serde(rename = "h")]
    height: f64,
    #[serde(rename = "r")]
    roll: f64,
    #[serde(rename = "p")]
    pitch: f64,
    #[serde(rename = "y")]
    yaw: f64,
}

/// An id as the data set has it, or as a bare number.
#[derive(Deserialize)]
#[serde(untagged)]
enum Instance {
    Text(String),
    Number(i64),
}

/// The tracks, 1..N in byte order of their ids, and the times of the frames that have boxes. A frame whose
/// file cannot be used is refused, a box that is none too. `sweeps` are those of the sequence by frame.
///
/// # Errors
/// If the folder cannot be listed, a track has two boxes at a frame, or a category is unknown.
pub(super) fn read_tracks(
    root: &Path,
    sequence: &Sequence,
    options: &ReadOptions,
    sweeps: &BTreeMap<usize, SweepHeader>,
    notes: &mut Notes,
) -> Result<(Vec<BoxTrack>, BTreeSet<Timestamp>), Fault> {
    let (mut tracks, mut names) = (TrackBoxes::default(), TrackNames::default());
    let mut annotated = BTreeSet::new();
    for frame in sequence.boxed_frames(root)? {
        let file = sequence.boxes(frame);
        let rows = read_boxes(root, &file, sweeps.get(&frame));
        let Some((sweep, rows)) = notes.accept(Loss::Keyframe, rows) else { continue };
        annotated.insert(sweep.time);
        for row in rows {
            let track = names.name(row.instance.text(), frame);
            let fault =
                |rule, expected, found| Fault::new(rule, &file, expected, found).record(&track);
            let boxed = row.boxed(sweep).map_err(|(expected, found)| fault("box", expected, found));
            let Some(boxed) = notes.accept(Loss::Annotation, boxed) else { continue };
            let row = TrackBox { track: &track, category: &row.category, time: sweep.time, boxed };
            tracks.add(row, notes, fault)?;
        }
    }
    let place = format!("the boxes of sequence {}", sequence.name);
    Ok((tracks.tracks(options, &place, notes)?, annotated))
}

/// The rows of a frame's file, and the frame's sweep.
fn read_boxes<'a>(
    root: &Path,
    file: &str,
    sweep: Option<&'a SweepHeader>,
) -> Result<(&'a SweepHeader, Vec<Row>), Fault> {
    let without = || Fault::new("box-frame", file, "a time and a pose of the frame", "none");
    let sweep = sweep.ok_or_else(without)?;
    let read: Result<FrameBoxes, _> = serde_json::from_slice(&read_file(root, file)?);
    let read = read.map_err(|error| {
        Fault::new("boxes", file, "a list `3dbbox` of boxes", error.to_string())
    })?;
    Ok((sweep, read.boxes))
}

impl Row {
    /// The box in world, or what was expected and what was found.
    fn boxed(&self, sweep: &SweepHeader) -> Result<Box3, (String, String)> {
        let size_m = checked_size(Vector3::new(self.length, self.width, self.height))
            .map_err(|found| (A_SIZE.to_owned(), found))?;
        let place = [self.x, self.y, self.z];
        if !is_place(&place) {
            return Err((A_PLACE.to_owned(), format!("{place:?} m")));
        }
        let [x, y, z] = place;
        let lidar_from_box = pose_from_angles([self.roll, self.pitch, self.yaw, x, y, z]);
        Ok(Box3 { world_from_box: sweep.world_from_lidar() * lidar_from_box, size_m })
    }
}

impl Instance {
    fn text(&self) -> String {
        match self {
            Self::Text(id) => id.clone(),
            Self::Number(id) => id.to_string(),
        }
    }
}

/// What objects are called: by their ids; one whose id was another's before by its first frame too.
#[derive(Debug, Default)]
struct TrackNames {
    /// By id: the last frame, and the object's name.
    last: BTreeMap<String, (usize, String)>,
}

impl TrackNames {
    /// The name of the object that has an id at a frame. Frames come in their order.
    fn name(&mut self, id: String, frame: usize) -> String {
        let known = self.last.entry(id.clone()).or_insert_with(|| (frame, id.clone()));
        if frame.saturating_sub(known.0) > ABSENT_FRAMES {
            known.1 = format!("{id} from frame {frame}");
        }
        known.0 = frame;
        known.1.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_that_was_long_absent_is_another_objects() {
        let mut names = TrackNames::default();
        let mut name = |frame| names.name("Car:1".into(), frame);
        assert_eq!([name(5), name(6), name(36)], ["Car:1"; 3]);
        assert_eq!([name(67), name(70)], ["Car:1 from frame 67"; 2]);
    }
}
