//! What a broken log gets.

use std::fs;

use occlabel_core::{Fault, Loss};
use occlabel_logs::{Inventory, ReadOptions, SceneSource, SemanticKittiLog};

use crate::log::{CALIB, LABELS, POSES, load, open, options, put, tiny};

/// The fault of reading the first sweep.
fn sweep_fault(root: &tempfile::TempDir) -> Fault {
    let scene = load(root).unwrap();
    open(root).read_sweep(&scene.sweeps[0]).unwrap_err()
}

#[test]
fn a_folder_without_sequences_is_no_log() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir_all(root.path().join("sequences/00")).unwrap();
    let fault = SemanticKittiLog::open(root.path(), options()).unwrap_err();
    assert_eq!(fault.rule, "semantickitti-layout");
}

#[test]
fn fault_04_a_posed_scan_without_a_file_is_missing() {
    let root = tiny();
    fs::remove_file(root.path().join("sequences/00/velodyne/000001.bin")).unwrap();
    let scene = load(&root).unwrap();
    let missing = Inventory::take(&open(&root), root.path(), &scene).missing;
    assert_eq!((scene.sweeps.len(), missing.len()), (3, 1));
    assert_eq!(missing[0].file, "sequences/00/velodyne/000001.bin");
}

#[test]
fn scans_without_a_pose_or_a_time_are_refused() {
    for (file, text, rule) in [
        ("poses.txt", POSES.lines().next().unwrap(), "scan-pose"),
        ("times.txt", "0.0\n", "scan-time"),
    ] {
        let root = tiny();
        put(&root, file, text);
        let scene = load(&root).unwrap();
        assert_eq!((scene.sweeps.len(), scene.keyframes.len()), (1, 1));
        let lost: Vec<_> = scene.refused.iter().map(|lost| (lost.loss, lost.fault.rule)).collect();
        assert_eq!(lost, [(Loss::Keyframe, rule); 2]);
    }
}

#[test]
fn text_files_that_are_absent_spoil_the_scene() {
    for file in ["calib.txt", "poses.txt", "times.txt"] {
        let root = tiny();
        fs::remove_file(root.path().join("sequences/00").join(file)).unwrap();
        let fault = load(&root).unwrap_err();
        assert_eq!((fault.rule, fault.place), ("missing-file", format!("sequences/00/{file}")));
    }
    let root = tiny();
    for file in ["poses.txt", "times.txt"] {
        fs::remove_file(root.path().join("sequences/00").join(file)).unwrap();
    }
    let both = "sequences/00/poses.txt, sequences/00/times.txt";
    assert_eq!(load(&root).unwrap_err().place, both);
}

#[test]
fn fault_14_mirrored_skewed_and_broken_matrices_are_refused() {
    let line = |text: &str| POSES.replacen("1 0 0 0 0 1 0 0 0 0 1 2", text, 1);
    for (text, found) in [
        ("-1 0 0 0 0 1 0 0 0 0 1 2", "a determinant of -1"),
        ("1 0.01 0 0 0 1 0 0 0 0 1 2", "a matrix that is off a rotation"),
        ("1 0 0 0 0 1 0 0 0 0 1", "11 numbers"),
        ("1 0 0 nan 0 1 0 0 0 0 1 2", "`nan`"),
        ("", "0 numbers"),
    ] {
        let root = tiny();
        put(&root, "poses.txt", line(text));
        let scene = load(&root).unwrap();
        assert_eq!((scene.sweeps.len(), scene.refused.len()), (2, 1));
        let told = scene.refused[0].fault.to_string();
        assert!(told.contains("poses.txt (line 2)") && told.contains(found), "{told}");
    }
    let root = tiny();
    put(&root, "calib.txt", CALIB.replace("Tr: 0 -1", "Tr: 0 1"));
    assert_eq!(load(&root).unwrap_err().rule, "lidar-pose");
    put(&root, "calib.txt", "P0: 1\n");
    assert!(load(&root).unwrap_err().to_string().ends_with("found no such line"));
}

#[test]
fn fault_03_points_are_whole() {
    let root = tiny();
    put(&root, "velodyne/000000.bin", [0; 40]);
    let fault = sweep_fault(&root);
    assert_eq!((fault.rule, fault.record.as_deref()), ("sweep-length", Some("sweep 00/000000")));
}

#[test]
fn fault_27_there_is_a_label_for_each_point() {
    let root = tiny();
    put(&root, "labels/000000.label", [0; 12]);
    let fault = sweep_fault(&root);
    assert_eq!(fault.rule, "label-count");
    assert!(
        fault.to_string().contains("expected 16 bytes, a label for each of 4 points"),
        "{fault}"
    );
}

#[test]
fn fault_26_an_unknown_label_is_refused_unless_a_class_stands_in() {
    let root = tiny();
    let labels = [LABELS[0], 99, 77, 99];
    let bytes: Vec<u8> = labels.iter().flat_map(|label| label.to_le_bytes()).collect();
    put(&root, "labels/000000.label", bytes);
    let fault = sweep_fault(&root);
    let told = "found 77 (77) of 1 points, 99 (other-object) of 2 points";
    assert!(fault.rule == "unknown-label" && fault.to_string().contains(told), "{fault}");
    let car = occlabel_core::ClassId(0);
    let options = ReadOptions { unknown_as: Some(car), ..options() };
    let log = SemanticKittiLog::open(root.path(), options).unwrap();
    let read = log.read_sweep(&log.load("00").unwrap().sweeps[0]).unwrap();
    assert_eq!(read.cloud.labels[1..], [occlabel_core::PointLabel::Class(car); 3]);
    assert!(read.warnings[0].to_string().contains("taken as `car`"));
    assert_eq!(format!("found {}", read.unknown), told);
}

#[test]
fn fault_36_a_folder_that_cannot_name_a_scene_is_none() {
    let root = tiny();
    let sequences = root.path().join("sequences");
    fs::rename(sequences.join("00"), sequences.join("a b")).unwrap();
    assert_eq!(open(&root).load("a b").unwrap_err().rule, "scene-name");
}
