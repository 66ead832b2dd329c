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

/// The largest resident set of a run, less that of a run in a tiny grid; and the grid's voxels.
#[cfg(target_os = "linux")]
fn peak_bytes_a_voxel(log: &TestLog, jobs: &str, name: &str) -> f64 {
    let peak = |label: Label| -> f64 {
        label.clone().with(&["--jobs", jobs]).run().exits(0);
        let report = std::fs::read(label.output.join("report.json")).expect("a report");
        let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
        report["peak_memory_bytes"].as_f64().expect("a number")
    };
    let label = |grid: &str| Label::new(&log.root(), &log.beside(&format!("{name}-{grid}")));
    let keyframe = log.keyframes().remove(1);
    let one = |grid| label(grid).with(&["--keyframes", &keyframe]);
    let fine = one("fine").with(&["--set", "grid.voxel_size_m=0.2"]);
    (peak(fine) - peak(one("small").small())) / 5_120_000.0
}

/// As `pipeline/memory.rs` has it.
#[cfg(target_os = "linux")]
#[test]
fn a_voxel_takes_no_more_memory_than_the_plan_takes_it_for() {
    let log = TestLog::nano();
    for jobs in ["1", "2"] {
        let bytes = peak_bytes_a_voxel(&log, jobs, jobs);
        assert!((5.0..=46.0 + 2.0).contains(&bytes), "{bytes} bytes a voxel with {jobs} threads");
    }
}
