//! The parsers of logs in KITTI-360's layout, for whoever throws bytes at them.

use occlabel_testkit::in_folder;

use super::Kitti360Log;
use super::boxes::read_objects;
use super::fused::FusedLabels;
use crate::SceneSource;
use crate::doors::read_options;

/// The text files of a sound drive of three frames.
const TEXTS: [(&str, &str); 7] = [
    ("calibration/calib_cam_to_pose.txt", MOUNTINGS),
    ("calibration/calib_cam_to_velo.txt", "0 0 1 0 -1 0 0 0 0 -1 0 -0.2\n"),
    ("calibration/perspective.txt", LENSES),
    ("calibration/image_02.yaml", FISHEYE),
    ("data_3d_raw/d/velodyne_points/timestamps.txt", STAMPS),
    ("data_poses/d/poses.txt", "0 1 0 0 9 0 -1 0 8 0 0 -1 7\n2 1 0 0 8 0 -1 0 8 0 0 -1 7\n"),
    ("data_poses/d/cam0_to_world.txt", "1 0 0 1 1 -1 0 0 2 0 -1 0 3 0 0 0 1\n"),
];
/// Poses of the vehicle, in whose presence those of camera 0 are not read.
const POSES: usize = 5;
const CAMERA_POSES: usize = 6;

const MOUNTINGS: &str = "image_00: 0 0 1 0 1 0 0 0 0 1 0 -1\nimage_01: 0 0 1 0 1 0 0 1 0 1 0 -1\n\
    image_02: 1 0 0 0 0 0 1 1 0 -1 0 -1\nimage_03: 1 0 0 0 0 0 1 -1 0 -1 0 -1\n";
const LENSES: &str = "S_rect_00: 14 3\nR_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_00: 5 0 6 0 0 5 2 0 0 0 1 0\n\
    S_rect_01: 14 3\nR_rect_01: 1 0 0 0 1 0 0 0 1\nP_rect_01: 5 0 6 -3 0 5 2 0 0 0 1 0\n";
const FISHEYE: &str = "image_width: 1400\nimage_height: 1400\nxi: 2.2\nk1: 0.01\nk2: 1.6\np1: 0\np2: 0\n\
    gamma1: 1336\ngamma2: 1335\nu0: 716\nv0: 705\n";
const STAMPS: &str = "2013-05-28 08:46:02.1\n2013-05-28 08:46:02.2\n2013-05-28 08:46:02.3\n";
/// Of one point.
const SCAN: (&str, &[u8]) = ("data_3d_raw/d/velodyne_points/data/0000000001.bin", &[0; 16]);

/// A cube at a frame, one over a span of frames.
const OBJECTS: &str = "<?xml version=\"1.0\"?>\n<opencv_storage>\n\
    <object1><semanticId>26</semanticId><instanceId>3</instanceId><start_frame>0</start_frame>\
    <end_frame>2</end_frame><timestamp>1</timestamp><transform><data>0 -2 0 5 4 0 0 6 0 0 1.5 7 0 0 0 1\
    </data></transform><vertices><data>-0.5 -0.5 -0.5 0.5 0.5 0.5</data></vertices></object1>\n\
    <object2><semanticId>9</semanticId><instanceId>-1</instanceId><start_frame>0</start_frame>\
    <end_frame>2</end_frame><timestamp>-1</timestamp><transform><data>1 0 0 5 0 1 0 6 0 0 1 7\
    </data></transform><vertices><data>0 0 0 1 1 1</data></vertices></object2></opencv_storage>\n";

const CLOUD: &[u8] = b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n\
    property float y\nproperty float z\nproperty uchar red\nproperty int semantic\nend_header\n\
    \0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f\xff\x07\0\0\0\0\0\0\x40\0\0\x80\x3f\0\0\x80\x3f\xff\x08\0\0\0";

/// The drive with another text in place of the one that the first byte tells; whether all of it was
/// read.
pub(crate) fn text(bytes: &[u8]) -> bool {
    let Some((&place, text)) = bytes.split_first() else { return false };
    let place = usize::from(place) % TEXTS.len();
    let mut files = TEXTS.map(|(file, text)| (file, text.as_bytes())).to_vec();
    files[place].1 = text;
    files.push(SCAN);
    if place == CAMERA_POSES {
        files.remove(POSES);
    }
    in_folder(&files, |root| {
        let Ok(log) = Kitti360Log::open(root, read_options()) else { return false };
        log.load("d").is_ok_and(|scene| scene.refused.is_empty() && !scene.sweeps.is_empty())
    })
}

/// Every text, behind its number.
pub(crate) fn texts() -> Vec<Vec<u8>> {
    (0..).zip(TEXTS).map(|(place, (_, text))| [&[place], text.as_bytes()].concat()).collect()
}

/// A file of boxes.
pub(crate) fn boxes(bytes: &[u8]) -> bool {
    read_objects(bytes, "").is_ok()
}

pub(crate) fn objects() -> Vec<Vec<u8>> {
    vec![OBJECTS.into()]
}

/// A fused cloud.
pub(crate) fn fused(bytes: &[u8]) -> bool {
    FusedLabels::read(bytes, "").is_ok()
}

pub(crate) fn clouds() -> Vec<Vec<u8>> {
    vec![CLOUD.into()]
}
