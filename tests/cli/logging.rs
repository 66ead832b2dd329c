//! JSON lines on stderr, as `docs/logging.md` describes them.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::interrupted::{long_run, signal, started};
use crate::support::{Documented, Ended, Label, SCENE, TestLog, nano_spec, occlabel};

const JSON: [&str; 2] = ["--log-format", "json"];

/// Asserts that a line is as its event is described; gives the event.
#[track_caller]
fn event(line: &Value) -> String {
    let name = line["event"].as_str().unwrap_or_else(|| panic!("no event: {line}"));
    let every = Documented::in_page("logging.md", "Every line");
    Documented::in_page("logging.md", &format!("`{name}`")).and(&every).describes(line);
    assert_eq!(line["schema"], 1);
    name.to_owned()
}

/// The events of all lines of stderr.
#[track_caller]
fn events(ended: &Ended) -> Vec<String> {
    assert!(ended.stderr.is_empty() || ended.stderr.ends_with('\n'), "half a line");
    ended.json_lines().iter().map(event).collect()
}

fn json_label(log: &TestLog) -> Label {
    Label::new(&log.root(), &log.beside("out")).small().with(&JSON)
}

#[test]
fn a_run_tells_its_progress_from_start_to_end() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let label = json_label(&log).with(&["--jobs", "3"]);
    let ended = label.run().exits(0);
    let scene = ["scene", "keyframe", "keyframe", "keyframe", "scene_done"];
    assert_eq!(events(&ended), [&["start"][..], &scene, &scene, &["end"]].concat());
    let lines = ended.json_lines();
    let done: Vec<_> = lines.iter().filter_map(|line| line["done"].as_u64()).collect();
    assert_eq!(done, [1, 2, 3, 4, 5, 6]);
    let end = lines.last().expect("an end");
    assert_eq!((&end["exit_code"], &end["keyframes"]), (&json!(0), &json!(6)));

    let again = label.run().exits(0);
    assert_eq!(events(&again), ["start", "scene", "scene_done", "scene", "scene_done", "end"]);
    assert_eq!(again.json_lines().last().expect("an end")["keyframes"], 6);
}

#[test]
fn what_was_skipped_and_what_failed_is_told_before_the_end() {
    let log = TestLog::nano();
    log.truncate(&log.other_files()[1], 3);
    let label = json_label(&log);
    let skipped = label.clone().with(&["--on-error", "skip"]).run().exits(3);
    assert!(events(&skipped).contains(&"fault".to_owned()));
    let lines = skipped.json_lines();
    let end = lines.last().expect("an end");
    assert_eq!((&end["outcome"], &end["skipped_or_degraded"]), (&json!("degraded"), &json!(1)));

    let failed = label.with(&["--resume", "never"]).run().exits(1);
    assert_eq!(events(&failed), ["start", "scene", "fault", "end"]);
    let lines = failed.json_lines();
    assert_eq!((&lines[2]["level"], &lines[2]["scene"]), (&json!("error"), &json!(null)));
    assert_eq!((&lines[3]["outcome"], &lines[3]["exit_code"]), (&json!("failed"), &json!(1)));
}

#[test]
fn an_interrupted_run_ends_with_130() {
    let (_log, label) = long_run();
    let label = label.with(&JSON);
    let child = started(&mut label.command(), &label);
    signal(&child, "-INT");
    let ended = Ended::of(child.wait_with_output().expect("an end")).exits(130);
    let events = events(&ended);
    assert_eq!(events[events.len() - 2..], ["note", "end"]);
    assert_eq!(ended.json_lines().last().expect("an end")["outcome"], "interrupted");
}

#[test]
fn formats_of_messages_and_of_progress_are_free_of_each_other() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let run = |flags: &[&str]| {
        let label = Label::new(&log.root(), &log.beside(&flags.concat())).small();
        label.with(flags).run().exits(0)
    };
    let text = run(&["--progress", "json"]);
    let (lines, words): (Vec<_>, Vec<_>) = text.stderr.lines().partition(|l| l.starts_with('{'));
    assert!(words.len() == 1 && words[0].starts_with(&format!("warning: {SCENE}: ")), "{words:?}");
    assert_eq!(lines.len(), 7);
    lines.iter().for_each(|line| drop(event(&serde_json::from_str(line).expect("JSON"))));
    assert_eq!(events(&run(&["--log-format=json", "--progress=plain"])), ["note", "fault"]);
    assert_eq!(events(&run(&["--log-format=json", "--progress=bar"])), ["fault"]);
    assert_eq!(events(&run(&["--log-format=json", "--quiet"])), [""; 0]);
}

#[test]
fn commands_and_command_lines_fail_in_json_too() {
    let lines: [&[&str]; 5] = [
        &["label", "--progress", "loud"],
        &["label", "--format", "nuscenes", "--input", "absent", "--output", "b"],
        &["verify", "absent"],
        &["presets", "ab\u{9b}sent"],
        &["compare", "absent", "absent"],
    ];
    for line in lines {
        let ended = occlabel(&[line, &JSON].concat());
        assert_eq!(events(&ended), ["fault"], "{line:?}");
        assert!(!ended.stderr.contains('\u{9b}') && ended.code != Some(0));
    }
}

#[test]
fn every_described_event_is_told_somewhere() {
    let text = include_str!("../../docs/logging.md");
    let described: BTreeSet<_> =
        text.lines().filter_map(|line| line.strip_prefix("## `")?.strip_suffix('`')).collect();
    let told = ["fault", "note", "start", "scene", "keyframe", "scene_done", "end"];
    assert_eq!(described, told.into(), "the tests above meet these");
}
