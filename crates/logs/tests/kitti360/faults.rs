//! What a broken log gets.

use std::cell::Cell;
use std::fs;

use occlabel_core::Loss;
use occlabel_logs::{Inventory, Kitti360Log, ReadOptions, SceneSource};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::log::{
    CAMERAS, DRIVE, bare, label_file, load, object, open, options, poses, put, put_boxes,
    scan_file, stamps, told,
};

#[test]
fn files_that_it_cannot_do_without_spoil_the_scene() {
    for file in [
        "calibration/calib_cam_to_pose.txt".to_owned(),
        "calibration/calib_cam_to_velo.txt".to_owned(),
        format!("data_poses/{DRIVE}/poses.txt"),
        format!("data_3d_raw/{DRIVE}/velodyne_points/timestamps.txt"),
    ] {
        let root = bare();
        fs::remove_file(root.path().join(&file)).unwrap();
        let fault = load(&root).unwrap_err();
        assert_eq!(fault.rule, "missing-file", "{file}: {fault}");
    }
    let root = bare();
    let wanted = ReadOptions { scenes: Some(["drive_x".to_owned()].into()), ..options() };
    let fault = Kitti360Log::open(root.path(), wanted).unwrap_err();
    assert!(fault.rule == "scene-unknown" && fault.to_string().contains(DRIVE), "{fault}");
}

#[test]
fn what_it_can_do_without_is_told() {
    let scene = load(&bare()).unwrap();
    assert!(scene.refused.is_empty());
    assert_eq!(
        told(&scene),
        [
            "pose-between",
            "boxes-absent",
            "camera-absent",
            "camera-absent",
            "camera-absent",
            "camera-absent"
        ]
    );
}

#[test]
fn fault_04_a_posed_frame_without_a_scan_is_missing() {
    let root = bare();
    fs::remove_file(root.path().join(scan_file(3))).unwrap();
    let missing = Inventory::take(&open(&root), root.path(), &load(&root).unwrap()).missing;
    assert_eq!((missing.len(), missing[0].file.clone()), (1, scan_file(3)));
}

#[test]
fn fault_14_lines_that_are_no_poses_are_refused() {
    for (line, found) in [
        ("1 1 0 0 1 0 1 0 50 0 0 -1 100.93", "a determinant of -1"),
        ("1 1 0 0 1 0 -1 0 50 0 0 -1", "12 numbers"),
        ("1 1 0.1 0 1 0 -1 0 50 0 0 -1 100.93", "off a rotation"),
        ("1.5 1 0 0 1 0 -1 0 50 0 0 -1 100.93", "frame 1.5"),
        ("-1 1 0 0 1 0 -1 0 50 0 0 -1 100.93", "frame -1"),
        ("1e20 1 0 0 1 0 -1 0 50 0 0 -1 100.93", "frame 100000000000000000000"),
    ] {
        let root = bare();
        let lines = poses().replace("1 1 0 0 1 0 -1 0 50 0 0 -1 100.93", line);
        put(&root, &format!("data_poses/{DRIVE}/poses.txt"), lines);
        let scene = load(&root).unwrap();
        assert_eq!((scene.sweeps.len(), scene.refused.len()), (5, 1));
        let told = scene.refused[0].fault.to_string();
        assert!(told.contains("poses.txt (line 2)") && told.contains(found), "{told}");
    }
    let root = bare();
    put(
        &root,
        "calibration/calib_cam_to_pose.txt",
        CAMERAS.replace("image_00: 0 0 1", "image_00: 0 0 -1"),
    );
    assert_eq!(load(&root).unwrap_err().rule, "calibration");
}

#[test]
fn a_scan_without_a_time_is_refused() {
    let root = bare();
    let lines = stamps().replace("08:46:02.400000000", "soon");
    put(&root, &format!("data_3d_raw/{DRIVE}/velodyne_points/timestamps.txt"), lines);
    let scene = load(&root).unwrap();
    assert_eq!((scene.sweeps.len(), scene.refused.len()), (4, 1));
    assert!(scene.refused[0].fault.to_string().contains("timestamps.txt (line 5)"));
}

#[test]
fn fault_23_boxes_that_are_none_are_refused() {
    let root = bare();
    let good = object(13, 1, [0, 4, 1], [20.0, 50.0, 100.0]);
    let bad = [
        good.replace("0 -2 0 20", "0 2 0 20"),
        good.replace("0 -2 0 20", "0 0 0 20"),
        good.replace("0 -2 0 20", "3 -2 0 20"),
        good.replace("0 -2 0 20", "nan -2 0 20"),
        good.replace("<cols>3</cols><dt>f</dt><data>", "<cols>3</cols><dt>f</dt><data>1 "),
    ];
    for bad in bad {
        put_boxes(&root, &[good.clone(), bad.replace("<instanceId>1", "<instanceId>2")]);
        let scene = load(&root).unwrap();
        assert_eq!((scene.tracks.len(), scene.refused.len()), (1, 1), "{bad}");
        assert_eq!(scene.refused[0].loss, Loss::Annotation);
    }
    put_boxes(&root, &[good.clone(), good]);
    assert_eq!(load(&root).unwrap_err().rule, "track-time");
}

#[test]
fn fault_27_there_is_a_label_for_each_point() {
    let root = bare();
    put(&root, &label_file(0), [0; 12]);
    let sweep = &load(&root).unwrap().sweeps[0];
    let fault = open(&root).read_sweep(sweep).unwrap_err();
    let record = format!("sweep {DRIVE}/0000000000");
    assert_eq!((fault.rule, fault.record), ("label-count", Some(record)));
}

/// Bent text files never end the program, and are read or refused.
#[test]
fn bent_files_are_read_or_refused() {
    let root = bare();
    put_boxes(&root, &[object(13, 1, [0, 4, -1], [20.0, 50.0, 100.0])]);
    let files = [
        format!("data_3d_bboxes/train/{DRIVE}.xml"),
        format!("data_poses/{DRIVE}/poses.txt"),
        format!("data_3d_raw/{DRIVE}/velodyne_points/timestamps.txt"),
        "calibration/calib_cam_to_velo.txt".to_owned(),
        "calibration/image_02.yaml".to_owned(),
    ];
    let sound: Vec<Vec<u8>> =
        files.iter().map(|file| fs::read(root.path().join(file)).unwrap()).collect();
    let (read, refused) = (Cell::new(0), Cell::new(0));
    let config = Config { failure_persistence: None, ..Config::with_cases(400) };
    let bent = (0..files.len(), any::<usize>(), any::<u8>(), 0..8_u8);
    let outcome = TestRunner::new(config).run(&bent, |(which, at, byte, kind)| {
        let (mut bytes, at) = (sound[which].clone(), at % sound[which].len());
        match kind {
            0 => bytes.truncate(at),
            _ => bytes[at] = byte,
        }
        fs::write(root.path().join(&files[which]), bytes).unwrap();
        let count = if load(&root).is_ok() { &read } else { &refused };
        count.set(count.get() + 1);
        fs::write(root.path().join(&files[which]), &sound[which]).unwrap();
        Ok(())
    });
    outcome.unwrap();
    assert!(read.get() > 20 && refused.get() > 20, "{read:?} {refused:?}");
}
