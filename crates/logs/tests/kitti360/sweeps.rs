//! Points and their labels.

use nalgebra::Point3;
use occlabel_core::{ClassId, PointCloud, PointLabel};
use occlabel_logs::SceneSource;
use tempfile::TempDir;

use crate::log::{DRIVE, POINTS, bare, label_file, load, open, put};

const ROAD: PointLabel = PointLabel::Class(ClassId(9));
const CAR: PointLabel = PointLabel::Class(ClassId(1));

fn cloud(root: &TempDir, frame: usize) -> PointCloud<PointLabel> {
    let sweep = &load(root).unwrap().sweeps[frame];
    let read = open(root).read_sweep(sweep).unwrap();
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    read.cloud
}

#[test]
fn points_are_moved_to_where_the_lidar_stood_at_the_scans_pose() {
    let cloud = cloud(&bare(), 1);
    // The lidar goes 1 m a turn: what is a quarter of a turn to the left was seen 0.25 m before,
    // what is half a turn to the right half a metre later.
    let expected = [[10.1, 0.1, -1.63], [-0.25, 8.0, -1.0], [-5.5, -0.01, 0.5], [20.1, 0.1, 0.1]];
    for (i, expected) in expected.into_iter().enumerate() {
        let [place, origin] = [cloud.positions[i], cloud.origin(i)];
        let seen = POINTS[i].map(f64::from);
        assert!((place - Point3::from(expected)).norm() < 4e-3, "{place} {expected:?}");
        let shift = place.x - seen[0];
        assert!((origin - Point3::new(shift, 0.0, 0.0)).norm() < 1e-6, "{origin} {shift}");
    }
}

#[test]
fn a_scans_own_labels_go_by_kitti_360s_numbers() {
    let root = bare();
    let labels = [7_u32, 26 | 5 << 16, 0, 23];
    let bytes: Vec<u8> = labels.iter().flat_map(|label| label.to_le_bytes()).collect();
    put(&root, &label_file(1), bytes);
    let labelled: Vec<bool> = load(&root).unwrap().sweeps.iter().map(|s| s.labelled).collect();
    assert_eq!(labelled, [false, true, false, false, false]);
    let cloud = cloud(&root, 1);
    assert_eq!(cloud.labels, [ROAD, CAR, PointLabel::Unlabelled, PointLabel::Ignored]);
}

/// A cloud of what stands still, of frames 1 to 2.
fn put_fused(root: &TempDir, points: &[([f32; 3], i32)]) -> String {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\ncomment x\nelement vertex 2\n\
        property float x\nproperty float y\nproperty float z\nproperty uchar red\n\
        property uchar green\nproperty uchar blue\nproperty int semantic\nproperty int instance\n\
        property uchar visible\nproperty float confidence\nend_header\n"
        .to_vec();
    for (place, class) in points {
        place.iter().for_each(|metres| bytes.extend(metres.to_le_bytes()));
        bytes.extend([1, 2, 3]);
        bytes.extend(class.to_le_bytes());
        bytes.extend([0; 9]);
    }
    let file = format!("data_3d_semantics/train/{DRIVE}/static/0000000001_0000000002.ply");
    put(root, &file, bytes);
    file
}

#[test]
fn fused_labels_serve_the_scans_of_their_window() {
    let root = bare();
    // Where frame 1 sees its first point: 11 m east, on the road; and the lidar's height 20 m ahead.
    let file = put_fused(&root, &[([11.15, 50.15, 100.15], 7), ([21.05, 50.05, 101.85], 20)]);
    let (log, scene) = (open(&root), load(&root).unwrap());
    let labelled: Vec<bool> = scene.sweeps.iter().map(|sweep| sweep.labelled).collect();
    assert_eq!(labelled, [false, true, true, false, false]);
    assert_eq!(log.sweep_files(&scene.sweeps[1])[1], file);
    let none = PointLabel::Unlabelled;
    let sign = PointLabel::Class(ClassId(19));
    assert_eq!(cloud(&root, 1).labels, [ROAD, none, none, sign]);
    assert_eq!(cloud(&root, 2).labels, [none; 4]);
}
