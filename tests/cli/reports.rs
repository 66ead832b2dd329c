//! `report.json`, as `docs/report-json.md` describes it, and its counts.

use std::collections::BTreeMap;

use occlabel_core::VoxelState;
use serde_json::{Value, json};

use crate::support::{
    Arrays, Documented, Label, Point, SCENE, TestLog, manifest, nano_spec, occlabel, read_arrays,
    report, text,
};

/// Two points without numbers, one at the lidar, three out of range, one that nothing is near to.
const DRAWN: [Point; 7] = [
    [f32::NAN, 0.0, 0.0, 0.0, 0.0],
    [1.0, f32::INFINITY, 0.0, 0.0, 0.0],
    [0.0; 5],
    [9000.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 9000.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 9000.0, 0.0, 0.0],
    [0.0, 0.0, 60.0, 0.0, 0.0],
];

/// A log whose sweeps between keyframes hold the drawn points alone; how many such sweeps.
fn drawn_log() -> (TestLog, u64) {
    let log = TestLog::nano();
    let files = log.other_files();
    files.iter().for_each(|file| log.edit_points(file, |points| *points = DRAWN.to_vec()));
    (log, files.len() as u64)
}

fn sum(counts: &Value) -> u64 {
    counts.as_object().expect("counts").values().filter_map(Value::as_u64).sum()
}

fn describe(report: &Value, of_run: &Documented) {
    let counts = Documented::in_page("report-json.md", "Counts");
    let alone = Documented::in_page("report-json.md", "Of a scene alone");
    let finding = Documented::in_page("report-json.md", "A finding");
    of_run.describes(report);
    counts.describes(&report["total"]);
    let of_scene = counts.and(&alone);
    report["scenes"].as_object().expect("scenes").values().for_each(|s| of_scene.describes(s));
    for list in ["warnings", "skipped_or_degraded"] {
        report[list].as_array().expect("findings").iter().for_each(|f| finding.describes(f));
    }
}

#[test]
fn every_field_is_described_and_every_described_field_is_there() {
    let (log, _) = drawn_log();
    log.empty(&log.other_files()[0]);
    log.truncate(&log.other_files()[1], 3);
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.with(&["--on-error", "skip"]).run().exits(3);
    let report = report(&log.beside("out"));
    describe(&report, &Documented::in_page("report-json.md", "The run"));
    let scene = &report["scenes"][SCENE];
    assert_eq!(scene["skipped_or_degraded_by_rule"], json!({ "sweep-length": 1 }));
    assert_eq!(
        sum(&scene["warnings_by_rule"]),
        report["warnings"].as_array().map_or(0, Vec::len) as u64
    );
    assert_eq!((&scene["sweeps"]["read"], &scene["sweeps"]["left_out"]), (&json!(8), &json!(1)));
}

#[test]
fn points_are_counted_exactly_by_what_became_of_them() {
    let (log, drawn) = drawn_log();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.with(&["--set", "aggregate.ego_box_m=none"]).run().exits(0);
    let report = report(&log.beside("out"));
    let (total, dropped) = (&report["total"], &report["total"]["dropped"]);
    let of_keys: usize = log.key_files().iter().map(|file| log.points(file).len()).sum();
    assert_eq!(total["points_read"], of_keys as u64 + drawn * DRAWN.len() as u64);
    let many = |of_each: u64| json!(of_each * drawn);
    assert_eq!((&dropped["not_finite"], &dropped["at_origin"]), (&many(2), &many(1)));
    assert_eq!((&dropped["far"], &total["class_from"]["unknown"]), (&many(3), &many(1)));
    let points = total["points_read"].as_u64().expect("points") - sum(dropped);
    assert_eq!((total["points"].as_u64(), sum(&total["class_from"])), (Some(points), points));
    assert!(
        total["class_from"]["boxes"].as_u64() > Some(0) && total["class_from"]["neighbours"] == 0
    );
    assert_eq!(total["sweeps"]["read"], log.sweeps().len());
    let size = |row: &Value| log.file(row["filename"].as_str().expect("a name")).metadata();
    let rows = [log.sweeps(), log.rows("lidarseg")].concat();
    let bytes: u64 = rows.iter().map(|row| size(row).expect("a file").len()).sum();
    assert_eq!(total["sweeps"]["file_bytes"], bytes);
}

#[test]
fn voxels_are_counted_by_state_and_class_over_interrupted_runs() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small().with(&["--evidence"]);
    label.clone().with(&["--keyframes", &log.keyframes()[1]]).run().exits(0);
    label.run().exits(0);
    let (report, names) = (report(&label.output), manifest(&label.output)["classes"].clone());
    let (mut by_class, mut states) = (BTreeMap::<String, u64>::new(), [0; 3]);
    for token in log.keyframes() {
        let Arrays { labels, evidence } = read_arrays(&label.output, SCENE, &token);
        for (class, state) in labels.semantics.values().iter().zip(evidence.state.values()) {
            states[usize::from(*state)] += 1;
            if *state == VoxelState::Occupied as u8 {
                let name = names[usize::from(*class)]["name"].as_str().expect("a name");
                *by_class.entry(name.to_owned()).or_default() += 1;
            }
        }
    }
    let voxels = &report["total"]["voxels"];
    assert_eq!(voxels["by_class"], json!(by_class));
    let counted = |state: VoxelState| json!(states[state as usize]);
    assert_eq!(voxels["occupied"], counted(VoxelState::Occupied));
    assert_eq!(voxels["free"], counted(VoxelState::Free));
    assert_eq!(voxels["unobserved"], counted(VoxelState::Unobserved));
    assert_eq!((&report["total"]["keyframes"], &report["total"]["kept"]), (&json!(3), &json!(1)));
}

#[test]
fn shards_make_one_report_with_sums_and_the_highest_peaks() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let label = Label::new(&log.root(), &log.beside("out")).small();
    ["0/2", "1/2"]
        .iter()
        .for_each(|shard| drop(label.clone().with(&["--shard", shard]).run().exits(0)));
    let part = |name: &str| -> Value {
        serde_json::from_slice(&std::fs::read(label.output.join(name)).expect("a report"))
            .expect("JSON")
    };
    let parts = ["report.0-of-2.json", "report.1-of-2.json"].map(part);
    occlabel(&["merge-manifests", text(&label.output)]).exits(0);
    let merged = report(&label.output);
    let run = Documented::in_page("report-json.md", "The run").without(&[
        "seconds",
        "cpu_seconds",
        "peak_memory_bytes",
        "threads",
        "inputs_mark",
        "host.os",
        "host.arch",
    ]);
    describe(&merged, &run.and(&Documented::in_page("report-json.md", "Of shards")));
    let points = |report: &Value| report["total"]["points_read"].as_u64().expect("a count");
    assert_eq!(points(&merged), points(&parts[0]) + points(&parts[1]));
    let peak = |report: &Value| report["total"]["peak_memory_bytes_by_stage"]["raycast"].as_u64();
    assert_eq!(peak(&merged), peak(&parts[0]).max(peak(&parts[1])));
}
