//! `convert` and `describe` through the program.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::labelled::labelled;
use crate::support::{Ended, TestLog, files_under, manifest, occlabel, text, tree_hash};

fn convert(from: &Path, to: &str, output: &Path, more: &[&str]) -> Ended {
    let line = ["convert", text(from), "--to", to, "--output", text(output)];
    occlabel(&[&line[..], more].concat())
}

/// A labelled log, and its labels in another dialect.
fn converted(to: &str, more: &[&str]) -> (TestLog, PathBuf, Ended) {
    let (log, label) = labelled(&["--evidence"]);
    let output = log.beside(to);
    let ended = convert(&label.output, to, &output, more).exits(0);
    (log, output, ended)
}

fn same(one: &Path, other: &Path) -> i32 {
    let compared = occlabel(&["compare", text(one), text(other)]);
    compared.code.expect("an exit code")
}

#[test]
fn there_and_back_is_the_same_labels() {
    let (log, label) = labelled(&[]);
    let [there, back, again] = ["there", "back", "again"].map(|name| log.beside(name));
    convert(&label.output, "occ3d-nuscenes", &there, &[]).exits(0);
    assert_eq!(same(&label.output, &there), 0);
    convert(&there, "surroundocc", &back, &[]).exits(0);
    convert(&back, "openoccupancy", &again, &[]).exits(0);
    assert_eq!(same(&back, &again), 0);
    assert_eq!(manifest(&there)["scenes"], manifest(&label.output)["scenes"]);
}

#[test]
fn what_is_lost_is_printed_and_stands_in_the_manifest() {
    let (_log, output, ended) = converted("occ3d-nuscenes-submission", &[]);
    let told = manifest(&output);
    let notes: Vec<&str> =
        told["notes"].as_array().expect("notes").iter().filter_map(Value::as_str).collect();
    assert!(notes.iter().all(|note| ended.stdout.contains(note)), "{notes:?}\n{}", ended.stdout);
    let begins = |start: &str| notes.iter().any(|note| note.starts_with(start));
    for start in
        ["mask_camera: ", "mask_lidar: ", "instances: ", "flow: ", "unobserved: ", "grid: "]
    {
        assert!(begins(start), "{start}{notes:?}");
    }
    assert_eq!(manifest(&output)["dialect"], "occ3d-nuscenes-submission");
    assert_eq!(files_under(&output).len(), 3 + 2);
}

#[test]
fn the_same_command_writes_the_same_files_and_another_is_refused() {
    let (log, output, _) = converted("surroundocc", &["--map", "car=truck"]);
    let source = log.beside("out");
    let before = tree_hash(&output);
    convert(&source, "surroundocc", &output, &["--map", "car=truck", "--jobs", "1"]).exits(0);
    assert_eq!(tree_hash(&output), before);
    let refused = convert(&source, "surroundocc", &output, &[]);
    refused.exits(2).tells(&["an empty folder"]);
    assert_eq!(tree_hash(&output), before);
}

#[test]
fn wrong_names_are_usage() {
    let (log, label) = labelled(&[]);
    let output = log.beside("converted");
    let tree = &label.output;
    convert(tree, "occ3d", &output, &[]).exits(2).tells(&["one of occ3d-nuscenes"]);
    convert(tree, "uniocc", &output, &["--map", "lorry=vehicle"]).exits(2).tells(&["`lorry`"]);
    convert(tree, "uniocc", &output, &["--scenes", "elsewhere"]).exits(2).tells(&["`elsewhere`"]);
    assert!(!output.exists());
}

#[test]
fn describe_tells_a_tree_and_a_file_and_strict_fails_on_suspicion() {
    let (_log, output, _) = converted("openocc-v2", &[]);
    let told = occlabel(&["describe", text(&output), "--json"]).exits(0);
    let told: Value = serde_json::from_str(&told.stdout).expect("JSON");
    assert_eq!(told["dialects"], serde_json::json!(["openocc-v2"]));
    assert_eq!(told["contents"]["keyframes"], 3);
    assert_eq!(told["contents"]["grid"]["shape"], serde_json::json!([40, 40, 8]));

    let names: Vec<String> = files_under(&output).into_keys().collect();
    let name = names.iter().find(|name| name.ends_with("labels.npz")).expect("a file");
    let file = output.join(name);
    occlabel(&["describe", text(&file), "--strict"]).exits(0);
    occlabel(&["describe", text(&file), "--dialect", "uniocc"]).exits(1);
    fs::write(&file, b"PK torn").expect("a file");
    occlabel(&["describe", text(&file)]).exits(1);
}
