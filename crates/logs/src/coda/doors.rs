//! Whole logs in CODa's layout, for whoever throws bytes at them.

use occlabel_testkit::in_folder;

use super::CodaLog;
use crate::SceneSource;
use crate::doors::read_options;

/// The files of a sound sequence of two frames.
const FILES: [(&str, &[u8]); 8] = [
    ("poses/dense/0.txt", b"0.0 0 0 0 1 0 0 0\n0.1 1 2e-1 0 0.6 0 0 0.8\n"),
    ("timestamps/0.txt", b"0.000000\n1e-01\n"),
    ("calibrations/0/calib_cam0_intrinsics.yaml", LENS),
    ("calibrations/0/calib_os1_to_cam0.yaml", MOUNTING),
    ("3d_bbox/os1/0/3d_bbox_os1_0_1.json", BOXES),
    ("3d_semantic/os1/0/3d_semantic_os1_0_0.bin", &[10, 24]),
    ("3d_comp/os1/0/3d_comp_os1_0_0.bin", &[64; 32]),
    ("3d_comp/os1/0/3d_comp_os1_0_1.bin", &[0; 16]),
];
/// Any image makes the camera one of rectified images.
const IMAGE: (&str, &[u8]) = ("2d_rect/cam0/0/2d_rect_cam0_0_1.jpg", b"");

const LENS: &[u8] = b"image_width: 12\nimage_height: 8\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
    data: [7, 0, 6,\n 0, 7, 4, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  \
    data: [-0.05, 0.1, 0.001, -0.003, -0.06]\nrectification_matrix:\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n\
    projection_matrix:\n  data:\n  - 7\n  - 0\n  - 6\n  - 0.\n  - 0\n  - 7\n  - 4\n  - 0\n  - 0\n  - 0\n  - 1\n  - 0\n";
const MOUNTING: &[u8] =
    b"extrinsic_matrix:\n  rows: 4\n  cols: 4\n  data: [0, -1, 0, 0.03, 0, 0, -1, \
    -0.05, 1, 0, 0, 0, 0, 0, 0, 1]\n";
const BOXES: &[u8] = br#"{"3dbbox": [{"classId": "vehicle", "instanceId": "vehicle:1", "labelAttributes":
    {"isOccluded": "None"}, "cX": 3, "cY": -1, "cZ": 0.5, "l": 4, "w": 2, "h": 1.5, "r": 0.1, "p": 0, "y": 3}]}"#;

/// The sequence with other bytes in the file that the first byte tells, its images rectified or absent by
/// that byte's last bit; whether all of it was read.
pub(crate) fn sequence(bytes: &[u8]) -> bool {
    let Some((&place, bytes)) = bytes.split_first() else { return false };
    let mut files = FILES.to_vec();
    files[usize::from(place >> 1) % FILES.len()].1 = bytes;
    files.extend((place & 1 == 1).then_some(IMAGE));
    in_folder(&files, |root| {
        let Ok(log) = CodaLog::open(root, read_options()) else { return false };
        log.load("0").is_ok_and(|scene| {
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            scene.refused.is_empty() && read == 2
        })
    })
}

/// Every file, behind its number, with and without images.
pub(crate) fn files() -> Vec<Vec<u8>> {
    let seed = |place: u8| {
        let (_, bytes) = FILES[usize::from(place >> 1)];
        [&[place], bytes].concat()
    };
    (0..2 * FILES.len() as u8).map(seed).collect()
}
