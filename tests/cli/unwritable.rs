//! A keyframe whose file cannot be written, while others are worked on.

use std::fs;

use occlabel_testkit::LogSpec;
use serde_json::Value;

use crate::labelled::labels_path;
use crate::support::{Label, TestLog, gts_files, nano_spec, tree_hash};

/// The paths that a run's journal vouches for.
fn noted(label: &Label) -> Vec<String> {
    let journal = fs::read_to_string(label.output.join("journal.jsonl")).expect("a journal");
    let entry = |line: &str| -> Value { serde_json::from_str(line).expect("a whole line") };
    let path = |entry: Value| entry["files"][0]["path"].as_str().expect("a path").to_owned();
    let mut noted: Vec<_> = journal.lines().map(entry).map(path).collect();
    noted.sort();
    noted
}

#[test]
fn fault_38_a_file_that_cannot_be_written_ends_the_run_and_what_is_noted_stands() {
    let log = TestLog::simulated(&LogSpec { keyframes: 8, ..nano_spec() });
    for jobs in ["1", "3"] {
        let label = Label::new(&log.root(), &log.beside(&format!("out-{jobs}"))).small();
        let label = label.with(&["--jobs", jobs]);
        let taken = label.output.join(labels_path(&log.keyframes()[3]));
        fs::create_dir_all(taken.join("in the way")).expect("a folder");
        label.run().exits(1).tells(&[&labels_path(&log.keyframes()[3]), "bytes"]);
        assert!(!label.output.join("manifest.json").exists());
        let stand = gts_files(&label.output).into_keys().filter(|name| !name.ends_with(".lock"));
        let stand: Vec<_> = stand.map(|name| format!("gts/{name}")).collect();
        assert_eq!(noted(&label), stand);
        assert!((3..8).contains(&stand.len()), "{} keyframes stand", stand.len());

        fs::remove_dir_all(&taken).expect("out of the way");
        label.run().exits(0);
        let undisturbed = Label::new(&log.root(), &log.beside(&format!("new-{jobs}"))).small();
        undisturbed.run().exits(0);
        assert_eq!(tree_hash(&label.output), tree_hash(&undisturbed.output));
    }
}
