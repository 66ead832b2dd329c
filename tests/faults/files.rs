//! Files of points: cut, empty, of other columns, absent (cases 1 to 5).

use std::fs;

use serde_json::json;

use crate::asserts::{
    SKIP, arrays, assert_keyframes, assert_refused, assert_skipped, field, keyframes_without,
    label, label_into, losses, untouched, warnings,
};
use crate::support::{SCENE, TestLog, gts_files};

#[test]
fn fault_01_a_truncated_sweep_is_refused_or_skipped() {
    let log = TestLog::nano();
    let file = &log.other_files()[2];
    log.truncate(file, 7);
    assert_refused(&label(&log), &[file, SCENE, "multiple of 20 bytes", "13 more than"]);
    assert_skipped(&label_into(&log, "skip"), "sweep-length", &log.keyframes())
        .tells(&["warning", file]);
    let loss = &losses(&log.beside("skip"), "sweep-length")[0];
    assert_eq!((&loss["place"], &loss["scene"]), (&json!(file), &json!(SCENE)));
}

#[test]
fn fault_01_a_truncated_key_sweep_takes_its_keyframe_along() {
    let log = TestLog::nano();
    let (file, token) = (&log.key_files()[1], &log.keyframes()[1]);
    log.truncate(file, 7);
    assert_refused(&label(&log), &[file, "multiple of 20 bytes"]);
    let ended = assert_skipped(&label_into(&log, "skip"), "keyframe", &keyframes_without(&log, 1));
    ended.tells(&[file, token]);
    assert_eq!(losses(&log.beside("skip"), "sweep-length").len(), 1);
}

#[test]
fn fault_01_the_repaired_log_labels_as_if_nothing_had_been() {
    let (_log, whole) = untouched(&[]);
    let log = TestLog::nano();
    let bytes = fs::read(log.file(&log.key_files()[1])).expect("a sweep");
    log.truncate(&log.key_files()[1], 7);
    label(&log).with(&SKIP).run().exits(3);
    fs::write(log.file(&log.key_files()[1]), bytes).expect("written");
    label(&log).with(&["--resume", "never"]).run().exits(0);
    assert!(gts_files(&log.beside("out")) == gts_files(&whole.output));
}

#[test]
fn fault_02_an_empty_sweep_is_a_sweep_with_a_warning() {
    let log = TestLog::nano();
    let file = &log.other_files()[0];
    log.empty(file);
    let label = label(&log);
    label.run().exits(0).tells(&["warning", file, "expected points, found none"]);
    assert_eq!(warnings(&label.output, "sweep-empty").len(), 1);
    assert_keyframes(&label.output, &log.keyframes());
}

#[test]
fn fault_02_an_empty_key_sweep_still_has_a_keyframe() {
    let log = TestLog::nano();
    log.empty(&log.key_files()[1]);
    log.edit("lidarseg", |rows| rows.clear());
    let label = label(&log);
    label.run().exits(0).tells(&["warning", &log.key_files()[1]]);
    assert_keyframes(&label.output, &log.keyframes());
    let states = arrays(&log, &label)[1].evidence.state.values().to_vec();
    assert!(states.iter().filter(|state| **state == 2).count() > 100, "other sweeps serve it");
}

/// Makes four columns of a sweep's five: without the ring.
fn drop_ring(log: &TestLog, file: &str) {
    let columns = log.points(file).into_iter().flat_map(|[x, y, z, i, _]| [x, y, z, i]);
    fs::write(log.file(file), columns.flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
        .expect("written");
}

#[test]
fn fault_03_four_columns_are_told_not_guessed() {
    let log = TestLog::nano();
    let file = &log.other_files()[1];
    drop_ring(&log, file);
    assert_refused(&label(&log), &[file, "looks like 4-column KITTI", "--columns 4"]);
    assert_skipped(&label_into(&log, "skip"), "sweep-length", &log.keyframes());
}

#[test]
fn fault_03_four_columns_are_read_when_asked_for() {
    let (_log, five) = untouched(&[]);
    let log = TestLog::nano();
    log.key_files().iter().chain(&log.other_files()).for_each(|file| drop_ring(&log, file));
    let four = label(&log).with(&["--columns", "4"]);
    four.run().exits(0);
    assert!(gts_files(&four.output) == gts_files(&five.output));
}

#[test]
fn fault_04_absent_sweeps_are_all_listed_at_once() {
    let log = TestLog::nano();
    let files = log.other_files();
    files.iter().for_each(|file| log.remove(file));
    let mut ended = assert_refused(&label(&log), &["6 missing", "bytes"]);
    for file in &files {
        ended = ended.tells(&[file, "expected a file"]);
    }
    ended.tells(&["--allow-missing-sweeps"]);
}

#[test]
fn fault_04_absent_sweeps_can_be_allowed() {
    let log = TestLog::nano();
    let files = log.other_files();
    files.iter().for_each(|file| log.remove(file));
    let label = label(&log).with(&["--allow-missing-sweeps"]);
    label.run().exits(3).tells(&["warning", "6 missing"]);
    assert_keyframes(&label.output, &log.keyframes());
    let lost = losses(&label.output, "missing-file");
    let places: Vec<String> = lost.iter().map(|loss| field(loss, "place")).collect();
    assert_eq!(places, files);
}

#[test]
fn fault_05_an_absent_key_sweep_is_not_allowed_only_skipped() {
    let log = TestLog::nano();
    let (file, token) = (&log.key_files()[0], &log.keyframes()[0]);
    log.remove(file);
    assert_refused(&label(&log), &[file, "reference sweep of a keyframe"]);
    let allowed = label_into(&log, "allowed").with(&["--allow-missing-sweeps"]);
    assert_refused(&allowed, &[file, "reference sweep of a keyframe"]);
    let ended = assert_skipped(&label_into(&log, "skip"), "keyframe", &keyframes_without(&log, 0));
    ended.tells(&[file, token]);
}

/// Nobody writes to it: who opened it would wait for ever. The next scene's files are read ahead.
#[cfg(unix)]
#[test]
fn fault_05_a_pipe_in_place_of_a_sweep_is_refused_and_waits_for_nobody() {
    let log = TestLog::simulated(&crate::support::nano_spec().with_scenes(2));
    let file = log.other_files().last().expect("a sweep").clone();
    log.remove(&file);
    let made = std::process::Command::new("mkfifo").arg(log.file(&file)).status();
    assert!(made.expect("mkfifo").success());
    label(&log).run().exits(1).tells(&[&file, "expected a file"]);
}
