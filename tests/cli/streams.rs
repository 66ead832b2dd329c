//! What goes to which stream, and in which form.

use serde_json::json;

use crate::support::{Label, SCENE, TestLog, nano_spec};

#[test]
fn results_go_to_stdout_and_all_else_to_stderr() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let ended = Label::new(&log.root(), &log.beside("out")).small().run().exits(0);
    assert!(ended.stdout.contains("3 keyframes") && !ended.stdout.contains("warning"));
    ended.tells(&["warning", "expected points, found none"]).tells_nothing_of("3 keyframes");
}

#[test]
fn a_total_is_told_of_several_scenes_only() {
    let log = TestLog::nano();
    let one = Label::new(&log.root(), &log.beside("out")).small().run().exits(0).stdout;
    assert!(one.lines().count() == 1 && one.starts_with(SCENE), "{one}");
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let two = Label::new(&log.root(), &log.beside("out")).small().run().exits(0).stdout;
    assert!(two.lines().count() == 3 && two.contains("\n2 scenes: "), "{two}");
}

#[test]
fn quiet_leaves_results_and_errors() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let label = Label::new(&log.root(), &log.beside("out")).small().with(&["--quiet"]);
    let ended = label.run().exits(0);
    assert!(ended.stderr.is_empty() && ended.stdout.contains("3 keyframes"), "{}", ended.stderr);
    label.with(&["--set", "states.occupied_min_hits=2"]).run().exits(2).tells(&["error"]);
}

#[test]
fn messages_can_be_json_with_where_expected_and_found() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let label = Label::new(&log.root(), &log.beside("out")).small();
    let label = label.with(&["--log-format", "json", "--progress", "none"]);
    let warnings = label.run().exits(0).json_lines();
    assert_eq!(warnings.len(), 1);
    assert_eq!((&warnings[0]["level"], &warnings[0]["scene"]), (&json!("warning"), &json!(SCENE)));
    assert_eq!(warnings[0]["place"], log.other_files()[0].as_str());
    assert_eq!(
        (&warnings[0]["expected"], &warnings[0]["found"]),
        (&json!("points"), &json!("none"))
    );

    log.truncate(&log.other_files()[1], 3);
    let errors = label.with(&["--resume", "never"]).run().exits(1).json_lines();
    let error = errors.last().expect("an error");
    assert_eq!((&error["level"], &error["place"]), (&json!("error"), &json!(log.other_files()[1])));
}
