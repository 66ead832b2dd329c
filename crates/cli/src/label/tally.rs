//! Counts of what was labelled.

use std::collections::BTreeMap;

use occlabel_core::{ClassCounts, DropCounts, OccupancyLabels, VoxelState};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::label::clock::StageCosts;
use crate::label::meshes::MeshCounts;

/// What a keyframe came out as: kept in the journal and the report, so that a later run that keeps
/// the keyframe can tell of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Summary {
    pub(crate) voxels: VoxelCounts,
    /// What was skipped or degraded in its scene.
    pub(crate) losses: Vec<Value>,
}

/// Voxels by state, and the occupied ones by class.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct VoxelCounts {
    pub(crate) occupied: u64,
    pub(crate) free: u64,
    pub(crate) unobserved: u64,
    pub(crate) seen_by_cameras: u64,
    /// By the class's name; a class that does not occur is absent.
    #[serde(default)]
    pub(crate) by_class: BTreeMap<String, u64>,
}

/// Sweeps of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct SweepCounts {
    pub(crate) read: u64,
    /// Absent or broken.
    pub(crate) left_out: u64,
    /// Sizes of the files that hold them and their point labels.
    pub(crate) file_bytes: u64,
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
    /// Those of an earlier one.
    pub(crate) kept: usize,
    pub(crate) sweeps: SweepCounts,
    /// What became of meshes.
    pub(crate) meshes: MeshCounts,
    /// Points of the sweeps that were read.
    pub(crate) points_read: u64,
    /// Points dropped, by reason.
    pub(crate) dropped: DropCounts,
    /// The others, which serve the scene.
    pub(crate) points: u64,
    /// The same by where their classes come from.
    pub(crate) class_from: ClassCounts,
    /// Rays of the keyframes labelled by this run.
    pub(crate) rays: u64,
    /// Annotated boxes at the time of a sweep that hold no point of it.
    pub(crate) boxes_without_points: Vec<EmptyBox>,
    /// Points without finite coordinates, by the file of their sweep.
    pub(crate) not_finite: BTreeMap<String, usize>,
    pub(crate) voxels: VoxelCounts,
    /// Of the wall's clock.
    pub(crate) seconds: f64,
    pub(crate) costs: StageCosts,
}

impl VoxelCounts {
    /// Counts, the classes being named so.
    pub(crate) fn of(labels: &OccupancyLabels, names: &[String]) -> Self {
        let states = labels.states.values();
        let count = |state| states.iter().filter(|value| **value == state).count() as u64;
        Self {
            occupied: count(VoxelState::Occupied),
            free: count(VoxelState::Free),
            unobserved: count(VoxelState::Unobserved),
            seen_by_cameras: labels.mask_camera.values().iter().map(|&seen| u64::from(seen)).sum(),
            by_class: by_class(labels, names),
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.occupied += other.occupied;
        self.free += other.free;
        self.unobserved += other.unobserved;
        self.seen_by_cameras += other.seen_by_cameras;
        for (class, voxels) in &other.by_class {
            *self.by_class.entry(class.clone()).or_default() += voxels;
        }
    }
}

/// Occupied voxels by the names of their classes.
fn by_class(labels: &OccupancyLabels, names: &[String]) -> BTreeMap<String, u64> {
    let mut counts = vec![0; names.len()];
    for (class, state) in labels.semantics.values().iter().zip(labels.states.values()) {
        if *state == VoxelState::Occupied {
            counts[usize::from(*class)] += 1;
        }
    }
    names.iter().cloned().zip(counts).filter(|(_, voxels)| *voxels > 0).collect()
}

impl SweepCounts {
    fn add(&mut self, other: &Self) {
        self.read += other.read;
        self.left_out += other.left_out;
        self.file_bytes += other.file_bytes;
    }
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.keyframes += other.keyframes;
        self.kept += other.kept;
        self.sweeps.add(&other.sweeps);
        self.meshes.add(&other.meshes);
        self.points_read += other.points_read;
        self.dropped += other.dropped;
        self.points += other.points;
        self.class_from += other.class_from;
        self.rays += other.rays;
        self.boxes_without_points.extend_from_slice(&other.boxes_without_points);
        self.voxels.add(&other.voxels);
        self.seconds += other.seconds;
        self.costs.add(&other.costs);
    }

    /// One line about a scene, or about all of them.
    pub(crate) fn line(&self, name: &str) -> String {
        let VoxelCounts { occupied, free, unobserved, .. } = &self.voxels;
        let mut line = format!(
            "{name}: {} keyframes, {} rays; voxels: {occupied} occupied, {free} free, \
             {unobserved} unobserved",
            self.keyframes, self.rays
        );
        let times = self.costs.line();
        if !times.is_empty() {
            line += &format!("; {times}");
        }
        line
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "keyframes": self.keyframes,
            "kept": self.kept,
            "sweeps": self.sweeps,
            "meshes": self.meshes,
            "points_read": self.points_read,
            "dropped": drops_json(&self.dropped),
            "points": self.points,
            "class_from": class_from_json(&self.class_from),
            "rays": self.rays,
            "boxes_without_points": self.boxes_without_points.len(),
            "voxels": self.voxels,
            "seconds": self.seconds,
            "seconds_by_stage": self.costs.seconds(),
            "cpu_seconds_by_stage": self.costs.cpu_seconds(),
            "peak_memory_bytes_by_stage": self.costs.peak_memory_bytes(),
        })
    }
}

fn class_from_json(class_from: &ClassCounts) -> Value {
    json!({
        "labels": class_from.labels,
        "masks": class_from.masks,
        "boxes": class_from.boxes,
        "neighbours": class_from.neighbours,
        "unknown": class_from.unknown,
    })
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
