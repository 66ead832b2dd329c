//! A bound on memory.

use crate::labelled::labelled;
use crate::support::{Label, SCENE, TestLog, tree_hash};

/// The bytes that one keyframe at a time needs, as the program tells them.
fn bytes_needed(label: &Label) -> String {
    let ended = label.clone().with(&["--memory", "1kB"]).run().exits(1);
    let (_, rest) = ended.stderr.split_once("found ").expect("what was found");
    rest.split(' ').next().expect("a number").to_owned()
}

#[test]
fn too_little_memory_fails_before_any_work_and_says_what_is_needed() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.clone().with(&["--memory", "1kB"]).run().exits(1).tells(&[
        SCENE,
        "1000 bytes",
        "--memory",
    ]);
    let needed: u64 = bytes_needed(&label).parse().expect("a number");
    label.clone().with(&["--memory", &(needed - 1).to_string()]).run().exits(1);
    assert!(!label.output.exists());
}

#[test]
fn one_keyframe_at_a_time_gives_the_same_bytes() {
    let (log, free) = labelled(&["--jobs", "3"]);
    let bound = Label::new(&log.root(), &log.beside("bound")).small().with(&["--jobs", "3"]);
    let bytes = bytes_needed(&bound);
    bound.clone().with(&["--memory", &bytes]).run().exits(0);
    assert_eq!(tree_hash(&bound.output), tree_hash(&free.output));
}

/// The number before some words.
#[cfg(target_os = "linux")]
fn number_before(text: &str, words: &str) -> f64 {
    let (before, _) = text.split_once(words).expect("the words");
    before.rsplit(' ').next().expect("a number").parse().expect("a number")
}

/// Bytes that a run is planned to take, and its largest resident set.
#[cfg(target_os = "linux")]
fn planned_and_taken(label: &Label) -> [f64; 2] {
    let planned = label.clone().with(&["--dry-run"]).run().exits(0).stdout;
    label.run().exits(0);
    let report = std::fs::read(label.output.join("report.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
    let taken = report["peak_memory_bytes"].as_f64().expect("a number");
    [number_before(&planned, " bytes of memory"), taken]
}

/// What a run in a fine grid is planned to take, and takes, more than in a tiny one: bytes a voxel.
#[cfg(target_os = "linux")]
fn bytes_a_voxel(log: &TestLog, flags: &[&str]) -> [f64; 2] {
    let label = |grid: &str| {
        let output = log.beside(&format!("{}-{grid}", flags.concat()));
        let keyframes = log.keyframes()[..2].join(",");
        Label::new(&log.root(), &output).with(&["--keyframes", &keyframes]).with(flags)
    };
    let fine = planned_and_taken(&label("fine").with(&["--set", "grid.voxel_size_m=0.2"]));
    let small = planned_and_taken(&label("small").small());
    [0, 1].map(|at| (fine[at] - small[at]) / 5_120_000.0)
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_takes_no_more_memory_than_it_was_planned_to_take() {
    let log = TestLog::nano();
    for flags in [&["--jobs", "1"][..], &["--jobs", "2", "--evidence"]] {
        let [planned, taken] = bytes_a_voxel(&log, flags);
        assert!(
            (0.3 * planned..planned + 2.0).contains(&taken),
            "{taken} bytes a voxel, {planned} planned, with {flags:?}"
        );
    }
}
