//! The fixture's log, whole or bent.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use occlabel_core::{Fault, Scene, Taxonomy};
use occlabel_logs::{ReadOptions, SceneSource, SweepPoints, WaymoLog};
use serde_json::{Map, Value, json};
use tempfile::TempDir;

use crate::message::record;

/// The segment of the fixture.
pub(crate) const SEGMENT: &str = "10000000000000000001_0_000_20_000";
/// Its frames' times.
pub(crate) const MICROS: [i64; 3] = [1550083467346370, 1550083467446270, 1550083467546310];

/// Names of point classes: in the tests' taxonomy, the id is the format's own number.
const CLASSES: [&str; 23] = [
    "UNDEFINED",
    "CAR",
    "TRUCK",
    "BUS",
    "OTHER_VEHICLE",
    "MOTORCYCLIST",
    "BICYCLIST",
    "PEDESTRIAN",
    "SIGN",
    "TRAFFIC_LIGHT",
    "POLE",
    "CONSTRUCTION_CONE",
    "BICYCLE",
    "MOTORCYCLE",
    "BUILDING",
    "VEGETATION",
    "TREE_TRUNK",
    "CURB",
    "ROAD",
    "LANE_MARKER",
    "OTHER_GROUND",
    "WALKABLE",
    "SIDEWALK",
];

pub(crate) fn taxonomy() -> Taxonomy {
    let points: Map<String, Value> =
        CLASSES.iter().map(|class| ((*class).to_owned(), json!(class))).collect();
    serde_json::from_value(json!({
        "classes": CLASSES, "free": 23, "unknown": "drop", "things": ["CAR"], "movers": ["CAR"],
        "deformable": [], "flat": ["ROAD"], "priority": CLASSES, "points": points,
        "boxes": {"VEHICLE": "CAR", "PEDESTRIAN": "PEDESTRIAN", "SIGN": "ignore"},
    }))
    .unwrap()
}

pub(crate) fn options() -> ReadOptions {
    ReadOptions::of(taxonomy())
}

pub(crate) fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/waymo/fixtures")
}

/// The fixture's three frames of v1, without their framing.
pub(crate) fn frames() -> Vec<Vec<u8>> {
    let bytes = fs::read(fixtures().join("v1/drive.tfrecord")).unwrap();
    let (mut frames, mut rest) = (Vec::new(), bytes.as_slice());
    while let Some((length, _)) = rest.split_first_chunk::<8>() {
        let length = u64::from_le_bytes(*length) as usize;
        frames.push(rest[12..12 + length].to_vec());
        rest = &rest[16 + length..];
    }
    assert_eq!(frames.len(), 3);
    frames
}

/// A log of one file of these bytes.
pub(crate) fn folder_of(bytes: &[u8]) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("drive.tfrecord"), bytes).unwrap();
    root
}

/// A log of one file of these frames.
pub(crate) fn folder(frames: &[Vec<u8>]) -> TempDir {
    folder_of(&frames.iter().flat_map(|frame| record(frame)).collect::<Vec<u8>>())
}

/// The only scene of a log of these frames.
pub(crate) fn load(frames: &[Vec<u8>]) -> Result<Scene, Fault> {
    let root = folder(frames);
    let log = WaymoLog::open(root.path(), options())?;
    log.load(&log.scene_names()[0])
}

/// The first sweep of a lidar in a log of these frames.
pub(crate) fn first_sweep(frames: &[Vec<u8>], lidar: &str) -> Result<SweepPoints, Fault> {
    let root = folder(frames);
    let log = WaymoLog::open(root.path(), options())?;
    let scene = log.load(&log.scene_names()[0])?;
    log.read_sweep(scene.sweeps.iter().find(|sweep| sweep.lidar == lidar).unwrap())
}

/// By `microseconds/LIDAR`: x y z, origin x y z, class (-1: not labelled) of each point; vehicle
/// frame.
pub(crate) fn expected_points() -> BTreeMap<String, Vec<[f64; 7]>> {
    let text = fs::read_to_string(fixtures().join("points.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}
