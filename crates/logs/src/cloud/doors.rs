//! Whole logs of clouds, for whoever throws bytes at them.

use occlabel_testkit::in_folder;

use super::{CloudLog, CloudOptions};
use crate::SceneSource;
use crate::doors::read_options;
use occlabel_core::CloudSettings;

const PLY: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
    property float z\nproperty float opacity\nproperty float scale_0\nproperty float scale_1\n\
    property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n\
    property uchar class\nproperty uchar track\nend_header\n\
    1 2 3 4 -1 -2 1 0 0 0 7 0\n1 0 0 0.1 -2 -2 1 0 0 1 8 1\n";
const BINARY_PLY: &[u8] = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\n\
    property float x\nproperty float y\nproperty float z\nproperty list uchar short i\nend_header\n\
    \0\0\x80\x3f\0\0\0\0\0\0\0\x40\x01\x02\x00";
const PCD: &[u8] = b"VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\n\
    POINTS 1\nDATA binary_compressed\n\x0e\0\0\0\x0d\0\0\0\x0c\0\0\x80\x3f\0\0\0\0\0\0\0\x40\x07";

/// The files of a sound scene, the world's cloud last.
const FILES: [(&str, &[u8]); 5] = [
    ("poses.txt", b"# t x y z qx qy qz qw\n0.5 1 2 0 0 0 0 1\n1.0 2 2 0 0 0 0 1\n"),
    ("cameras.json", br#"[{"name": "A", "width": 4, "height": 2, "camera_intrinsic":
        [[2, 0, 2], [0, 2, 1], [0, 0, 1]], "translation": [1, 0, 1.5], "rotation": [0.5, -0.5, 0.5, -0.5]},
        {"name": "B", "width": 4, "height": 2, "camera_model": "kannala-brandt",
        "camera_intrinsic": [[2, 0, 2], [0, 2, 1], [0, 0, 1]], "camera_distortion": [0, 0, 0, 0],
        "exposures": [{"time_ns": 5, "translation": [0, 0, 0], "rotation": [1, 0, 0, 0]}]}]"#),
    ("tracks.json", br#"[{"id": "a", "category": "vehicle.car", "boxes": [{"time_ns": 500000000,
        "translation": [4, 0, 1], "rotation": [1, 0, 0, 0], "size": [4, 2, 1.5]}]}]"#),
    ("classes.json", br#"{"7": "flat.terrain", "8": null}"#),
    ("cloud.ply", PLY),
];
/// Where the world's cloud stands among them.
const CLOUD: usize = 4;
const ENDINGS: [&str; 3] = ["cloud.ply", "cloud.pcd", "cloud.las"];

/// The scene with other bytes in the file that the first byte tells; whether all of it was read.
pub(crate) fn scene(bytes: &[u8]) -> bool {
    let Some((&place, bytes)) = bytes.split_first() else { return false };
    let mut files = FILES;
    match usize::from(place) % (CLOUD + ENDINGS.len()) {
        table if table < CLOUD => files[table].1 = bytes,
        cloud => files[CLOUD] = (ENDINGS[cloud - CLOUD], bytes),
    }
    in_folder(&files, |root| {
        let (read, settings) = (read_options(), CloudSettings::default());
        // Coarse, lest a surfel become millions of points.
        let options = CloudOptions { read, settings, surfel_spacing_m: Some(5.0) };
        let Ok(log) = CloudLog::open(root, options) else { return false };
        log.scene_names().iter().all(|name| {
            let Ok(scene) = log.load(name) else { return false };
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            log.scene_points(&scene);
            scene.refused.is_empty() && read == scene.sweeps.len()
        })
    })
}

/// Every file, behind its number.
pub(crate) fn files() -> Vec<Vec<u8>> {
    let tables = FILES.into_iter().map(|(_, bytes)| bytes.to_vec());
    let clouds = [PCD.to_vec(), super::las::sample(6)];
    let binary = [&[CLOUD as u8][..], BINARY_PLY].concat();
    let numbered = (0..).zip(tables.chain(clouds));
    let numbered = numbered.map(|(place, bytes): (u8, Vec<u8>)| [&[place][..], &bytes].concat());
    numbered.chain([binary]).collect()
}
