//! A log of three scans: the lidar 0.27 m behind and 0.08 m above the camera, which goes 2 m ahead and
//! then turns to the left.

use std::fs;
use std::path::Path;

use occlabel_core::{Fault, Scene, Taxonomy};
use occlabel_logs::{ReadOptions, SceneSource, SemanticKittiLog};
use serde_json::json;
use tempfile::TempDir;

pub(crate) const CALIB: &str =
    "P0: 7 0 6 0 0 7 1 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";
pub(crate) const POSES: &str =
    "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n0 0 -1 0 0 1 0 0 1 0 0 2\n";
pub(crate) const TIMES: &str = "0.000000e+00\n1.037359e-01\n2.074720e-01\n3e-1\n";

/// Points of every scan: x, y, z, remission.
pub(crate) const POINTS: [[f32; 4]; 4] =
    [[1.0, 2.0, -1.5, 0.1], [5.0, -2.0, 0.25, 0.2], [-3.0, 0.5, 0.5, 0.3], [9.0, 0.0, -1.0, 0.4]];
/// Raw labels of the first two scans, instances in the upper half.
pub(crate) const LABELS: [u32; 4] = [40, 252 | 3 << 16, 0, 1];

pub(crate) fn taxonomy() -> Taxonomy {
    let classes = ["car", "road"];
    serde_json::from_value(json!({
        "classes": classes, "free": 255, "unknown": "drop", "things": ["car"], "movers": ["car"],
        "deformable": [], "flat": ["road"], "priority": classes,
        "points": {"car": "car", "moving-car": "car", "road": "road", "outlier": "ignore"},
        "boxes": {},
    }))
    .unwrap()
}

pub(crate) fn options() -> ReadOptions {
    ReadOptions::of(taxonomy())
}

/// The log, sequence `00`.
pub(crate) fn tiny() -> TempDir {
    let root = tempfile::tempdir().unwrap();
    write_sequence(&root.path().join("sequences/00"));
    root
}

pub(crate) fn write_sequence(folder: &Path) {
    for name in ["velodyne", "labels"] {
        fs::create_dir_all(folder.join(name)).unwrap();
    }
    for (name, text) in [("calib", CALIB), ("poses", POSES), ("times", TIMES)] {
        fs::write(folder.join(format!("{name}.txt")), text).unwrap();
    }
    for scan in 0..3 {
        let bytes: Vec<u8> = POINTS.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        fs::write(folder.join(format!("velodyne/{scan:06}.bin")), bytes).unwrap();
    }
    for scan in 0..2 {
        let bytes: Vec<u8> = LABELS.iter().flat_map(|label| label.to_le_bytes()).collect();
        fs::write(folder.join(format!("labels/{scan:06}.label")), bytes).unwrap();
    }
}

/// Puts text in place of a file of sequence `00`.
pub(crate) fn put(root: &TempDir, file: &str, bytes: impl AsRef<[u8]>) {
    fs::write(root.path().join("sequences/00").join(file), bytes).unwrap();
}

pub(crate) fn open(root: &TempDir) -> SemanticKittiLog {
    SemanticKittiLog::open(root.path(), options()).unwrap()
}

/// The scene of sequence `00`.
pub(crate) fn load(root: &TempDir) -> Result<Scene, Fault> {
    open(root).load("00")
}
