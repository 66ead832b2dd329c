//! Hostile names of files, scenes, categories and keyframes (case 36).

use serde_json::json;

use crate::asserts::{SKIP, assert_refused, label, label_into, rename_category};
use crate::support::{Ended, TestLog, occlabel, text};

/// Names that lead out of the log, or write to the terminal.
const HOSTILE: [&str; 6] = [
    "/etc/passwd",
    "../../../etc/passwd",
    "sweeps/../../../x",
    "sweeps/a\0b",
    "sweeps/\u{1b}]0;owned\u{7}\u{1b}[31mred",
    "C:\\windows\\x",
];

/// Asserts that no stream carries a raw control character.
#[track_caller]
fn assert_clean(ended: &Ended) {
    for stream in [&ended.stdout, &ended.stderr] {
        assert!(!stream.chars().any(|c| c.is_control() && c != '\n'), "{stream:?}");
    }
}

#[test]
fn fault_36_a_hostile_sweep_name_is_refused_and_escaped() {
    for name in HOSTILE {
        let log = TestLog::nano();
        let token = log.sweeps()[2]["token"].clone();
        log.edit("sample_data", |rows| {
            let row = rows.iter_mut().find(|row| row["token"] == token);
            row.expect("a sweep")["filename"] = json!(name);
        });
        let parts = ["sample_data.json", token.as_str().expect("a token"), "below the log's root"];
        assert_clean(&assert_refused(&label(&log), &parts));
        assert_clean(&label_into(&log, "skip").with(&SKIP).run().exits(3));
    }
}

#[test]
fn fault_36_a_hostile_label_name_is_refused_and_escaped() {
    for name in HOSTILE {
        let log = TestLog::nano();
        log.edit("lidarseg", |rows| rows[1]["filename"] = json!(name));
        assert_clean(&assert_refused(&label(&log), &["lidarseg.json", "below the log's root"]));
    }
}

#[test]
fn fault_36_a_hostile_scene_name_is_refused_and_escaped() {
    for name in ["../../x", "/tmp/x", "a/b", "..", "", "a\0", "\u{1b}[31mred", "a\nerror: fake"] {
        let log = TestLog::nano();
        log.edit("scene", |rows| rows[0]["name"] = json!(name));
        assert_clean(&assert_refused(&label(&log), &["scene.json", "a name of A-Z"]));
        let line = ["inspect", "--format", "nuscenes", "--input"];
        let root = log.root();
        let inspected = occlabel(&[line[0], line[1], line[2], line[3], text(&root)]);
        assert_clean(&inspected.exits(1));
    }
}

#[test]
fn fault_36_a_hostile_category_name_is_escaped() {
    let log = TestLog::nano();
    rename_category(&log, "vehicle.car", "car\u{1b}[2J\u{9b}31m\nerror: fake");
    assert_clean(&assert_refused(&label(&log), &["category.json", "\\u{1b}[2J"]));
    let root = log.root();
    let line = ["inspect", "--format", "nuscenes", "--input", text(&root), "--unknown-as", "car"];
    let told = occlabel(&line).exits(0);
    assert!(told.stdout.contains("\\u{1b}[2J"));
    assert_clean(&told);
}

#[test]
fn fault_36_a_hostile_keyframe_token_is_refused_and_escaped() {
    let log = TestLog::nano();
    let (token, hostile) = (log.keyframes()[1].clone(), "../../\u{1b}[31m");
    for table in ["sample", "sample_data", "sample_annotation"] {
        log.edit(table, |rows| {
            for row in rows.iter_mut() {
                for key in ["token", "sample_token"] {
                    if row[key] == token.as_str() {
                        row[key] = json!(hostile);
                    }
                }
            }
        });
    }
    assert_clean(&assert_refused(&label(&log), &["A-Z, a-z"]));
}

#[test]
fn fault_36_a_scene_name_too_long_for_a_folder_costs_that_scene_only() {
    let log = TestLog::simulated(&crate::support::nano_spec().with_scenes(2));
    log.edit("scene", |rows| rows[0]["name"] = json!("n".repeat(300)));
    let scene = text_of(&log.rows("scene")[1]["name"]);
    label_into(&log, "skip").with(&SKIP).run().exits(3).tells(&["name"]);
    assert!(log.beside("skip").join("gts").join(scene).is_dir());
}

fn text_of(value: &serde_json::Value) -> String {
    value.as_str().expect("text").to_owned()
}
