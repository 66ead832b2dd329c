//! What a broken log gets.

use std::fs;

use occlabel_core::{Fault, Loss, Scene};
use occlabel_logs::{CodaLog, Inventory, ReadOptions, SceneSource};

use crate::log::{
    LABELS, LENS, MOUNTING, POSES, TIMES, boxed, boxes, load, open, options, put, remove, tiny,
};

const BOXES: &str = "3d_bbox/os1/7/3d_bbox_os1_7_1.json";
const LENS_0: &str = "calibrations/7/calib_cam0_intrinsics.yaml";
const MOUNTING_0: &str = "calibrations/7/calib_os1_to_cam0.yaml";

fn refused(scene: &Scene) -> Vec<(Loss, &'static str)> {
    scene.refused.iter().map(|lost| (lost.loss, lost.fault.rule)).collect()
}

/// The fault of reading the second sweep.
fn sweep_fault(root: &tempfile::TempDir) -> Fault {
    let scene = load(root).unwrap();
    open(root).read_sweep(&scene.sweeps[1]).unwrap_err()
}

#[test]
fn a_folder_without_sequences_is_no_log() {
    let root = tempfile::tempdir().unwrap();
    put(&root, "3d_comp/os1/readme.txt", "");
    assert_eq!(CodaLog::open(root.path(), options()).unwrap_err().rule, "coda-layout");
}

#[test]
fn fault_04_a_posed_frame_without_points_is_missing() {
    let root = tiny();
    remove(&root, "3d_comp/os1/7/3d_comp_os1_7_1.bin");
    let scene = load(&root).unwrap();
    let missing = Inventory::take(&open(&root), root.path(), &scene).missing;
    assert_eq!((scene.sweeps.len(), missing.len()), (3, 1));
    assert_eq!(missing[0].file, "3d_comp/os1/7/3d_comp_os1_7_1.bin");
}

#[test]
fn frames_without_a_pose_or_a_time_are_refused_and_their_boxes_with_them() {
    let first = |text: &str| text.lines().take(2).collect::<Vec<_>>().join("\n");
    for (file, text, rule) in
        [("poses/dense/7.txt", POSES, "frame-pose"), ("timestamps/7.txt", TIMES, "frame-time")]
    {
        let root = tiny();
        put(&root, file, first(text));
        let scene = load(&root).unwrap();
        assert_eq!((scene.sweeps.len(), scene.keyframes.len()), (2, 1));
        let keyframe = Loss::Keyframe;
        assert_eq!(refused(&scene), [(keyframe, rule), (keyframe, "box-frame")]);
        assert_eq!(scene.refused[0].fault.record.as_deref(), Some("line 3"));
    }
}

#[test]
fn texts_that_are_absent_spoil_the_scene() {
    for (file, both) in [
        ("poses/dense/7.txt", "poses/dense_global/7.txt, poses/dense/7.txt"),
        ("timestamps/7.txt", "timestamps/7.txt, timestamps/7_frame_to_ts.txt"),
    ] {
        let root = tiny();
        remove(&root, file);
        let fault = load(&root).unwrap_err();
        assert_eq!((fault.rule, fault.place.as_str()), ("missing-file", both));
    }
}

#[test]
fn a_pose_of_another_time_is_told_once() {
    let root = tiny();
    put(&root, "poses/dense/7.txt", POSES.replace("185.6", "186.6").replace("185.7", "187.7"));
    let scene = load(&root).unwrap();
    assert_eq!(scene.warnings.len(), 1);
    let told = scene.warnings[0].to_string();
    assert!(told.contains("1.000 s apart") && told.contains("2 such records"), "{told}");
}

#[test]
fn fault_12_a_pose_without_a_rotation_is_refused() {
    let root = tiny();
    put(&root, "poses/dense/7.txt", POSES.replacen("1 0 0 0\n", "0 0 0 0\n", 1));
    let scene = load(&root).unwrap();
    assert_eq!((scene.sweeps.len(), refused(&scene)), (2, vec![(Loss::Keyframe, "frame-pose")]));
    assert!(scene.refused[0].fault.found.contains("norm 0"), "{:?}", scene.refused);
}

#[test]
fn fault_14_a_mounting_that_is_no_rigid_transform_costs_its_camera() {
    for (text, found) in [
        (MOUNTING.replace("0, 0, -1, -0.2", "0, 0, 1, -0.2"), "a determinant of -1"),
        (MOUNTING.replace("    1, 0, 0, 0,", "    1, 0, 0,"), "15 numbers"),
        (MOUNTING.replace("-0.2", "-0.2x"), "`-0.2x`"),
        ("extrinsic_matrix: 3\n".to_owned(), "0 numbers"),
    ] {
        let root = tiny();
        put(&root, MOUNTING_0, text);
        let scene = load(&root).unwrap();
        assert_eq!(refused(&scene), [(Loss::Camera, "calibration")]);
        let told = scene.refused[0].fault.to_string();
        assert!(told.contains(MOUNTING_0) && told.contains(found), "{told}");
        assert_eq!(scene.cameras.len(), 1, "the other camera stays");
        assert_eq!(scene.keyframes[0].exposures.len(), 1);
    }
}

#[test]
fn fault_29_a_lens_that_is_none_costs_its_camera_and_none_at_all_is_told() {
    for (text, rule) in [
        (LENS.replace("plumb_bob", "equidistant"), "calibration"),
        (LENS.replace("image_width: 1224", "image_width: 0"), "calibration"),
        (LENS.replace("data: [730,", "data: [0,"), "camera-model"),
        (LENS.replace("0.0011, -0.0036, ", ""), "camera-model"),
    ] {
        let root = tiny();
        put(&root, LENS_0, &text);
        assert_eq!(refused(&load(&root).unwrap()), [(Loss::Camera, rule)], "{text}");
    }
    let root = tiny();
    fs::remove_dir_all(root.path().join("calibrations")).unwrap();
    let scene = load(&root).unwrap();
    let rules: Vec<_> = scene.warnings.iter().map(|warning| warning.rule).collect();
    assert!(scene.cameras.is_empty() && scene.refused.is_empty() && rules == ["camera-absent"]);
}

#[test]
fn fault_03_points_are_whole() {
    let root = tiny();
    put(&root, "3d_comp/os1/7/3d_comp_os1_7_1.bin", [0; 40]);
    let fault = sweep_fault(&root);
    assert_eq!((fault.rule, fault.record.as_deref()), ("sweep-length", Some("sweep 7/1")));
}

#[test]
fn fault_27_there_is_a_byte_for_each_point() {
    let root = tiny();
    put(&root, "3d_semantic/os1/7/3d_semantic_os1_7_1.bin", &LABELS[..3]);
    let fault = sweep_fault(&root);
    let told = "expected 4 bytes, a label for each of 4 points, found 3 bytes";
    assert!(fault.rule == "label-count" && fault.to_string().contains(told), "{fault}");
}

#[test]
fn fault_26_unknown_labels_and_categories_are_refused_unless_a_class_stands_in() {
    let root = tiny();
    put(&root, "3d_semantic/os1/7/3d_semantic_os1_7_1.bin", [10, 77, 99, 77]);
    let told = sweep_fault(&root).to_string();
    assert!(told.contains("found 77 (77) of 2 points, 99 (99) of 1 points"), "{told}");
    put(&root, BOXES, boxes(&[boxed("Spaceship", "Spaceship:1", 0.0)]));
    let fault = load(&root).unwrap_err();
    let told = fault.to_string();
    assert!(fault.rule == "unknown-category" && told.contains("`Spaceship` of 1 boxes"), "{told}");
    let car = occlabel_core::ClassId(1);
    let options = ReadOptions { unknown_as: Some(car), ..options() };
    let log = CodaLog::open(root.path(), options).unwrap();
    let scene = log.load("7").unwrap();
    assert_eq!(scene.tracks.len(), 2);
    let labels = log.read_sweep(&scene.sweeps[1]).unwrap().cloud.labels;
    assert_eq!(labels[1..], [occlabel_core::PointLabel::Class(car); 3]);
}

#[test]
fn fault_23_a_box_without_a_size_or_a_place_is_refused_alone() {
    for text in [
        boxed("Car", "Car:2", 0.0).replace("\"l\": 4", "\"l\": 0"),
        boxed("Car", "Car:2", 0.0).replace("\"cX\": 3", "\"cX\": 3e9"),
    ] {
        let root = tiny();
        put(&root, BOXES, boxes(&[boxed("Car", "Car:1", 0.0), text]));
        let scene = load(&root).unwrap();
        assert_eq!(refused(&scene), [(Loss::Annotation, "box")]);
        assert_eq!(scene.refused[0].fault.record.as_deref(), Some("Car:2"));
        assert_eq!((scene.tracks.len(), scene.keyframes.len()), (1, 2));
    }
}

#[test]
fn a_file_of_boxes_that_is_none_costs_its_keyframe() {
    for text in ["", "[]", r#"{"3dbbox": [{"classId": "Car"}]}"#, r#"{"3dbbox": 7}"#] {
        let root = tiny();
        put(&root, BOXES, text);
        let scene = load(&root).unwrap();
        assert_eq!(refused(&scene), [(Loss::Keyframe, "boxes")], "{text}");
        assert_eq!(scene.refused[0].fault.place, BOXES);
        assert_eq!(scene.keyframes.len(), 1);
    }
}

#[test]
fn a_track_has_one_box_at_a_frame() {
    let root = tiny();
    put(&root, BOXES, boxes(&[boxed("Car", "Car:1", 0.0), boxed("Car", "Car:1", 1.0)]));
    let fault = load(&root).unwrap_err();
    assert_eq!((fault.rule, fault.place.as_str()), ("track-time", BOXES));
}

#[test]
fn fault_36_a_folder_that_cannot_name_a_scene_is_none() {
    let root = tiny();
    put(&root, "3d_raw/os1/a b/3d_raw_os1_a b_0.bin", "");
    assert_eq!(open(&root).load("a b").unwrap_err().rule, "scene-name");
}
