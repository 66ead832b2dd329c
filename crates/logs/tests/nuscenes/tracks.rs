//! Boxes, tracks and categories.

use nalgebra::Vector3;
use occlabel_core::{Loss, Meaning, Timestamp, TrackId};
use serde_json::json;

use crate::tiny_log::{CAR, NAN, ROAD, TinyLog};

#[test]
fn section_2_a_box_on_disk_is_width_length_height_and_stands_at_the_key_sweeps_time() {
    let scene = TinyLog::new().scene();
    let track = &scene.tracks[0];
    assert_eq!((track.id, track.source_id.as_str()), (TrackId(1), "i0"));
    assert_eq!((track.meaning, track.category.as_str()), (Meaning::Class(CAR), "vehicle.car"));
    let (time, boxed) = &track.boxes[1];
    assert_eq!(*time, Timestamp::from_micros(1_500_000));
    assert_eq!(boxed.size_m, Vector3::new(4.0, 2.0, 1.5));
    assert_eq!(boxed.world_from_box.translation.vector, Vector3::new(24.0, 3.0, 0.8));
}

#[test]
fn section_2_track_ids_go_by_the_bytes_of_the_instances_tokens() {
    let mut log = TinyLog::new();
    for token in ["Z", "00000000000000000000000000000001", "i00"] {
        log.copy("instance", "i0", &[("token", json!(token))]);
        log.copy(
            "sample_annotation",
            "a0",
            &[("token", json!(format!("a-{token}"))), ("instance_token", json!(token))],
        );
    }
    let ids: Vec<(u16, String)> =
        log.scene().tracks.into_iter().map(|track| (track.id.0, track.source_id)).collect();
    let expected = ["00000000000000000000000000000001", "Z", "i0", "i00"].map(String::from);
    assert_eq!(ids, (1..).zip(expected).collect::<Vec<_>>());
}

#[test]
fn section_2_two_boxes_of_a_track_at_one_time_are_a_fault() {
    let mut log = TinyLog::new();
    log.copy("sample_annotation", "a0", &[("token", json!("again"))]);
    let refusal = log.refusal();
    assert!(refusal.starts_with("sample_annotation.json (again, at byte "), "{refusal}");
    assert!(refusal.contains("found two of `i0`"), "{refusal}");
}

#[test]
fn fault_12_a_box_that_is_turned_impossibly_is_refused_alone() {
    for rotation in
        [json!([0.0, 0.0, 0.0, 0.0]), json!([NAN, 0.0, 0.0, 1.0]), json!([0.9, 0, 0, 0])]
    {
        let mut log = TinyLog::new();
        log.row("sample_annotation", "a1")["rotation"] = rotation;
        let scene = log.scene();
        assert_eq!(scene.tracks[0].boxes.len(), 1);
        assert_eq!(scene.refused[0].loss, Loss::Annotation);
        assert_eq!(scene.refused[0].fault.rule, "quaternion-norm");
    }
}

#[test]
fn fault_23_a_box_without_a_size_or_place_is_refused_alone() {
    let sizes = [json!([0.0, 4.0, 1.5]), json!([2.0, -4.0, 1.5]), json!([2.0, 4.0, NAN])];
    let places = [json!([NAN, 0.0, 0.0])];
    let changes =
        sizes.map(|size| ("size", size)).into_iter().chain(places.map(|at| ("translation", at)));
    let mut refused = 0;
    for (field, value) in changes {
        let mut log = TinyLog::new();
        log.row("sample_annotation", "a0")[field] = value;
        let scene = log.scene();
        assert_eq!(scene.tracks[0].boxes.len(), 1);
        let [refusal] = &scene.refused[..] else { panic!("{:?}", scene.refused) };
        assert_eq!(refusal.loss, Loss::Annotation);
        let text = refusal.fault.to_string();
        assert!(text.starts_with("sample_annotation.json (a0, at byte "), "{text}");
        refused += 1;
    }
    assert_eq!(refused, 4);
}

#[test]
fn fault_23_a_track_without_a_usable_box_is_left_out() {
    let mut log = TinyLog::new();
    for token in ["a0", "a1"] {
        log.row("sample_annotation", token)["size"] = json!([0.0, 0.0, 0.0]);
    }
    let scene = log.scene();
    assert_eq!((scene.tracks.len(), scene.refused.len()), (0, 2));
}

#[test]
fn fault_26_an_unknown_category_is_told_with_its_count() {
    let mut log = TinyLog::new();
    log.row("category", "cat-car")["name"] = json!("vehicle.ufo");
    let refusal = log.refusal();
    assert!(refusal.contains("(scene-0001)") && refusal.contains("`vehicle.ufo` of 2 boxes"));
    assert!(refusal.contains("--unknown-as"), "{refusal}");
    log.options = |options| options.read.unknown_as = Some(ROAD);
    let scene = log.scene();
    assert_eq!(scene.tracks[0].class(), Some(ROAD));
    assert!(scene.warnings[0].found.ends_with("taken as `road`"), "{}", scene.warnings[0]);
}

#[test]
fn a_category_that_is_to_be_ignored_keeps_its_track() {
    let mut log = TinyLog::new();
    log.row("category", "cat-car")["name"] = json!("vehicle.ego");
    assert_eq!(log.scene().tracks[0].meaning, Meaning::Ignore);
}
