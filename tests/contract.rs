//! Corners of the contract that a run must not cut.

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

use serde_json::{Value, json};
use support::{
    Ended, Label, TestLog, files_under, gts_files, manifest, nano_spec, occlabel, program, report,
    text,
};

fn label(log: &TestLog) -> Label {
    Label::new(&log.root(), &log.beside("out")).small()
}

/// cli.md: the manifest is "what one needs to read the arrays", files = every file of the tree.
#[test]
fn a_later_run_of_some_keyframes_keeps_the_others_in_the_manifest() {
    let log = TestLog::nano();
    let label = label(&log);
    label.run().exits(0);
    label.clone().with(&["--keyframes", &log.keyframes()[1]]).run().exits(0);
    assert_eq!(gts_files(&label.output).len(), 3);
    assert_eq!(manifest(&label.output)["files"].as_array().map(Vec::len), Some(3));
}

/// cli.md: exit 3 if a sweep was skipped, "and the report lists it": also when all is kept.
#[test]
fn a_degraded_tree_stays_degraded_when_the_command_runs_again() {
    let log = TestLog::nano();
    log.truncate(&log.other_files()[0], 7);
    let label = label(&log).with(&["--on-error", "skip"]);
    label.run().exits(3);
    let listed = report(&label.output)["skipped_or_degraded"].clone();
    let again = label.run();
    assert_eq!(report(&label.output)["skipped_or_degraded"], listed);
    again.exits(3);
}

/// cli.md: report.json holds the counts.
#[test]
fn the_report_of_a_kept_tree_still_counts_its_voxels() {
    let log = TestLog::nano();
    let label = label(&log);
    label.run().exits(0);
    let voxels = report(&label.output)["total"]["voxels"].clone();
    let again = label.run().exits(0);
    assert!(!again.stdout.contains(" 0 occupied"), "{}", again.stdout);
    assert_eq!(report(&label.output)["total"]["voxels"], voxels);
}

/// cli.md: `--log-format json` gives the same as fields: every line of stderr is JSON.
#[test]
fn json_messages_are_not_mixed_with_plain_progress() {
    let log = TestLog::nano();
    label(&log).with(&["--log-format", "json"]).run().exits(0).json_lines();
}

/// The same for errors of usage.
#[test]
fn errors_of_usage_are_json_too() {
    let ended = occlabel(&["label", "--log-format", "json", "--format", "floppy"]).exits(2);
    assert!(
        ended.stderr.lines().all(|line| serde_json::from_str::<Value>(line).is_ok()),
        "{}",
        ended.stderr
    );
}

/// cli.md: 2 = usage or configuration, found before any sweep is read.
#[test]
fn a_reference_lidar_that_is_not_there_is_a_matter_of_configuration() {
    let log = TestLog::nano();
    let label = label(&log).with(&["--set", "keyframes.reference_lidar=LIDAR_ROOF"]);
    label.run().exits(2).tells(&["LIDAR_ROOF"]);
}

/// cli.md: `--dry-run`: scenes, keyframes, rays, bytes, expected time.
#[test]
fn a_dry_run_tells_the_expected_time() {
    let log = TestLog::nano();
    let told = label(&log).with(&["--dry-run"]).run().exits(0).stdout;
    assert!(told.contains("expected time") && told.contains("CPU-seconds"), "{told}");
}

/// cli.md: `check`: every fault of a log at once, nothing written; the issue: exit 0/1/3, `--json`.
#[test]
fn check_tells_one_object_and_its_exit_code_is_that_of_the_worst_finding() {
    let log = TestLog::nano();
    let root = log.root();
    let line = ["check", "--format", "nuscenes", "--input", text(&root), "--json"];
    let before = files_under(&log.root());
    let json = |told: &str| serde_json::from_str::<Value>(told).expect("one object");
    assert_eq!(json(&occlabel(&line).exits(0).stdout)["errors"], 0);
    assert!(files_under(&log.root()) == before);
    log.empty(&log.other_files()[0]);
    assert_eq!(json(&occlabel(&line).exits(3).stdout)["warnings"], 1);
    log.truncate(&log.other_files()[1], 7);
    let found = json(&occlabel(&line).exits(1).stdout);
    let fields = ["rule", "severity", "scene", "file", "record", "expected", "found"];
    assert!(fields.iter().all(|field| found["findings"][0][field].is_string()), "{found}");
}

/// Help opens with what the program is.
#[test]
fn help_says_what_the_program_does() {
    let help = occlabel(&["--help"]).exits(0).stdout;
    assert!(help.starts_with("Ground truth for 3D semantic occupancy"), "{help}");
}

/// Under `--on-error skip` the rest goes on, the report lists it, exit 3.
#[test]
fn fault_36_a_hostile_scene_name_costs_that_scene_only() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    log.edit("scene", |rows| rows[0]["name"] = json!("../../x"));
    label(&log).with(&["--on-error", "skip"]).run().exits(3);
}

/// The same for the name of a label file.
#[test]
fn fault_36_a_hostile_label_name_costs_that_scene_only() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    log.edit("lidarseg", |rows| rows[0]["filename"] = json!("/etc/passwd"));
    label(&log).with(&["--on-error", "skip"]).run().exits(3);
}

/// The same for a sweep that cannot be looked at (a loop of links, a folder without rights).
#[cfg(unix)]
#[test]
fn fault_37_a_sweep_that_is_a_loop_of_links_is_skipped() {
    let log = TestLog::nano();
    let file = log.other_files()[0].clone();
    log.remove(&file);
    std::os::unix::fs::symlink(log.file(&file), log.file(&file)).expect("a link");
    label(&log).with(&["--on-error", "skip"]).run().exits(3);
}

/// Names are escaped in logs. U+009B begins a control sequence, and JSON leaves it raw.
#[test]
fn fault_36_json_messages_escape_c1_controls() {
    let log = TestLog::nano();
    log.edit("category", |rows| {
        let row = rows.iter_mut().find(|row| row["name"] == "vehicle.car").expect("cars");
        row["name"] = json!("car\u{9b}31m");
    });
    let ended = label(&log).with(&["--log-format", "json"]).run().exits(1);
    assert!(!ended.stderr.contains('\u{9b}'), "{:?}", ended.stderr);
}

/// labels.md 14: an unknown key is an error.
#[test]
fn a_reader_table_that_no_reader_knows_is_refused() {
    let log = TestLog::nano();
    label(&log).with(&["--set", "reader.nonsense.key=1"]).run().exits(2).tells(&["reader"]);
}

/// Output through a symbolic link of a file is refused. The link is removed instead.
#[cfg(unix)]
#[test]
fn fault_37_a_link_in_place_of_the_manifest_is_refused() {
    for name in ["manifest.json", "report.json"] {
        let log = TestLog::nano();
        fs::create_dir_all(log.beside("out")).expect("a folder");
        std::os::unix::fs::symlink(log.beside("victim"), log.beside("out").join(name))
            .expect("a link");
        label(&log).run().exits(1).tells(&[name, "a symbolic link"]);
    }
}

/// An annotation without points is listed in the report.
#[test]
fn fault_25_boxes_without_points_are_listed() {
    let log = TestLog::nano();
    let token = log.rows("sample_annotation")[0]["token"].clone();
    log.edit("sample_annotation", |rows| rows[0]["translation"] = json!([0.0, 0.0, 90.0]));
    let label = label(&log);
    label.run().exits(0);
    let text = report(&label.output).to_string();
    let instance = log.rows("sample_annotation")[0]["instance_token"].clone();
    let names = [token, instance].map(|name| name.as_str().expect("a token").to_owned());
    assert!(names.iter().any(|name| text.contains(name)), "{text}");
}

/// Points that are not finite are counted per sweep.
#[test]
fn fault_06_points_that_are_not_finite_are_counted_per_sweep() {
    let log = TestLog::nano();
    let file = log.other_files()[0].clone();
    log.edit_points(&file, |points| points[0][0] = f32::NAN);
    let label = label(&log);
    label.run().exits(0);
    assert!(report(&label.output).to_string().contains(&file));
}

/// A run that failed before its first keyframe does not stand in the way
/// of the same command once the log is repaired.
#[test]
fn a_failed_run_that_finished_nothing_does_not_stop_the_next() {
    let log = TestLog::nano();
    let file = log.file(&log.other_files()[0]);
    let whole = fs::read(&file).expect("a sweep");
    log.truncate(&log.other_files()[0], 7);
    label(&log).run().exits(1);
    fs::write(&file, whole).expect("written");
    label(&log).run().exits(0);
}

/// Each file below a folder: its bytes, and when it was written.
fn stamped(root: &Path) -> BTreeMap<String, (Vec<u8>, SystemTime)> {
    let stamp = |name: &str| fs::metadata(root.join(name)).and_then(|meta| meta.modified());
    let with_stamp = |(name, bytes): (String, Vec<u8>)| {
        let time = stamp(&name).expect("a time");
        (name, (bytes, time))
    };
    files_under(root).into_iter().map(with_stamp).collect()
}

/// docs/reliability.md: inputs are never written, outputs never leave the output's root.
#[test]
fn nothing_is_written_but_what_a_line_names() {
    let log = TestLog::nano();
    let before = stamped(&log.beside(""));
    let (root, out, elsewhere) = (log.root(), log.beside("out"), log.beside("elsewhere"));
    fs::create_dir(&elsewhere).expect("a folder");
    let input = ["--format", "nuscenes", "--input", text(&root)];
    let lines: [&[&str]; 9] = [
        &["check"],
        &["inspect"],
        &["label", "--output", text(&out), "--dry-run"],
        &["label", "--output", text(&out), "--evidence", "--also", "0.8"],
        &["label", "--output", text(&out), "--evidence", "--also", "0.8", "--resume", "never"],
        &["verify", text(&out)],
        &["compare", text(&out), text(&out)],
        &["view", text(&out), "--output", "../out/page.html"],
        &["report", text(&out), "--output", "../out/report.html"],
    ];
    for line in lines {
        let input = if line.contains(&text(&out)) && line[0] != "label" { &[][..] } else { &input };
        let mut command = program();
        command.args(line).args(input).current_dir(&elsewhere);
        command.env("TMPDIR", &elsewhere).env("HOME", &elsewhere);
        Ended::of(command.output().expect("the program starts")).exits(0);
    }
    let mut after = stamped(&log.beside(""));
    after.retain(|name, _| !name.starts_with("out/"));
    assert!(after == before, "{:?}", after.keys());
}

/// An empty list of scenes is a broken pipeline, not a wish.
#[test]
fn an_empty_list_of_scenes_is_told() {
    let log = TestLog::nano();
    fs::write(log.beside("list"), "").expect("written");
    let list = log.beside("list");
    let label = label(&log).with(&["--scenes-from", list.to_str().expect("UTF-8")]);
    label.run().exits(2);
    assert!(files_under(&label.output).is_empty());
}
