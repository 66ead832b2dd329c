//! How the program ends on a log, and what it tells.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::support::{
    Arrays, Ended, Label, SCENE, TestLog, files_under, gts_files, leftovers, manifest, read_arrays,
    report,
};

/// Leaves out what cannot be used.
pub(crate) const SKIP: [&str; 2] = ["--on-error", "skip"];

/// The line for a log in the small grid, with evidence.
pub(crate) fn label(log: &TestLog) -> Label {
    label_into(log, "out")
}

pub(crate) fn label_into(log: &TestLog, output: &str) -> Label {
    Label::new(&log.root(), &log.beside(output)).small().with(&["--evidence"])
}

/// What the untouched log gives.
pub(crate) fn untouched(args: &[&str]) -> (TestLog, Label) {
    let log = TestLog::nano();
    let label = label(&log).with(args);
    label.run().exits(0);
    (log, label)
}

/// Asserts that the log is refused with a message of these parts, and that nothing was written.
#[track_caller]
pub(crate) fn assert_refused(label: &Label, parts: &[&str]) -> Ended {
    let ended = label.run().exits(1).tells(parts).tells(&["expected", "found"]);
    assert_nothing_written(label);
    ended
}

/// Asserts that there is no array, no part of one, and no manifest.
#[track_caller]
pub(crate) fn assert_nothing_written(label: &Label) {
    let files = files_under(&label.output);
    let is_result = |name: &&String| name.starts_with("gts/") || name.starts_with("manifest");
    assert_eq!(files.keys().find(is_result), None);
}

/// Asserts that the log is labelled under `--on-error skip`, but for what the report lists by this
/// rule, and that these keyframes are there, whole, and no others.
#[track_caller]
pub(crate) fn assert_skipped(label: &Label, rule: &str, keyframes: &[String]) -> Ended {
    let label = label.clone().with(&SKIP);
    let ended = label.run().exits(3);
    assert!(!losses(&label.output, rule).is_empty(), "{}", report(&label.output));
    assert_keyframes(&label.output, keyframes);
    assert_eq!(leftovers(&label.output), [""; 0]);
    ended
}

/// Asserts that these keyframes are there, in folders of their own, and no others.
#[track_caller]
pub(crate) fn assert_keyframes(output: &Path, keyframes: &[String]) {
    let mut expected = keyframes.to_vec();
    expected.sort();
    let listed = manifest(output)["scenes"][SCENE]["keyframes"].clone();
    assert_eq!(listed, json!(keyframes));
    let folders = fs::read_dir(output.join("gts").join(SCENE)).into_iter().flatten();
    let names = folders.map(|entry| entry.expect("an entry").file_name());
    let mut found: Vec<String> = names.map(|name| name.into_string().expect("UTF-8")).collect();
    found.sort();
    assert_eq!(found, expected);
    assert_eq!(gts_files(output).len(), 2 * keyframes.len());
}

/// What the report lists as lost by a rule.
pub(crate) fn losses(output: &Path, rule: &str) -> Vec<Value> {
    listed(output, "skipped_or_degraded", rule)
}

/// What the report warns of by a rule.
pub(crate) fn warnings(output: &Path, rule: &str) -> Vec<Value> {
    listed(output, "warnings", rule)
}

fn listed(output: &Path, list: &str, rule: &str) -> Vec<Value> {
    let report = report(output);
    let list = report[list].as_array().expect("a list");
    list.iter().filter(|fault| fault["rule"] == rule).cloned().collect()
}

/// How many points were dropped for a reason.
pub(crate) fn dropped(output: &Path, reason: &str) -> u64 {
    report(output)["total"]["dropped"][reason].as_u64().expect("a count")
}

/// The arrays of the keyframes, in the order of time.
pub(crate) fn arrays(log: &TestLog, label: &Label) -> Vec<Arrays> {
    let keyframes = log.keyframes();
    keyframes.iter().map(|token| read_arrays(&label.output, SCENE, token)).collect()
}

/// All keyframes but the one at a place.
pub(crate) fn keyframes_without(log: &TestLog, at: usize) -> Vec<String> {
    let mut keyframes = log.keyframes();
    keyframes.remove(at);
    keyframes
}

pub(crate) fn field(row: &Value, name: &str) -> String {
    row[name].as_str().expect("a string").to_owned()
}

pub(crate) fn rename_category(log: &TestLog, from: &str, to: &str) {
    log.edit("category", |rows| {
        let row = rows.iter_mut().find(|row| row["name"] == from);
        row.expect("a category")["name"] = json!(to);
    });
}
