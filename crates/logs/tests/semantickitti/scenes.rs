//! What a sound log becomes.

use nalgebra::Point3;
use occlabel_core::{ClassId, PointLabel, Timestamp};
use occlabel_logs::{Inventory, ReadOptions, SceneSource, SemanticKittiLog};

use crate::log::{POINTS, load, open, options, tiny, write_sequence};

#[test]
fn the_pose_chain_moves_points_by_the_cameras_poses_and_the_mounting() {
    let scene = load(&tiny()).unwrap();
    // The lidar is 1.73 m up and 0.27 m behind the ego's origin, which is below the camera.
    let seen = Point3::new(10.0, 1.0, -1.73);
    let expected = [[9.73, 1.0, 0.0], [11.73, 1.0, 0.0], [1.0, 9.73, 0.0]].map(Point3::from);
    for (sweep, expected) in scene.sweeps.iter().zip(expected) {
        let found = sweep.world_from_lidar() * seen;
        assert!((found - expected).norm() < 1e-12, "{}: {found}, {expected}", sweep.source_id);
    }
}

#[test]
fn every_scan_is_a_sweep_and_a_keyframe_at_its_time() {
    let root = tiny();
    let scene = load(&root).unwrap();
    let times: Vec<i64> = scene.sweeps.iter().map(|sweep| sweep.time.0).collect();
    assert_eq!(times, [0, 103_735_900, 207_472_000]);
    let labelled: Vec<bool> = scene.sweeps.iter().map(|sweep| sweep.labelled).collect();
    assert_eq!(labelled, [true, true, false]);
    let tokens: Vec<&str> = scene.keyframes.iter().map(|key| key.token.as_str()).collect();
    assert_eq!(tokens, ["0", "103735900", "207472000"]);
    assert!(scene.tracks.is_empty() && scene.cameras.is_empty() && scene.refused.is_empty());
    let inventory = Inventory::take(&open(&root), root.path(), &scene);
    assert_eq!((inventory.present.len(), inventory.missing.len()), (5, 0));
    assert_eq!(open(&root).tables().len(), 3);
}

#[test]
fn a_label_is_the_lower_half_and_zero_is_none() {
    let root = tiny();
    let (log, scene) = (open(&root), load(&root).unwrap());
    let read = log.read_sweep(&scene.sweeps[0]).unwrap();
    let [car, road] = [0, 1].map(|id| PointLabel::Class(ClassId(id)));
    assert_eq!(read.cloud.labels, [road, car, PointLabel::Unlabelled, PointLabel::Ignored]);
    assert!(read.warnings.is_empty());
    for (point, [x, y, z, _]) in read.cloud.positions.iter().zip(POINTS) {
        assert_eq!(*point, Point3::new(x, y, z).cast::<f64>());
    }
    let bare = log.read_sweep(&scene.sweeps[2]).unwrap();
    assert_eq!(bare.cloud.labels, [PointLabel::Unlabelled; 4]);
}

#[test]
fn one_sequence_is_a_log_too_and_its_folder_names_the_scene() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("drive_7");
    write_sequence(&folder);
    let log = SemanticKittiLog::open(&folder, options()).unwrap();
    assert_eq!(log.scene_names(), ["drive_7"]);
    let scene = log.load("drive_7").unwrap();
    assert_eq!(scene.sweeps[1].file, "velodyne/000001.bin");
    assert_eq!(log.read_sweep(&scene.sweeps[1]).unwrap().cloud.len(), 4);
}

#[test]
fn sequences_stand_in_order_and_only_wanted_ones_are_read() {
    let root = tiny();
    write_sequence(&root.path().join("sequences/10"));
    write_sequence(&root.path().join("sequences/08"));
    assert_eq!(open(&root).scene_names(), ["00", "08", "10"]);
    let wanted = |name: &str| ReadOptions { scenes: Some([name.to_owned()].into()), ..options() };
    let log = SemanticKittiLog::open(root.path(), wanted("08")).unwrap();
    assert_eq!((log.scene_names(), log.tables().len()), (vec!["08".to_owned()], 3));
    let fault = SemanticKittiLog::open(root.path(), wanted("11")).unwrap_err();
    assert_eq!(fault.rule, "scene-unknown");
    assert!(fault.to_string().contains("`10`"), "{fault}");
}

#[test]
fn times_are_the_scans_own() {
    let root = tiny();
    crate::log::put(&root, "times.txt", "1.0\n0.5\n1.0\n");
    let scene = load(&root).unwrap();
    let files: Vec<&str> = scene.sweeps.iter().map(|sweep| &sweep.source_id[3..]).collect();
    assert_eq!(files, ["000001", "000000", "000002"]);
    assert_eq!(scene.sweeps[0].time, Timestamp(500_000_000));
    assert_eq!(scene.keyframes.len(), 2, "two scans of one time are one keyframe");
    assert_eq!(scene.warnings.len(), 1);
    assert!(scene.warnings[0].to_string().contains("a step of -0.5 s"), "{}", scene.warnings[0]);
}
