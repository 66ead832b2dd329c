//! A log of three frames: the robot stands, goes 2 m ahead, and turns to the left; it has boxes at two of
//! them, labels at one, two cameras.

use std::fs;

use occlabel_core::{Fault, Scene, Taxonomy};
use occlabel_logs::{CodaLog, ReadOptions, SceneSource};
use tempfile::TempDir;

const TAXONOMY: &str = include_str!("../../../../configs/taxonomies/coda.toml");
/// A quarter turn to the left, at the last frame.
pub(crate) const POSES: &str = "1673884185.589118 5 0 0 1 0 0 0\n1673884185.689118 7 0 0 1 0 0 0\n\
    1673884185.789118 7 0 0 0.70710678 0 0 0.70710678\n";
pub(crate) const TIMES: &str = "1673884185.589118\n1673884185.689118\n1673884185.789118\n";

/// A lens whose optical axis is the image's centre; rectified, it is wider.
pub(crate) const LENS: &str = "image_width: 1224\nimage_height: 1024\ncamera_name: narrow_stereo/left\n\
    camera_matrix:\n  rows: 3\n  cols: 3\n  data: [730, 0, 612,\n         0, 729, 512,\n         0, 0, 1 ]\n\
    distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  \
    data: [-0.0559, 0.1237, 0.0011, -0.0036, -0.0636]\n\
    rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n\
    projection_matrix:\n  rows: 3\n  cols: 4\n  data: [600, 0., 612, -120.0, 0, 600., 512, 0, 0, 0, 1, 0.]\n";
/// The camera looks along the lidar's x axis, 0.1 m to its left and 0.2 m below it.
pub(crate) const MOUNTING: &str = "extrinsic_matrix:\n  rows: 4\n  cols: 4\n  data: [\n    0, -1, 0, 0.1,\n    \
    0, 0, -1, -0.2,\n    1, 0, 0, 0,\n    0, 0, 0, 1 ]\n";

/// Points of every frame: x, y, z, intensity.
pub(crate) const POINTS: [[f32; 4]; 4] =
    [[1.0, 2.0, -0.7, 0.1], [5.0, -2.0, 0.25, 0.2], [-3.0, 0.5, 0.5, 0.3], [9.0, 0.0, -0.7, 0.4]];
/// Labels of the second frame: road, no terrain, nobody knows, grass.
pub(crate) const LABELS: [u8; 4] = [10, 0, 24, 2];

/// A box 3 m ahead of the lidar, turned by a yaw.
pub(crate) fn boxed(category: &str, instance: &str, yaw: f64) -> String {
    format!(
        r#"{{"classId": "{category}", "instanceId": "{instance}", "labelAttributes": {{"isOccluded": "None"}},
        "cX": 3, "cY": 0, "cZ": 0.1, "l": 4, "w": 2, "h": 1.5, "r": 0, "p": 0, "y": {yaw}}}"#
    )
}

pub(crate) fn boxes(rows: &[String]) -> String {
    format!(r#"{{"3dbbox": [{}]}}"#, rows.join(", "))
}

pub(crate) fn options() -> ReadOptions {
    ReadOptions::of(taxonomy(TAXONOMY))
}

pub(crate) fn taxonomy(text: &str) -> Taxonomy {
    toml::from_str(text).unwrap()
}

/// The log, sequence `7`.
pub(crate) fn tiny() -> TempDir {
    let root = tempfile::tempdir().unwrap();
    put(&root, "poses/dense/7.txt", POSES);
    put(&root, "timestamps/7.txt", TIMES);
    for camera in ["cam0", "cam1"] {
        put(&root, &format!("calibrations/7/calib_{camera}_intrinsics.yaml"), LENS);
        put(&root, &format!("calibrations/7/calib_os1_to_{camera}.yaml"), MOUNTING);
    }
    for frame in 0..3 {
        let bytes: Vec<u8> = POINTS.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        put(&root, &format!("3d_comp/os1/7/3d_comp_os1_7_{frame}.bin"), bytes);
    }
    put(&root, "3d_semantic/os1/7/3d_semantic_os1_7_1.bin", LABELS);
    let rows = [boxed("Car", "Car:1", 0.5), boxed("Fire Hydrant", "Fire Hydrant:1", 0.0)];
    put(&root, "3d_bbox/os1/7/3d_bbox_os1_7_1.json", boxes(&rows));
    put(&root, "3d_bbox/os1/7/3d_bbox_os1_7_2.json", boxes(&rows[..1]));
    root
}

/// Puts bytes in place of a file.
pub(crate) fn put(root: &TempDir, file: &str, bytes: impl AsRef<[u8]>) {
    let path = root.path().join(file);
    fs::create_dir_all(path.parent().unwrap()).and_then(|()| fs::write(path, bytes)).unwrap();
}

pub(crate) fn remove(root: &TempDir, file: &str) {
    fs::remove_file(root.path().join(file)).unwrap();
}

pub(crate) fn open(root: &TempDir) -> CodaLog {
    CodaLog::open(root.path(), options()).unwrap()
}

/// The scene of sequence `7`.
pub(crate) fn load(root: &TempDir) -> Result<Scene, Fault> {
    open(root).load("7")
}
