//! A log of five scans: the vehicle goes east by 1 m a frame, 0.1 s each. The lidar is turned as the
//! IMU but for its up, 0.8 m above it; camera 0 looks ahead, 0.2 m below the lidar.

use std::fs;
use std::path::Path;

use occlabel_core::{Fault, Scene};
use occlabel_logs::{Kitti360Log, ReadOptions, SceneSource};
use tempfile::TempDir;

pub(crate) const DRIVE: &str = "2013_05_28_drive_0007_sync";
const TAXONOMY: &str = include_str!("../../../../configs/taxonomies/semantickitti.toml");

/// Camera 0 in the IMU's frame: looks along x, its right is y, its down is z; 0.6 m up.
pub(crate) const CAMERAS: &str = "image_00: 0 0 1 0 1 0 0 0 0 1 0 -0.6\n\
    image_01: 0 0 1 0 1 0 0 0.6 0 1 0 -0.6\nimage_02: 1 0 0 0 0 0 1 1 0 -1 0 -0.6\n\
    image_03: 1 0 0 0 0 0 1 -1 0 -1 0 -0.6\n";
/// Camera 0 in the lidar's frame: x right is minus y, y down is minus z, z ahead is x.
pub(crate) const LIDAR: &str = "0 0 1 0 -1 0 0 0 0 -1 0 -0.2\n";
pub(crate) const LENSES: &str = "S_rect_00: 1408 376\nR_rect_00: 1 0 0 0 1 0 0 0 1\n\
    P_rect_00: 552 0 682 0 0 552 238 0 0 0 1 0\nS_rect_01: 1408 376\n\
    R_rect_01: 1 0 0 0 1 0 0 0 1\nP_rect_01: 552 0 682 -328 0 552 238 0 0 0 1 0\n";
const FISHEYE: &str = "%YAML:1.0\nimage_width: 1400\nimage_height: 1400\nmirror_parameters:\n   \
    xi: 2.2\ndistortion_parameters:\n   k1: 0.01\n   k2: 1.6\n   p1: 0.0\n   p2: 0.0\n\
    projection_parameters:\n   gamma1: 1336\n   gamma2: 1335\n   u0: 716\n   v0: 705\n";

/// The pose of the IMU, its z down, at x metres east; frame 2 has none.
pub(crate) fn poses() -> String {
    let pose = |frame: usize| format!("{frame} 1 0 0 {frame} 0 -1 0 50 0 0 -1 100.93\n");
    [0, 1, 3, 4].map(pose).concat()
}

pub(crate) fn stamps() -> String {
    (0..5).map(|frame| format!("2013-05-28 08:46:02.{frame}00000000\n")).collect()
}

/// Nanoseconds of frame 0.
pub(crate) const BEGIN_NS: i64 = 1_369_730_762_000_000_000;

/// Points of every scan: x, y, z, remission.
pub(crate) const POINTS: [[f32; 4]; 4] = [
    [10.1, 0.1, -1.63, 0.1],
    [0.0, 8.0, -1.0, 0.2],
    [-6.0, -0.01, 0.5, 0.3],
    [20.1, 0.1, 0.1, 0.4],
];

pub(crate) fn options() -> ReadOptions {
    ReadOptions::of(toml::from_str(TAXONOMY).unwrap())
}

pub(crate) fn put(root: &TempDir, file: &str, bytes: impl AsRef<[u8]>) {
    let path = root.path().join(file);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

pub(crate) fn scan_file(frame: usize) -> String {
    format!("data_3d_raw/{DRIVE}/velodyne_points/data/{frame:010}.bin")
}

pub(crate) fn label_file(frame: usize) -> String {
    scan_file(frame).replace("/data/", "/labels/").replace(".bin", ".label")
}

/// The log without boxes, labels and images.
pub(crate) fn bare() -> TempDir {
    let root = tempfile::tempdir().unwrap();
    put(&root, "calibration/calib_cam_to_pose.txt", CAMERAS);
    put(&root, "calibration/calib_cam_to_velo.txt", LIDAR);
    put(&root, "calibration/perspective.txt", LENSES);
    put(&root, "calibration/image_02.yaml", FISHEYE);
    put(&root, &format!("data_poses/{DRIVE}/poses.txt"), poses());
    put(&root, &format!("data_3d_raw/{DRIVE}/velodyne_points/timestamps.txt"), stamps());
    let bytes: Vec<u8> = POINTS.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    (0..5).for_each(|frame| put(&root, &scan_file(frame), &bytes));
    root
}

/// An object of the file of boxes: a unit cube, scaled and moved, turned by a quarter about z.
pub(crate) fn object(class: u16, instance: i64, frames: [i64; 3], place: [f64; 3]) -> String {
    let [first, last, at] = frames;
    let [x, y, z] = place;
    let corners = "-0.5 -0.5 -0.5 0.5 0.5 0.5 0.5 -0.5 0.5 -0.5 0.5 -0.5";
    format!(
        "<object1><index>1</index><semanticId>{class}</semanticId><instanceId>{instance}\
         </instanceId><start_frame>{first}</start_frame><end_frame>{last}</end_frame>\
         <timestamp>{at}</timestamp>\n<transform type_id=\"opencv-matrix\"><rows>4</rows><cols>4\
         </cols><dt>f</dt><data>\n0 -2 0 {x} 4 0 0 {y} 0 0 1.5 {z} 0 0 0 1</data></transform>\
         <vertices type_id=\"opencv-matrix\"><rows>4</rows><cols>3</cols><dt>f</dt><data>\
         {corners}</data></vertices></object1>\n"
    )
}

pub(crate) fn put_boxes(root: &TempDir, objects: &[String]) {
    let text =
        format!("<?xml version=\"1.0\"?>\n<opencv_storage>\n{}</opencv_storage>", objects.concat());
    put(root, &format!("data_3d_bboxes/train/{DRIVE}.xml"), text);
}

pub(crate) fn open(root: &TempDir) -> Kitti360Log {
    Kitti360Log::open(root.path(), options()).unwrap()
}

pub(crate) fn load(root: &TempDir) -> Result<Scene, Fault> {
    open(root).load(DRIVE)
}

/// The scene's warnings by rule.
pub(crate) fn told(scene: &Scene) -> Vec<&'static str> {
    scene.warnings.iter().map(|fault| fault.rule).collect()
}

/// Whether a file below the root is there.
pub(crate) fn is_there(root: &Path, file: &str) -> bool {
    root.join(file).is_file()
}
