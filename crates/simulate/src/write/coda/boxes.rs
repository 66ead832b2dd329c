//! The boxes of a frame.

use occlabel_core::{Box3, BoxTrack, SweepHeader, Timestamp};
use serde_json::{Value, json};

use super::ids::category;
use crate::Drive;
use crate::rotation::roll_pitch_yaw;

/// The file of the boxes that tracks have at a time, and how many these are.
pub(super) fn text(drive: &Drive, time: Timestamp, sweep: &SweepHeader) -> (String, usize) {
    let row_of = |track: &BoxTrack| {
        let (_, boxed) = track.boxes.iter().find(|(known, _)| *known == time)?;
        Some(row(track, boxed, sweep))
    };
    let rows: Vec<Value> = drive.scene().tracks.iter().filter_map(row_of).collect();
    let count = rows.len();
    (json!({ "3dbbox": rows }).to_string(), count)
}

fn row(track: &BoxTrack, boxed: &Box3, sweep: &SweepHeader) -> Value {
    let lidar_from_box = sweep.world_from_lidar().inverse() * boxed.world_from_box;
    let centre = lidar_from_box.translation.vector;
    let [roll, pitch, yaw] = roll_pitch_yaw(&lidar_from_box.rotation);
    json!({
        "classId": category(&track.category), "instanceId": track.source_id,
        "labelAttributes": { "isOccluded": "Unknown" },
        "cX": centre.x, "cY": centre.y, "cZ": centre.z,
        "l": boxed.size_m.x, "w": boxed.size_m.y, "h": boxed.size_m.z,
        "r": roll, "p": pitch, "y": yaw,
    })
}
