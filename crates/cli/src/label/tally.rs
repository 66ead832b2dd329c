//! Counts of what was labelled.

use std::collections::BTreeMap;

use occlabel_core::{DropCounts, OccupancyLabels, VoxelState};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::label::clock::StageTimes;

/// What a keyframe came out as: kept in the journal and the report, so that a later run that keeps
/// the keyframe can tell of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Summary {
    pub(crate) voxels: VoxelCounts,
    /// What was skipped or degraded in its scene.
    pub(crate) losses: Vec<Value>,
}

/// Voxels by state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct VoxelCounts {
    pub(crate) occupied: u64,
    pub(crate) free: u64,
    pub(crate) unobserved: u64,
    pub(crate) seen_by_cameras: u64,
}

/// An annotated box that holds no point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct EmptyBox {
    /// The log's own id of the track.
    pub(crate) track: String,
    pub(crate) time_ns: i64,
}

/// What a scene came out as.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// Keyframes labelled, by this run or an earlier one.
    pub(crate) keyframes: usize,
    /// Points that serve the scene.
    pub(crate) points: u64,
    /// Points dropped, by reason.
    pub(crate) dropped: DropCounts,
    /// Rays of the keyframes labelled by this run.
    pub(crate) rays: u64,
    /// Annotated boxes at the time of a sweep that hold no point of it.
    pub(crate) boxes_without_points: Vec<EmptyBox>,
    /// Points without finite coordinates, by the file of their sweep.
    pub(crate) not_finite: BTreeMap<String, usize>,
    pub(crate) voxels: VoxelCounts,
    pub(crate) times: StageTimes,
}

impl VoxelCounts {
    pub(crate) fn of(labels: &OccupancyLabels) -> Self {
        let states = labels.states.values();
        let count = |state| states.iter().filter(|value| **value == state).count() as u64;
        Self {
            occupied: count(VoxelState::Occupied),
            free: count(VoxelState::Free),
            unobserved: count(VoxelState::Unobserved),
            seen_by_cameras: labels.mask_camera.values().iter().map(|&seen| u64::from(seen)).sum(),
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.occupied += other.occupied;
        self.free += other.free;
        self.unobserved += other.unobserved;
        self.seen_by_cameras += other.seen_by_cameras;
    }
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.keyframes += other.keyframes;
        self.points += other.points;
        self.dropped += other.dropped;
        self.rays += other.rays;
        self.boxes_without_points.extend_from_slice(&other.boxes_without_points);
        self.voxels.add(&other.voxels);
        self.times.add(&other.times);
    }

    /// One line about a scene, or about all of them.
    pub(crate) fn line(&self, name: &str) -> String {
        let VoxelCounts { occupied, free, unobserved, .. } = self.voxels;
        let mut line = format!(
            "{name}: {} keyframes, {} rays; voxels: {occupied} occupied, {free} free, \
             {unobserved} unobserved",
            self.keyframes, self.rays
        );
        let times = self.times.line();
        if !times.is_empty() {
            line += &format!("; {times}");
        }
        line
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "keyframes": self.keyframes,
            "points": self.points,
            "dropped": drops_json(&self.dropped),
            "rays": self.rays,
            "boxes_without_points": self.boxes_without_points.len(),
            "voxels": self.voxels,
            "seconds_by_stage": self.times.seconds(),
        })
    }
}

fn drops_json(dropped: &DropCounts) -> Value {
    json!({
        "not_finite": dropped.not_finite,
        "at_origin": dropped.at_origin,
        "ego": dropped.ego,
        "far": dropped.far,
        "ignored_label": dropped.ignored_label,
        "ignored_track": dropped.ignored_track,
        "unknown": dropped.unknown,
        "ghost": dropped.ghost,
    })
}
