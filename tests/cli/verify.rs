//! A label tree against its manifest.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::labelled::{labelled, labels_path};
use crate::support::{Ended, SCENE, TestLog, files_under, occlabel, text, tree_hash};

fn verify(tree: &Path, more: &[&str]) -> Ended {
    occlabel(&[&["verify", text(tree)], more].concat())
}

/// The object that `--json` prints.
fn verdict(tree: &Path) -> Value {
    serde_json::from_str(&verify(tree, &["--json"]).stdout).expect("one JSON object")
}

/// The rules of what is wrong, in the order told.
fn rules(verdict: &Value) -> Vec<&str> {
    let defects = verdict["defects"].as_array().expect("a list").iter();
    defects.map(|defect| defect["rule"].as_str().expect("a rule")).collect()
}

#[test]
fn a_finished_tree_is_as_its_manifest_says() {
    for more in [&["--evidence"][..], &["--also", "1.6,openocc-v2"], &["--dialect", "surroundocc"]]
    {
        let (_log, label) = labelled(more);
        let before = files_under(&label.output);
        let told = verify(&label.output, &[]).exits(0).stdout;
        assert!(
            told.contains("3 keyframes") && told.contains("all as the manifest says"),
            "{told}"
        );
        assert!(files_under(&label.output) == before, "something was written");
        assert_eq!(rules(&verdict(&label.output)), [""; 0]);
    }
}

#[test]
fn what_is_changed_missing_or_extra_is_told_by_file_and_keyframe() {
    let (log, label) = labelled(&["--evidence"]);
    let tokens = log.keyframes();
    let place = |token: &str| label.output.join(labels_path(token));
    let mut bytes = fs::read(place(&tokens[0])).expect("labels");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(place(&tokens[0]), bytes).expect("written");
    fs::remove_file(place(&tokens[2])).expect("removed");
    fs::write(label.output.join("gts/notes.txt"), "mine").expect("written");
    verify(&label.output, &[]).exits(1);
    let verdict = verdict(&label.output);
    let mut found = rules(&verdict);
    found.sort_unstable();
    assert_eq!(found, ["file-changed", "file-extra", "file-missing"]);
    let mut redo = [0, 2].map(|i| format!("{SCENE}/{}", tokens[i]));
    redo.sort();
    assert_eq!(verdict["redo"], json!(redo));
}

#[test]
fn a_manifest_that_contradicts_itself_is_told() {
    let (_log, label) = labelled(&[]);
    let path = label.output.join("manifest.json");
    let sound: Value = serde_json::from_slice(&fs::read(&path).expect("a manifest")).expect("JSON");
    let breaks: [fn(&mut Value); 3] = [
        |manifest| manifest["inputs_hash"] = json!("0".repeat(64)),
        |manifest| manifest["config_hash"] = json!("0".repeat(64)),
        |manifest| {
            let file = manifest["files"][0].clone();
            manifest["files"].as_array_mut().expect("files").insert(0, file);
        },
    ];
    for spoil in breaks {
        let mut manifest = sound.clone();
        spoil(&mut manifest);
        fs::write(&path, manifest.to_string()).expect("written");
        let told = verify(&label.output, &[]).exits(1).stdout;
        assert!(told.contains("manifest.json"), "{told}");
    }
}

#[test]
fn the_list_of_keyframes_to_redo_makes_the_tree_whole() {
    let (log, label) = labelled(&["--evidence"]);
    let (hash, list) = (tree_hash(&label.output), log.beside("redo.txt"));
    let place = label.output.join(labels_path(&log.keyframes()[1]));
    let mut bytes = fs::read(&place).expect("labels");
    bytes[0] ^= 0x80;
    fs::write(&place, bytes).expect("written");
    label.run().exits(0);
    assert_ne!(tree_hash(&label.output), hash, "lengths alone do not show a flipped bit");
    verify(&label.output, &["--redo-list", text(&list)]).exits(1);
    assert_eq!(fs::read_to_string(&list).expect("a list").lines().count(), 1);
    label.clone().with(&["--redo", text(&list)]).run().exits(0);
    assert_eq!(tree_hash(&label.output), hash);
    verify(&label.output, &["--redo-list", text(&list)]).exits(0);
    assert_eq!(fs::read(&list).expect("a list"), b"");
}

#[test]
fn labels_of_another_shape_are_found_although_the_manifest_has_their_hash() {
    let (_log, label) = labelled(&[]);
    let path = label.output.join("manifest.json");
    let mut manifest: Value =
        serde_json::from_slice(&fs::read(&path).expect("a manifest")).unwrap();
    manifest["grid"]["max_m"] = json!([16.0, 16.0, 4.6]);
    manifest["grid"]["shape"] = json!([40, 40, 7]);
    fs::write(&path, manifest.to_string()).expect("written");
    verify(&label.output, &[]).exits(1);
    let verdict = verdict(&label.output);
    assert_eq!(rules(&verdict).len(), 3, "{verdict}");
    assert_eq!(verdict["redo"].as_array().expect("a list").len(), 3);
}

#[test]
fn a_list_that_names_what_the_command_does_not_label_exits_with_2() {
    let (log, label) = labelled(&[]);
    let list = log.beside("redo.txt");
    fs::write(&list, format!("{SCENE}/nobody\n")).expect("written");
    let before = files_under(&label.output);
    label.clone().with(&["--redo", text(&list)]).run().exits(2).tells(&["nobody", "redo.txt"]);
    label.clone().with(&["--redo", "absent.txt"]).run().exits(2).tells(&["absent.txt"]);
    assert!(files_under(&label.output) == before, "something was written");
}

#[test]
fn a_folder_without_a_manifest_exits_with_2() {
    let log = TestLog::nano();
    verify(&log.root(), &[]).exits(2).tells(&["manifest.json", "interrupted"]);
}
