//! Every operation on a file fails once, in every way that it can.

use std::fs;
use std::path::PathBuf;

use crate::failing::{MOST, fail};
use crate::line::{Line, OUT, log_of};
use crate::support::{SMALL, TestLog, copy, files_under, occlabel, text};

/// A tree beside the log that a line left.
fn kept(log: &TestLog, line: &Line, name: &str) -> PathBuf {
    let place = log.beside(name);
    line.prepare(&place);
    assert_eq!(line.run(&place, None).code, Some(line.code));
    place
}

#[test]
fn fault_38_39_of_label() {
    let log = log_of(1);
    let failed = fail(&Line::label(&log, &["--jobs", "1"]), &log, 13);
    assert!(failed >= 50, "{failed} failures");
}

#[test]
fn fault_38_39_of_several_sets_at_once() {
    let log = log_of(1);
    let sets = ["--evidence", "--also", "1.6,occ3d-nuscenes"];
    let failed = fail(&Line::label(&log, &sets), &log, 41);
    assert!(failed >= 15, "{failed} failures");
}

/// The tree of a run that was killed with one keyframe finished.
fn half(log: &TestLog, line: &Line) -> PathBuf {
    let place = log.beside("half");
    for at in (0..MOST).step_by(3) {
        line.prepare(&place);
        line.run(&place, Some(&format!("{at}:kill")));
        let journal = fs::read_to_string(place.join("journal.jsonl")).unwrap_or_default();
        if journal.lines().count() == 1 {
            return place;
        }
    }
    panic!("no run with one keyframe finished");
}

#[test]
fn fault_38_39_of_label_that_goes_on() {
    let log = log_of(1);
    let half = half(&log, &Line::label(&log, &["--jobs", "1"]));
    let failed = fail(&Line::label_over(&log, &["--jobs", "1"], Some(half)), &log, 23);
    assert!(failed >= 25, "{failed} failures");
}

#[test]
fn fault_38_39_of_verify_and_of_label_that_redoes() {
    let log = log_of(1);
    let whole = kept(&log, &Line::label(&log, &[]), "whole");
    let before = log.beside("before");
    copy(&whole, &before.join("tree"));
    let broken = files_under(&before).into_keys().find(|path| path.ends_with(".npz"));
    let broken = before.join(broken.expect("labels"));
    let mut bytes = fs::read(&broken).expect("labels");
    bytes[40] ^= 1;
    fs::write(&broken, bytes).expect("written");
    let (tree, list) = (format!("{OUT}/tree"), format!("{OUT}/redo.txt"));
    let verify =
        Line::new(&log, &["verify", &tree, "--redo-list", &list, "--jobs", "1"], Some(before));
    assert_eq!((verify.code, verify.expected.contains_key("redo.txt")), (1, true));
    let failed = fail(&verify, &log, 7);
    assert!(failed >= 10, "{failed} failures");

    let root = log.root();
    let listed = kept(&log, &verify, "listed");
    let line = ["label", "--format", "nuscenes", "--input", text(&root), "--output", &tree];
    let redo = ["--redo", &list, "--jobs", "1"];
    let redo = Line::new(&log, &[&line[..], &SMALL, &redo].concat(), Some(listed));
    let redone = redo.expected.iter().filter_map(|(path, bytes)| {
        Some((path.strip_prefix("tree/gts/")?.to_owned(), bytes.clone()))
    });
    assert!(redone.eq(files_under(&whole.join("gts"))), "redone is not whole");
    let failed = fail(&redo, &log, 29);
    assert!(failed >= 20, "{failed} failures");
}

#[test]
fn fault_38_39_of_convert() {
    let log = log_of(1);
    let labels = kept(&log, &Line::label(&log, &[]), "labels");
    let args = ["convert", text(&labels), "--to", "occ3d-nuscenes", "--output", OUT];
    let failed = fail(&Line::new(&log, &args, None), &log, 13);
    assert!(failed >= 25, "{failed} failures");
}

#[test]
fn fault_38_39_of_merge_manifests() {
    let log = log_of(2);
    let shards = log.beside("shards");
    let root = log.root();
    for shard in ["0/2", "1/2"] {
        let line = ["label", "--format", "nuscenes", "--input", text(&root), "--shard", shard];
        occlabel(&[&line[..], &["--output", text(&shards)], &SMALL].concat()).exits(0);
    }
    let whole = Line::label(&log, &[]).expected;
    let merge = Line::new(&log, &["merge-manifests", OUT], Some(shards));
    assert!(
        merge.expected.keys().eq(whole.keys())
            && merge.expected["manifest.json"] == whole["manifest.json"]
    );
    let failed = fail(&merge, &log, 5);
    assert!(failed >= 20, "{failed} failures");
}

#[test]
fn fault_38_39_of_a_page_and_of_a_report() {
    let log = log_of(1);
    let labels = kept(&log, &Line::label(&log, &[]), "labels");
    let (empty, page) = (log.beside("empty"), format!("{OUT}/page.html"));
    fs::create_dir(&empty).expect("a folder");
    for command in ["view", "report"] {
        let args = [command, text(&labels), "--output", &page];
        let line = Line::new(&log, &args, Some(empty.clone()));
        assert_eq!((line.code, line.expected.len()), (0, 1), "{command}");
        let failed = fail(&line, &log, 11);
        assert!(failed >= 8, "{failed} failures of {command}");
    }
}
