//! Boxes: missing, of no size, twice, empty (cases 21 to 25).

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::asserts::{
    arrays, assert_refused, assert_skipped, field, label, label_into, losses, untouched,
};
use crate::support::{Arrays, Label, NAN, SCENE, TestLog, VERSION, gts_files, manifest, report};

/// How many voxels an instance has at each keyframe.
fn voxels_of(log: &TestLog, label: &Label, instance: u16) -> Vec<usize> {
    let count = |arrays: &Arrays| {
        let instances = arrays.evidence.instances.values();
        instances.iter().filter(|found| **found == instance).count()
    };
    arrays(log, label).iter().map(count).collect()
}

/// Index and source id of the track with most voxels at the middle keyframe.
fn largest_track(log: &TestLog, label: &Label) -> (u16, String) {
    let tracks = manifest(&label.output)["scenes"][SCENE]["tracks"].clone();
    let index = |track: &Value| track["index"].as_u64().expect("a number") as u16;
    let tracks = tracks.as_array().expect("tracks").iter();
    let largest = tracks.max_by_key(|track| voxels_of(log, label, index(track))[1]);
    largest.map(|track| (index(track), field(track, "id"))).expect("a track")
}

/// A log whose largest track lacks the annotation of the middle keyframe.
fn with_a_gap() -> (TestLog, u16) {
    let (log, label) = untouched(&[]);
    let (index, instance) = largest_track(&log, &label);
    assert!(voxels_of(&log, &label, index)[1] > 3);
    let middle = log.keyframes()[1].clone();
    log.edit("sample_annotation", |rows| {
        let before = rows.len();
        let is_middle = |row: &Value| {
            row["instance_token"] == instance.as_str() && row["sample_token"] == middle.as_str()
        };
        rows.retain(|row| !is_middle(row));
        assert_eq!(rows.len() + 1, before);
    });
    (log, index)
}

#[test]
fn fault_21_a_missing_middle_box_is_interpolated_over_a_short_gap() {
    let (log, index) = with_a_gap();
    let bridged = label_into(&log, "bridged");
    bridged.run().exits(0);
    assert!(voxels_of(&log, &bridged, index).iter().all(|count| *count > 3));
}

#[test]
fn fault_21_over_a_long_gap_the_object_is_absent() {
    let (log, index) = with_a_gap();
    let torn = label_into(&log, "torn").with(&["--set", "boxes.max_gap_s=0.6"]);
    torn.run().exits(0);
    let voxels = voxels_of(&log, &torn, index);
    assert!(voxels[0] > 0 && voxels[1] == 0 && voxels[2] > 0, "{voxels:?}");
}

#[test]
fn fault_23_a_box_without_a_size_is_refused() {
    for (size, told) in [
        (json!([0.0, 4.5, 1.6]), "0 x 4.5 x 1.6 m"),
        (json!([1.9, -4.5, 1.6]), "1.9 x -4.5 x 1.6 m"),
        (json!([1.9, 4.5, NAN]), "1.9 x 4.5 x NaN m"),
    ] {
        let log = TestLog::nano();
        log.edit("sample_annotation", |rows| rows[0]["size"] = size);
        let token = field(&log_annotations(&log)[0], "token");
        assert_refused(&label(&log), &["sample_annotation.json", &token, told]);
        assert_skipped(&label_into(&log, "skip"), "box-size", &log.keyframes());
        assert_eq!(losses(&log.beside("skip"), "box-size").len(), 1);
    }
}

/// The annotations' tokens, though a bare `NaN` may stand in the table.
fn log_annotations(log: &TestLog) -> Vec<Value> {
    let path = log.file(&format!("{VERSION}/sample_annotation.json"));
    let table = fs::read_to_string(path).expect("a table").replace("NaN", "null");
    serde_json::from_str(&table).expect("rows")
}

#[test]
fn fault_23_a_box_without_a_rotation_is_refused() {
    let log = TestLog::nano();
    log.edit("sample_annotation", |rows| rows[0]["rotation"] = json!([1.0, 0.0, 0.0, NAN]));
    let token = field(&log_annotations(&log)[0], "token");
    assert_refused(&label(&log), &["sample_annotation.json", &token, "norm NaN"]);
    assert_skipped(&label_into(&log, "skip"), "quaternion-norm", &log.keyframes());
}

#[test]
fn fault_23_every_refused_box_is_told_at_once() {
    let log = TestLog::nano();
    let tokens: Vec<String> =
        log.rows("sample_annotation")[..3].iter().map(|row| field(row, "token")).collect();
    log.edit("sample_annotation", |rows| {
        rows[..3].iter_mut().for_each(|row| row["size"] = json!([1.0, 0.0, 1.0]));
    });
    let mut ended = assert_refused(&label(&log), &[]);
    for token in &tokens {
        ended = ended.tells(&[token]);
    }
}

/// Adds a track to the log: another's boxes, changed.
fn add_track(log: &TestLog, like: &str, token: &str, change: impl Fn(&mut Value)) {
    let instance = |row: &&Value| row["token"] == like;
    let mut added = log.rows("instance").iter().find(instance).expect("a track").clone();
    added["token"] = json!(token);
    log.edit("instance", |rows| rows.push(added));
    log.edit("sample_annotation", |rows| {
        let of_track = |row: &&Value| row["instance_token"] == like;
        let mut boxes: Vec<Value> = rows.iter().filter(of_track).cloned().collect();
        for (at, row) in boxes.iter_mut().enumerate() {
            row["token"] = json!(format!("{token}-{at}"));
            row["instance_token"] = json!(token);
            change(row);
        }
        rows.extend(boxes);
    });
}

fn scale_size(row: &mut Value, factor: f64) {
    let sides = row["size"].as_array().expect("a size").iter();
    row["size"] = sides.map(|side| json!(side.as_f64().expect("a side") * factor)).collect();
}

#[test]
fn fault_24_of_two_equal_boxes_the_lower_track_gets_the_points() {
    let (log, clean) = untouched(&[]);
    let (_, car) = largest_track(&log, &clean);
    add_track(&log, &car, "ffffffff", |_| ());
    let label = label_into(&log, "added");
    label.run().exits(0);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_24_of_two_boxes_the_smaller_gets_the_points() {
    let (log, clean) = untouched(&[]);
    let (index, car) = largest_track(&log, &clean);
    add_track(&log, &car, "ffffffff", |row| scale_size(row, 0.999));
    let label = label_into(&log, "added");
    label.run().exits(0);
    let last = manifest(&label.output)["scenes"][SCENE]["tracks"].as_array().map(Vec::len);
    let smaller = voxels_of(&log, &label, last.expect("tracks") as u16);
    assert_eq!(smaller, voxels_of(&log, &clean, index));
    assert!(smaller.iter().all(|count| *count > 3), "{smaller:?}");
    assert_eq!(voxels_of(&log, &label, index), [0; 3]);
}

/// Lifts a box out of everything into the sky.
fn lift(row: &mut Value) {
    row["translation"][2] = json!(row["translation"][2].as_f64().expect("a height") + 3.2);
}

#[test]
fn fault_25_a_box_without_points_occupies_nothing_and_is_counted() {
    let (log, clean) = untouched(&[]);
    let (_, car) = largest_track(&log, &clean);
    add_track(&log, &car, "ffffffff", lift);
    let label = label_into(&log, "added");
    label.run().exits(0);
    let empty =
        |output: &Path| report(output)["total"]["boxes_without_points"].as_u64().expect("a count");
    assert_eq!(empty(&label.output), empty(&clean.output) + 3);
    for (with, without) in arrays(&log, &label).iter().zip(&arrays(&log, &clean)) {
        assert_eq!(with.labels.semantics, without.labels.semantics);
        assert_eq!(with.evidence.instances, without.evidence.instances);
    }
}
