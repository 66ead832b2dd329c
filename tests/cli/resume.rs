//! An output that is not new.

use std::fs;
use std::path::PathBuf;

use serde_json::json;

use crate::labelled::{labelled, labels_path, times};
use crate::support::{Label, files_under, tree_hash};

#[test]
fn the_same_command_again_keeps_everything() {
    let (_log, label) = labelled(&["--evidence"]);
    let (hash, before) = (tree_hash(&label.output), times(&label.output.join("gts")));
    label.run().exits(0);
    assert_eq!(times(&label.output.join("gts")), before);
    assert_eq!(tree_hash(&label.output), hash);
}

#[test]
fn a_file_that_went_away_is_made_again() {
    let (log, label) = labelled(&[]);
    let hash = tree_hash(&label.output);
    fs::remove_file(label.output.join(labels_path(&log.keyframes()[1]))).expect("removed");
    label.run().exits(0);
    assert_eq!(tree_hash(&label.output), hash);
}

#[test]
fn fault_40_another_configuration_into_the_same_output_exits_with_2_and_names_the_key() {
    let (log, label) = labelled(&[]);
    let before = files_under(&label.output);
    let other = label.clone().with(&["--set", "states.occupied_min_hits=2"]);
    other.run().exits(2).tells(&["states.occupied_min_hits", "1 before, 2 now"]);
    log.edit("sensor", |rows| rows[0]["comment"] = json!("changed"));
    label.run().exits(2).tells(&["inputs_hash"]);
    assert!(files_under(&label.output) == before, "something was written");
}

#[test]
fn fault_40_resume_never_starts_anew_and_leaves_foreign_files_alone() {
    let (log, label) = labelled(&["--evidence"]);
    let folder = PathBuf::from(labels_path(&log.keyframes()[0])).with_file_name("");
    let foreign =
        ["notes.txt".into(), folder.join("notes.txt"), PathBuf::from("gts/other/labels.npz")];
    for name in &foreign {
        let path = label.output.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, "mine").expect("written");
    }
    let other = ["--set", "states.occupied_min_hits=2"];
    let anew = Label::new(&log.root(), &label.output).small().with(&other);
    anew.with(&["--resume", "never"]).run().exits(0);
    let fresh = Label::new(&log.root(), &log.beside("fresh")).small().with(&other);
    fresh.run().exits(0);
    for name in &foreign {
        assert_eq!(fs::read(label.output.join(name)).expect("still there"), b"mine");
        fs::remove_file(label.output.join(name)).expect("removed");
    }
    assert_eq!(tree_hash(&label.output), tree_hash(&fresh.output));
}

#[test]
fn fault_40_resume_always_keeps_what_is_finished() {
    let (_log, label) = labelled(&[]);
    let before = times(&label.output.join("gts"));
    let other = label.clone().with(&["--set", "states.occupied_min_hits=2", "--resume", "always"]);
    other.run().exits(0);
    assert_eq!(times(&label.output.join("gts")), before);
}
