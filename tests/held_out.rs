//! `quality --held-out` on the committed log: 9 sweeps, of which every fifth is one, a key sweep.

mod support;

use serde_json::Value;
use support::{Ended, TestLog, occlabel, text};

/// The sweep that is held out.
const HELD_OUT: &str = "samples/LIDAR_TOP/sim-0001__LIDAR_TOP__1600000000500000.pcd.bin";

fn quality(log: &TestLog, args: &[&str]) -> Ended {
    let root = log.root();
    let line = ["quality", "--format", "nuscenes", "--input", text(&root)];
    occlabel(&[&line, args].concat())
}

fn figures(log: &TestLog) -> Value {
    let ended = quality(log, &["--held-out", "5", "--json"]).exits(0);
    serde_json::from_str(&ended.stdout).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

#[test]
fn the_table_shows_labels_beside_their_floor() {
    let ended = quality(&TestLog::nano(), &["--held-out", "5"]).exits(0);
    let row = |words: [&str; 2]| {
        let has = |line: &&str| words.iter().all(|word| line.contains(word));
        ended.stdout.lines().find(has).unwrap_or_else(|| panic!("{words:?}")).to_owned()
    };
    assert!(row(["hit recall", "ground"]).contains("100.000 %"), "of the floor");
    assert_eq!(row(["depth error, mean", "ground"]).matches(" m ").count(), 2);
    ended.tells(&["1 sweeps held out", "1 keyframes asked"]);
}

#[test]
fn figures_come_by_scene_and_in_total() {
    let found = figures(&TestLog::nano());
    let total = &found["total"];
    assert_eq!(found["held_out"], 5);
    assert_eq!(found["scenes"]["scene-0001"], *total, "there is one scene");
    assert!(number(&total["labels"]["returns"]) > 500.0);
    let depth = |side: &str| number(&total[side]["ground"]["depth_mean_m"]);
    assert!((depth("labels") - depth("floor")).abs() < 0.1, "the street is flat");
    assert!(number(&total["labels"]["ground"]["hit_recall"]) > 0.75);
}

#[test]
fn labels_that_are_wrong_are_told() {
    let log = TestLog::nano();
    log.edit_points(HELD_OUT, |points| points.iter_mut().for_each(|point| point[2] += 1.2));
    let found = figures(&log);
    let ground = &found["total"]["labels"]["ground"];
    assert!(number(&ground["hit_recall"]) < 0.1, "{ground}");
    assert!(number(&ground["returns"]) > 300.0, "their own labels say ground");
}

#[test]
fn threads_do_not_show() {
    let log = TestLog::nano();
    let run = |jobs: &str| quality(&log, &["--held-out", "3", "--json", "--jobs", jobs]).exits(0);
    assert_eq!(run("1").stdout, run("3").stdout);
}

#[test]
fn what_cannot_be_asked_exits_with_2() {
    let log = TestLog::nano();
    for args in [&["--held-out", "1"][..], &[], &["--held-out", "5", "--range-noise-m", "-1"]] {
        quality(&log, args).exits(2);
    }
    occlabel(&["quality", "--held-out", "5"]).exits(2);
    quality(&log, &["--held-out", "10"]).exits(2).tells(&["at least 10 sweeps", "found none"]);
    let drop = ["--held-out", "5", "--set", "relabel.unknown_class=nonsense"];
    quality(&log, &drop).exits(2).tells(&["nonsense"]);
}

#[test]
fn a_sweep_that_is_not_there_exits_with_1() {
    let log = TestLog::nano();
    std::fs::remove_file(log.file(HELD_OUT)).expect("removed");
    quality(&log, &["--held-out", "5"]).exits(1).tells(&[HELD_OUT, "found none"]);
}
