//! Bad inputs, and how the program ends on them: one test or more for each case of the list of faults.

mod support;

use std::fs;
use std::path::Path;

use occlabel_testkit::LogSpec;
use serde_json::{Value, json};
use support::{
    Arrays, Ended, Label, NAN, Point, SCENE, TestLog, VERSION, files_under, gts_files, leftovers,
    manifest, nano_spec, occlabel, read_arrays, report, text,
};

/// Leaves out what cannot be used.
const SKIP: [&str; 2] = ["--on-error", "skip"];

/// The line for a log in the small grid, with evidence.
fn label(log: &TestLog) -> Label {
    label_into(log, "out")
}

fn label_into(log: &TestLog, output: &str) -> Label {
    Label::new(&log.root(), &log.beside(output)).small().with(&["--evidence"])
}

/// Asserts that the log is refused with a message of these parts, and that nothing was written.
#[track_caller]
fn assert_refused(label: &Label, parts: &[&str]) -> Ended {
    let ended = label.run().exits(1).tells(parts).tells(&["expected", "found"]);
    assert_nothing_written(label);
    ended
}

/// Asserts that there is no array, no part of one, and no manifest.
#[track_caller]
fn assert_nothing_written(label: &Label) {
    let files = files_under(&label.output);
    let is_result = |name: &&String| name.starts_with("gts/") || name.starts_with("manifest");
    assert_eq!(files.keys().find(is_result), None);
}

/// Asserts that the log is labelled under `--on-error skip`, but for what the report lists by this
/// rule, and that these keyframes are there, whole, and no others.
#[track_caller]
fn assert_skipped(label: &Label, rule: &str, keyframes: &[String]) -> Ended {
    let label = label.clone().with(&SKIP);
    let ended = label.run().exits(3);
    assert!(!losses(&label.output, rule).is_empty(), "{}", report(&label.output));
    assert_keyframes(&label.output, keyframes);
    assert_eq!(leftovers(&label.output), [""; 0]);
    ended
}

/// Asserts that these keyframes are there, in folders of their own, and no others.
#[track_caller]
fn assert_keyframes(output: &Path, keyframes: &[String]) {
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
fn losses(output: &Path, rule: &str) -> Vec<Value> {
    listed(output, "skipped_or_degraded", rule)
}

/// What the report warns of by a rule.
fn warnings(output: &Path, rule: &str) -> Vec<Value> {
    listed(output, "warnings", rule)
}

fn listed(output: &Path, list: &str, rule: &str) -> Vec<Value> {
    let report = report(output);
    let list = report[list].as_array().expect("a list");
    list.iter().filter(|fault| fault["rule"] == rule).cloned().collect()
}

/// How many points were dropped for a reason.
fn dropped(output: &Path, reason: &str) -> u64 {
    report(output)["total"]["dropped"][reason].as_u64().expect("a count")
}

/// The arrays of the keyframes, in the order of time.
fn arrays(log: &TestLog, label: &Label) -> Vec<Arrays> {
    let keyframes = log.keyframes();
    keyframes.iter().map(|token| read_arrays(&label.output, SCENE, token)).collect()
}

/// What the untouched log gives.
fn untouched(args: &[&str]) -> (TestLog, Label) {
    let log = TestLog::nano();
    let label = label(&log).with(args);
    label.run().exits(0);
    (log, label)
}

/// All keyframes but the one at a place.
fn keyframes_without(log: &TestLog, at: usize) -> Vec<String> {
    let mut keyframes = log.keyframes();
    keyframes.remove(at);
    keyframes
}

fn field(row: &Value, name: &str) -> String {
    row[name].as_str().expect("a string").to_owned()
}

// --- 1 to 5: files of points ------------------------------------------------------------------

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

// --- 6 to 11: points --------------------------------------------------------------------------

/// Spoils every n-th point.
fn spoil(points: &mut [Point], every: usize, value: f32) -> usize {
    let spoilt = points.iter_mut().step_by(every);
    spoilt.enumerate().map(|(count, point)| point[count % 3] = value).count()
}

#[test]
fn fault_06_points_that_are_not_finite_are_dropped_and_counted() {
    let log = TestLog::nano();
    let (mut nans, mut infinities) = (0, 0);
    log.edit_points(&log.other_files()[0], |points| nans = spoil(points, 10, f32::NAN));
    log.edit_points(&log.key_files()[1], |points| infinities = spoil(points, 7, f32::INFINITY));
    let label = label(&log);
    label.run().exits(0).tells_nothing_of("warning");
    assert!(nans > 50 && infinities > 50);
    assert_eq!(dropped(&label.output, "not_finite"), (nans + infinities) as u64);
    assert_keyframes(&label.output, &log.keyframes());
}

#[test]
fn fault_06_more_than_half_of_them_is_warned_of() {
    let log = TestLog::nano();
    let file = &log.other_files()[0];
    log.edit_points(file, |points| assert!(spoil(points, 1, f32::NEG_INFINITY) > 0));
    let label = label(&log);
    label.run().exits(0).tells(&["warning", file, "NaN or an infinity"]);
    assert_eq!(warnings(&label.output, "sweep-not-finite").len(), 1);
}

#[test]
fn fault_06_dropped_points_change_nothing() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    for file in log.other_files() {
        log.edit_points(&file, |points| points.push([f32::NAN, 1.0, 1.0, 0.0, 3.0]));
    }
    label(&log).run().exits(0);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_07_far_points_are_dropped_and_counted() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    let far = [[1e7, 0.0, 0.0], [-4e6, 3e6, 4e6], [0.0, f32::MAX, 0.0], [0.0, 0.0, 1000.1]];
    let far = far.map(|[x, y, z]| [x, y, z, 0.0, 3.0]);
    log.edit_points(&log.other_files()[0], |points| points.extend(far));
    let label = label(&log);
    label.run().exits(0);
    assert_eq!(dropped(&label.output, "far") - dropped(&clean.output, "far"), 4);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_07_a_raised_range_clips_far_points_without_overflow() {
    let log = TestLog::nano();
    let ahead = [[8e5, 1e3, -2e3, 0.0, 3.0], [-5e5, -5e5, 4e5, 0.0, 3.0]];
    log.edit_points(&log.other_files()[0], |points| points.extend(ahead));
    let label = label(&log).with(&["--set", "aggregate.max_range_m=838860"]);
    label.run().exits(0);
    assert_eq!(dropped(&label.output, "far"), 0);
    let far = label_into(&log, "far").with(&["--set", "aggregate.max_range_m=838861"]);
    far.run().exits(2).tells(&["aggregate.max_range_m", "2^20"]);
}

#[test]
fn fault_08_points_at_the_origin_are_dropped_and_counted() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    log.edit_points(&log.other_files()[3], |points| points.extend([[0.0; 5], [-0.0; 5]]));
    let label = label(&log);
    label.run().exits(0);
    assert_eq!(dropped(&label.output, "at_origin"), 2);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_10_a_grid_away_from_the_sensor_is_a_part_of_one_around_it() {
    let (log, around) = untouched(&[]);
    let ahead = label_into(&log, "ahead").with(&["--set", "grid.min_m=[8.0, -16.0, -1.0]"]);
    ahead.run().exits(0);
    let log_of = |label| arrays(&log, label);
    let mut occupied = 0;
    for (whole, part) in log_of(&around).iter().zip(&log_of(&ahead)) {
        assert_eq!(part.evidence.state.shape(), [10, 40, 8]);
        for (x, y, z) in
            (0..10).flat_map(|x| (0..40).flat_map(move |y| (0..8).map(move |z| (x, y, z))))
        {
            let (here, there) = ([x, y, z], [x + 30, y, z]);
            assert_eq!(part.labels.semantics.at(here), whole.labels.semantics.at(there));
            assert_eq!(part.evidence.hits.at(here), whole.evidence.hits.at(there));
            assert_eq!(part.evidence.crossings.at(here), whole.evidence.crossings.at(there));
            occupied += usize::from(*part.evidence.state.at(here) == 2);
        }
    }
    assert!(occupied > 100, "{occupied} occupied voxels");
}

/// Occupied voxels along the ego's lane at the height of its roof: where it was and will be.
fn on_the_lane(arrays: &Arrays) -> usize {
    let lane = (10..30).flat_map(|x| [19, 20].map(|y| [x, y, 3]));
    lane.filter(|voxel| *arrays.evidence.state.at(*voxel) == 2).count()
}

#[test]
fn fault_11_returns_from_the_own_body_leave_no_trail() {
    let (log, filtered) = untouched(&[]);
    assert!(dropped(&filtered.output, "ego") > 20);
    assert_eq!(arrays(&log, &filtered).iter().map(on_the_lane).sum::<usize>(), 0);
    let (log, bare) = untouched(&["--set", "aggregate.ego_box_m=none"]);
    assert_eq!(dropped(&bare.output, "ego"), 0);
    assert!(arrays(&log, &bare).iter().map(on_the_lane).sum::<usize>() > 3);
}

// --- 12 to 16: poses and times ----------------------------------------------------------------

/// Scales the rotation of the ego pose of a sweep.
fn scale_rotation(log: &TestLog, sweep: &Value, norm: f64) {
    log.edit("ego_pose", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == sweep["ego_pose_token"]);
        row.expect("a pose")["rotation"] = json!([norm, 0.0, 0.0, 0.0]);
    });
}

#[test]
fn fault_12_a_norm_off_by_rounding_is_mended_silently() {
    let log = TestLog::nano();
    scale_rotation(&log, &log.sweeps()[4], 1.0 + 5e-7);
    label(&log).run().exits(0).tells_nothing_of("warning");
    let (_log, clean) = untouched(&[]);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_12_a_norm_off_by_half_a_percent_is_mended_with_a_warning() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    scale_rotation(&log, sweep, 1.005);
    let pose = field(sweep, "ego_pose_token");
    label(&log).run().exits(0).tells(&["warning", "ego_pose.json", &pose, "norm 1.005"]);
    let (_log, clean) = untouched(&[]);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_12_a_norm_that_tells_no_rotation_is_refused() {
    for (norm, told) in [(1.5, "norm 1.5"), (0.0, "norm 0"), (1.011, "norm 1.011")] {
        let log = TestLog::nano();
        let sweep = &log.sweeps()[2];
        scale_rotation(&log, sweep, norm);
        let pose = field(sweep, "ego_pose_token");
        assert_refused(&label(&log), &["ego_pose.json", &pose, "norm 1", told]);
        assert_skipped(&label_into(&log, "skip"), "quaternion-norm", &log.keyframes());
    }
}

#[test]
fn fault_12_a_nan_in_a_pose_is_refused() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[2];
    log.edit("ego_pose", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == sweep["ego_pose_token"]);
        row.expect("a pose")["rotation"] = json!([1.0, NAN, 0.0, 0.0]);
    });
    assert_refused(&label(&log), &["ego_pose.json", "norm NaN"]);
    assert_skipped(&label_into(&log, "skip"), "quaternion-norm", &log.keyframes());
}

#[test]
fn fault_19_a_pose_beyond_a_thousand_million_metres_is_refused() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    log.edit("ego_pose", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == sweep["ego_pose_token"]);
        row.expect("a pose")["translation"] = json!([1e300, 0.0, 0.0]);
    });
    assert_refused(&label(&log), &["ego_pose.json", "at most 1e9 m", "1e300"]);
    let keyframes = keyframes_without(&log, 1);
    assert_skipped(&label_into(&log, "skip"), "translation", &keyframes);
}

#[test]
fn fault_12_a_refused_pose_of_a_key_sweep_takes_the_keyframe_along() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    assert_eq!(sweep["is_key_frame"], true);
    scale_rotation(&log, sweep, 1.5);
    assert_refused(&label(&log), &["ego_pose.json", "norm 1.5"]);
    let ended =
        assert_skipped(&label_into(&log, "skip"), "keyframe-sweep", &keyframes_without(&log, 1));
    ended.tells(&[&log.keyframes()[1]]);
}

/// Adds a sweep with the time and pose of another: its row again, with its own token and file.
fn add_sweep_beside(log: &TestLog, sweep: &Value) -> String {
    let file = field(sweep, "filename").replace(".pcd.bin", "_again.pcd.bin");
    fs::copy(log.file(&field(sweep, "filename")), log.file(&file)).expect("copied");
    let mut row = sweep.clone();
    row["token"] = json!("ffffffffffffffffffffffffffffffff");
    row["filename"] = json!(file);
    row["prev"] = json!("");
    row["next"] = json!("");
    log.edit("sample_data", |rows| rows.push(row));
    file
}

#[test]
fn fault_15_a_sweep_that_is_there_twice_counts_once() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    add_sweep_beside(&log, &log.sweeps()[2]);
    label(&log).run().exits(0).tells(&["warning", "ffffffff", "same bytes"]);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_15_two_sweeps_of_one_time_both_count() {
    let log = TestLog::nano();
    let file = add_sweep_beside(&log, &log.sweeps()[2]);
    log.edit_points(&file, |points| points.truncate(points.len() / 2));
    let (label, points) = (label(&log), |output: &Path| report(output)["total"]["points"].as_u64());
    label.run().exits(0).tells(&["warning", "both are kept"]);
    assert_eq!(warnings(&label.output, "time-repeated").len(), 1);
    let (_log, clean) = untouched(&[]);
    assert!(points(&label.output) > points(&clean.output));
}

#[test]
fn fault_16_rows_in_any_order_give_the_same_bytes() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    for table in ["sample_data", "sample", "sample_annotation", "instance", "ego_pose", "lidarseg"]
    {
        log.edit(table, |rows| {
            let middle = rows.len() / 3;
            rows.reverse();
            rows.rotate_left(middle);
        });
    }
    label(&log).run().exits(0).tells_nothing_of("warning");
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

/// Chains rows of sample_data in this order.
fn chain(log: &TestLog, tokens: &[Value]) {
    log.edit("sample_data", |rows| {
        for row in rows {
            let Some(at) = tokens.iter().position(|token| *token == row["token"]) else { continue };
            let neighbour = |at: Option<usize>| at.and_then(|at| tokens.get(at)).cloned();
            row["prev"] = neighbour(at.checked_sub(1)).unwrap_or(json!(""));
            row["next"] = neighbour(Some(at + 1)).unwrap_or(json!(""));
        }
    });
}

#[test]
fn fault_16_a_chain_that_goes_back_in_time_is_warned_of_and_sorted() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    let sweeps = log.sweeps();
    let late = sweeps[5].clone();
    chain(&log, &[0, 2, 3, 4, 5, 1, 6, 7, 8].map(|place: usize| sweeps[place]["token"].clone()));
    let label = label(&log);
    label.run().exits(0).tells(&["warning", &field(&late, "token"), "earlier by 0.5 s"]);
    assert_eq!(warnings(&label.output, "time-backwards").len(), 1);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

// --- 21 to 25: boxes --------------------------------------------------------------------------

/// How many voxels an instance has at each keyframe.
fn voxels_of(log: &TestLog, label: &Label, instance: u16) -> Vec<usize> {
    let count = |arrays: &Arrays| {
        let instances = arrays.evidence.instances.values();
        instances.iter().filter(|found| **found == instance).count()
    };
    arrays(log, label).iter().map(count).collect()
}

/// Index and source id of the track with most voxels at the middle keyframe.
fn largest_track(log: &TestLog, label: &Label) -> (u16, String) {
    let tracks = manifest(&label.output)["scenes"][SCENE]["tracks"].clone();
    let index = |track: &Value| track["index"].as_u64().expect("a number") as u16;
    let tracks = tracks.as_array().expect("tracks").iter();
    let largest = tracks.max_by_key(|track| voxels_of(log, label, index(track))[1]);
    largest.map(|track| (index(track), field(track, "id"))).expect("a track")
}

/// A log whose largest track lacks the annotation of the middle keyframe.
fn with_a_gap() -> (TestLog, u16) {
    let (log, label) = untouched(&[]);
    let (index, instance) = largest_track(&log, &label);
    assert!(voxels_of(&log, &label, index)[1] > 3);
    let middle = log.keyframes()[1].clone();
    log.edit("sample_annotation", |rows| {
        let before = rows.len();
        let is_middle = |row: &Value| {
            row["instance_token"] == instance.as_str() && row["sample_token"] == middle.as_str()
        };
        rows.retain(|row| !is_middle(row));
        assert_eq!(rows.len() + 1, before);
    });
    (log, index)
}

#[test]
fn fault_21_a_missing_middle_box_is_interpolated_over_a_short_gap() {
    let (log, index) = with_a_gap();
    let bridged = label_into(&log, "bridged");
    bridged.run().exits(0);
    assert!(voxels_of(&log, &bridged, index).iter().all(|count| *count > 3));
}

#[test]
fn fault_21_over_a_long_gap_the_object_is_absent() {
    let (log, index) = with_a_gap();
    let torn = label_into(&log, "torn").with(&["--set", "boxes.max_gap_s=0.6"]);
    torn.run().exits(0);
    let voxels = voxels_of(&log, &torn, index);
    assert!(voxels[0] > 0 && voxels[1] == 0 && voxels[2] > 0, "{voxels:?}");
}

#[test]
fn fault_23_a_box_without_a_size_is_refused() {
    for (size, told) in [
        (json!([0.0, 4.5, 1.6]), "0 x 4.5 x 1.6 m"),
        (json!([1.9, -4.5, 1.6]), "1.9 x -4.5 x 1.6 m"),
        (json!([1.9, 4.5, NAN]), "1.9 x 4.5 x NaN m"),
    ] {
        let log = TestLog::nano();
        log.edit("sample_annotation", |rows| rows[0]["size"] = size);
        let token = field(&log_annotations(&log)[0], "token");
        assert_refused(&label(&log), &["sample_annotation.json", &token, told]);
        assert_skipped(&label_into(&log, "skip"), "box-size", &log.keyframes());
        assert_eq!(losses(&log.beside("skip"), "box-size").len(), 1);
    }
}

/// The annotations' tokens, though a bare `NaN` may stand in the table.
fn log_annotations(log: &TestLog) -> Vec<Value> {
    let path = log.file(&format!("{VERSION}/sample_annotation.json"));
    let table = fs::read_to_string(path).expect("a table").replace("NaN", "null");
    serde_json::from_str(&table).expect("rows")
}

#[test]
fn fault_23_a_box_without_a_rotation_is_refused() {
    let log = TestLog::nano();
    log.edit("sample_annotation", |rows| rows[0]["rotation"] = json!([1.0, 0.0, 0.0, NAN]));
    let token = field(&log_annotations(&log)[0], "token");
    assert_refused(&label(&log), &["sample_annotation.json", &token, "norm NaN"]);
    assert_skipped(&label_into(&log, "skip"), "quaternion-norm", &log.keyframes());
}

#[test]
fn fault_23_every_refused_box_is_told_at_once() {
    let log = TestLog::nano();
    let tokens: Vec<String> =
        log.rows("sample_annotation")[..3].iter().map(|row| field(row, "token")).collect();
    log.edit("sample_annotation", |rows| {
        rows[..3].iter_mut().for_each(|row| row["size"] = json!([1.0, 0.0, 1.0]));
    });
    let mut ended = assert_refused(&label(&log), &[]);
    for token in &tokens {
        ended = ended.tells(&[token]);
    }
}

/// Adds a track to the log: another's boxes, changed.
fn add_track(log: &TestLog, like: &str, token: &str, change: impl Fn(&mut Value)) {
    let instance = |row: &&Value| row["token"] == like;
    let mut added = log.rows("instance").iter().find(instance).expect("a track").clone();
    added["token"] = json!(token);
    log.edit("instance", |rows| rows.push(added));
    log.edit("sample_annotation", |rows| {
        let of_track = |row: &&Value| row["instance_token"] == like;
        let mut boxes: Vec<Value> = rows.iter().filter(of_track).cloned().collect();
        for (at, row) in boxes.iter_mut().enumerate() {
            row["token"] = json!(format!("{token}-{at}"));
            row["instance_token"] = json!(token);
            change(row);
        }
        rows.extend(boxes);
    });
}

fn scale_size(row: &mut Value, factor: f64) {
    let sides = row["size"].as_array().expect("a size").iter();
    row["size"] = sides.map(|side| json!(side.as_f64().expect("a side") * factor)).collect();
}

#[test]
fn fault_24_of_two_equal_boxes_the_lower_track_gets_the_points() {
    let (log, clean) = untouched(&[]);
    let (_, car) = largest_track(&log, &clean);
    add_track(&log, &car, "ffffffff", |_| ());
    let label = label_into(&log, "added");
    label.run().exits(0);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}

#[test]
fn fault_24_of_two_boxes_the_smaller_gets_the_points() {
    let (log, clean) = untouched(&[]);
    let (index, car) = largest_track(&log, &clean);
    add_track(&log, &car, "ffffffff", |row| scale_size(row, 0.999));
    let label = label_into(&log, "added");
    label.run().exits(0);
    let last = manifest(&label.output)["scenes"][SCENE]["tracks"].as_array().map(Vec::len);
    let smaller = voxels_of(&log, &label, last.expect("tracks") as u16);
    assert_eq!(smaller, voxels_of(&log, &clean, index));
    assert!(smaller.iter().all(|count| *count > 3), "{smaller:?}");
    assert_eq!(voxels_of(&log, &label, index), [0; 3]);
}

/// Lifts a box out of everything into the sky.
fn lift(row: &mut Value) {
    row["translation"][2] = json!(row["translation"][2].as_f64().expect("a height") + 3.2);
}

#[test]
fn fault_25_a_box_without_points_occupies_nothing_and_is_counted() {
    let (log, clean) = untouched(&[]);
    let (_, car) = largest_track(&log, &clean);
    add_track(&log, &car, "ffffffff", lift);
    let label = label_into(&log, "added");
    label.run().exits(0);
    let empty =
        |output: &Path| report(output)["total"]["boxes_without_points"].as_u64().expect("a count");
    assert_eq!(empty(&label.output), empty(&clean.output) + 3);
    for (with, without) in arrays(&log, &label).iter().zip(&arrays(&log, &clean)) {
        assert_eq!(with.labels.semantics, without.labels.semantics);
        assert_eq!(with.evidence.instances, without.evidence.instances);
    }
}

// --- 26 to 28: labels -------------------------------------------------------------------------

fn rename_category(log: &TestLog, from: &str, to: &str) {
    log.edit("category", |rows| {
        let row = rows.iter_mut().find(|row| row["name"] == from);
        row.expect("a category")["name"] = json!(to);
    });
}

#[test]
fn fault_26_an_unknown_category_is_refused_with_its_count() {
    let log = TestLog::nano();
    let cars = log.rows("category").iter().find(|row| row["name"] == "vehicle.car").cloned();
    let cars = cars.expect("cars")["token"].clone();
    let tracks: Vec<Value> =
        log.rows("instance").into_iter().filter(|row| row["category_token"] == cars).collect();
    let boxes = 3 * tracks.len();
    rename_category(&log, "vehicle.car", "vehicle.hovercraft");
    let told = format!("`vehicle.hovercraft` of {boxes} boxes");
    assert_refused(&label(&log), &["category.json", SCENE, &told, "--unknown-as"]);
}

#[test]
fn fault_26_an_unmapped_raw_label_is_refused_with_its_count() {
    let log = TestLog::nano();
    let row = log
        .rows("lidarseg")
        .into_iter()
        .find(|row| row["sample_data_token"] == log.sweeps()[4]["token"]);
    let file = field(&row.expect("labels"), "filename");
    let mut raw = fs::read(log.file(&file)).expect("labels");
    raw[..5].fill(200);
    fs::write(log.file(&file), raw).expect("written");
    assert_refused(&label(&log), &[&file, SCENE, "200 (no category) of 5 points", "--unknown-as"]);
    assert_skipped(&label_into(&log, "skip"), "unknown-label", &keyframes_without(&log, 1));
    let taken = label_into(&log, "taken").with(&["--unknown-as", "others"]);
    taken.run().exits(0).tells(&["warning", "200", "taken as `others`"]);
    assert_eq!(warnings(&taken.output, "unknown-label").len(), 1);
}

#[test]
fn fault_26_an_unknown_category_can_be_taken_as_a_class() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    rename_category(&log, "vehicle.car", "vehicle.hovercraft");
    let label = label(&log).with(&["--unknown-as", "car"]);
    label.run().exits(0).tells(&["warning", "vehicle.hovercraft", "taken as `car`"]);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
    let wrong = label_into(&log, "wrong").with(&["--unknown-as", "hovercraft"]);
    wrong.run().exits(2).tells(&["--unknown-as", "hovercraft", "car"]);
}

#[test]
fn fault_26_a_category_table_without_indices_says_what_to_unpack() {
    let log = TestLog::nano();
    log.edit("category", |rows| {
        rows.iter_mut().for_each(|row| drop(row.as_object_mut().expect("a row").remove("index")));
    });
    assert_refused(&label(&log), &["category.json", "`index`", "nuScenes-lidarseg"]);
}

#[test]
fn fault_27_another_number_of_labels_than_points_is_refused() {
    let log = TestLog::nano();
    let row = log
        .rows("lidarseg")
        .into_iter()
        .find(|row| row["sample_data_token"] == log.sweeps()[4]["token"]);
    let file = field(&row.expect("labels"), "filename");
    log.truncate(&file, 2);
    let points = log.points(&log.key_files()[1]).len();
    let (expected, found) = (format!("{points} labels"), format!("{} labels", points - 2));
    assert_refused(&label(&log), &[&file, SCENE, &expected, &found]);
    assert_skipped(&label_into(&log, "skip"), "label-count", &keyframes_without(&log, 1));
}

#[test]
fn fault_27_the_manifest_tells_the_class_map_by_its_hash() {
    let (_log, label) = untouched(&[]);
    let text = occlabel(&["presets", "taxonomies/occ3d-nuscenes"]).exits(0).stdout;
    let taxonomy = manifest(&label.output)["taxonomy"].clone();
    let hash = blake3::hash(text.as_bytes()).to_hex().to_string();
    assert_eq!(taxonomy, json!({"name": "occ3d-nuscenes", "hash": hash}));
}

#[test]
fn fault_28_labels_of_some_frames_serve_the_others() {
    let args = ["--set", "relabel.max_distance_m=none", "--set", "relabel.drop_ghosts=none"];
    let (_log, all) = untouched(&args);
    let log = TestLog::nano();
    log.edit("lidarseg", |rows| rows.truncate(1));
    let some = label(&log).with(&args);
    some.run().exits(0);
    let (mut same, mut occupied) = (0, 0);
    for (a, b) in arrays(&log, &all).iter().zip(&arrays(&log, &some)) {
        assert_eq!(a.evidence.state, b.evidence.state, "geometry is from all sweeps");
        let pairs = a.labels.semantics.values().iter().zip(b.labels.semantics.values());
        for (a, b) in pairs.filter(|(a, _)| **a != 17) {
            assert!(*a == 0 || *b != 0, "an unlabelled point counted as class 0");
            same += usize::from(a == b);
            occupied += 1;
        }
    }
    assert!(occupied > 1000 && same * 10 > occupied * 8, "{same} of {occupied}");
}

// --- 29: cameras ------------------------------------------------------------------------------

/// How many voxels the camera of a bit sees at each keyframe.
fn seen_by(arrays: &[Arrays], bit: u16) -> Vec<usize> {
    let count = |arrays: &Arrays| {
        let bits = arrays.evidence.camera_bits.values();
        bits.iter().filter(|bits| **bits >> bit & 1 == 1).count()
    };
    arrays.iter().map(count).collect()
}

#[test]
fn fault_29_no_camera_sees_nothing_and_all_is_written() {
    let log = TestLog::simulated(&LogSpec { cameras: false, ..nano_spec() });
    let label = label(&log);
    label.run().exits(0).tells(&["warning", "images of a camera", "none"]);
    assert_eq!(warnings(&label.output, "camera-absent").len(), 1);
    assert_eq!(manifest(&label.output)["scenes"][SCENE]["cameras"], json!([]));
    for arrays in arrays(&log, &label) {
        assert!(arrays.labels.mask_camera.values().iter().all(|seen| *seen == 0));
        assert!(arrays.labels.mask_lidar.values().contains(&1));
    }
}

#[test]
fn fault_29_a_camera_missing_at_a_keyframe_has_bit_0_there() {
    let log = TestLog::nano();
    let middle = log.keyframes()[1].clone();
    let is_missing = |row: &Value| {
        field(row, "filename").contains("/CAM_BACK/") && row["sample_token"] == middle.as_str()
    };
    log.edit("sample_data", |rows| rows.retain(|row| !is_missing(row)));
    let label = label(&log);
    label.run().exits(0).tells(&["warning", "CAM_BACK", &middle]);
    assert_eq!(warnings(&label.output, "camera-absent").len(), 1);
    let cameras = manifest(&label.output)["scenes"][SCENE]["cameras"].clone();
    assert_eq!((&cameras[0], &cameras[3]), (&json!("CAM_BACK"), &json!("CAM_FRONT")));
    let arrays = arrays(&log, &label);
    let (back, front) = (seen_by(&arrays, 0), seen_by(&arrays, 3));
    assert!(back[0] > 0 && back[1] == 0 && back[2] > 0, "{back:?}");
    assert!(front.iter().all(|seen| *seen > 0), "{front:?}");
}

// --- 32: grids --------------------------------------------------------------------------------

#[test]
fn fault_32_an_impossible_voxel_is_refused_before_any_data() {
    let log = TestLog::nano();
    log.key_files().iter().chain(&log.other_files()).for_each(|file| log.truncate(file, 3));
    fs::write(log.file(&format!("{VERSION}/sample_data.json")), "[{").expect("written");
    let label = Label::new(&log.root(), &log.beside("out"));
    for size in ["0", "-0.4", "nan", "inf", "0.3", "1e-6", "1e6", "[0.4, 0.4, 0.0]"] {
        let setting = format!("grid.voxel_size_m={size}");
        label.clone().with(&["--set", &setting]).run().exits(2).tells(&["[grid]", "expected"]);
    }
    assert!(!label.output.exists());
}

#[test]
fn fault_32_too_many_voxels_are_told_with_their_bytes() {
    let log = TestLog::nano();
    let label =
        Label::new(&log.root(), &log.beside("out")).with(&["--set", "grid.voxel_size_m=1e-5"]);
    label.run().exits(2).tells(&["8000000 x 8000000 x 640000", "bytes"]);
}

// --- 36: hostile names ------------------------------------------------------------------------

/// Names that lead out of the log, or write to the terminal.
const HOSTILE: [&str; 6] = [
    "/etc/passwd",
    "../../../etc/passwd",
    "sweeps/../../../x",
    "sweeps/a\0b",
    "sweeps/\u{1b}]0;owned\u{7}\u{1b}[31mred",
    "C:\\windows\\x",
];

/// Asserts that no stream carries a raw control character.
#[track_caller]
fn assert_clean(ended: &Ended) {
    for stream in [&ended.stdout, &ended.stderr] {
        assert!(!stream.chars().any(|c| c.is_control() && c != '\n'), "{stream:?}");
    }
}

#[test]
fn fault_36_a_hostile_sweep_name_is_refused_and_escaped() {
    for name in HOSTILE {
        let log = TestLog::nano();
        let token = log.sweeps()[2]["token"].clone();
        log.edit("sample_data", |rows| {
            let row = rows.iter_mut().find(|row| row["token"] == token);
            row.expect("a sweep")["filename"] = json!(name);
        });
        let parts = ["sample_data.json", token.as_str().expect("a token"), "below the log's root"];
        assert_clean(&assert_refused(&label(&log), &parts));
        assert_clean(&label_into(&log, "skip").with(&SKIP).run().exits(3));
    }
}

#[test]
fn fault_36_a_hostile_label_name_is_refused_and_escaped() {
    for name in HOSTILE {
        let log = TestLog::nano();
        log.edit("lidarseg", |rows| rows[1]["filename"] = json!(name));
        assert_clean(&assert_refused(&label(&log), &["lidarseg.json", "below the log's root"]));
    }
}

#[test]
fn fault_36_a_hostile_scene_name_is_refused_and_escaped() {
    for name in ["../../x", "/tmp/x", "a/b", "..", "", "a\0", "\u{1b}[31mred", "a\nerror: fake"] {
        let log = TestLog::nano();
        log.edit("scene", |rows| rows[0]["name"] = json!(name));
        assert_clean(&assert_refused(&label(&log), &["scene.json", "a name of A-Z"]));
        let line = ["inspect", "--format", "nuscenes", "--input"];
        let root = log.root();
        let inspected = occlabel(&[line[0], line[1], line[2], line[3], text(&root)]);
        assert_clean(&inspected.exits(1));
    }
}

#[test]
fn fault_36_a_hostile_category_name_is_escaped() {
    let log = TestLog::nano();
    rename_category(&log, "vehicle.car", "car\u{1b}[2J\u{9b}31m\nerror: fake");
    assert_clean(&assert_refused(&label(&log), &["category.json", "\\u{1b}[2J"]));
    let root = log.root();
    let line = ["inspect", "--format", "nuscenes", "--input", text(&root), "--unknown-as", "car"];
    let told = occlabel(&line).exits(0);
    assert!(told.stdout.contains("\\u{1b}[2J"));
    assert_clean(&told);
}

#[test]
fn fault_36_a_hostile_keyframe_token_is_refused_and_escaped() {
    let log = TestLog::nano();
    let (token, hostile) = (log.keyframes()[1].clone(), "../../\u{1b}[31m");
    for table in ["sample", "sample_data", "sample_annotation"] {
        log.edit(table, |rows| {
            for row in rows.iter_mut() {
                for key in ["token", "sample_token"] {
                    if row[key] == token.as_str() {
                        row[key] = json!(hostile);
                    }
                }
            }
        });
    }
    assert_clean(&assert_refused(&label(&log), &["A-Z, a-z"]));
}

// --- 37: symbolic links -----------------------------------------------------------------------

#[cfg(unix)]
mod links {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn fault_37_a_linked_root_and_linked_blobs_are_followed() {
        let (_log, clean) = untouched(&[]);
        let log = TestLog::nano();
        for folder in ["samples", "sweeps/LIDAR_TOP", VERSION] {
            let moved = log.beside(&folder.replace('/', "-"));
            fs::rename(log.file(folder), &moved).expect("moved");
            symlink(&moved, log.file(folder)).expect("a link");
        }
        let file = log.other_files()[0].clone();
        fs::rename(log.file(&file), log.beside("sweep.bin")).expect("moved");
        symlink(log.beside("sweep.bin"), log.file(&file)).expect("a link");
        symlink(log.root(), log.beside("link")).expect("a link");
        let label =
            Label::new(&log.beside("link"), &log.beside("out")).small().with(&["--evidence"]);
        label.run().exits(0);
        assert!(gts_files(&label.output) == gts_files(&clean.output));
    }

    #[test]
    fn fault_37_a_loop_of_links_is_told() {
        let log = TestLog::nano();
        let file = log.other_files()[0].clone();
        log.remove(&file);
        symlink(log.file(&file), log.file(&file)).expect("a link");
        assert_refused(&label(&log), &[&file]);
    }

    #[test]
    fn fault_37_an_output_folder_may_be_a_link() {
        let (_log, clean) = untouched(&[]);
        let log = TestLog::nano();
        fs::create_dir_all(log.beside("disk/gts")).expect("a folder");
        symlink(log.beside("disk"), log.beside("out")).expect("a link");
        label(&log).run().exits(0);
        assert!(gts_files(&log.beside("disk")) == gts_files(&clean.output));
        assert!(log.beside("out").is_symlink());
    }

    #[test]
    fn fault_37_an_output_file_may_not_be_a_link() {
        let log = TestLog::nano();
        let victim = log.beside("victim");
        fs::write(&victim, "mine").expect("written");
        let folder = log.beside(&format!("out/gts/{SCENE}/{}", log.keyframes()[1]));
        fs::create_dir_all(&folder).expect("a folder");
        symlink(&victim, folder.join("labels.npz")).expect("a link");
        label(&log).run().exits(1).tells(&["labels.npz", "a symbolic link"]);
        assert_eq!(fs::read(&victim).expect("still there"), b"mine");
        assert!(!log.beside("out/manifest.json").exists());
    }

    #[test]
    fn fault_37_nothing_is_written_through_a_link_in_place_of_a_record() {
        for name in ["run.json", "journal.jsonl", "manifest.json", "report.json"] {
            let log = TestLog::nano();
            let victim = log.beside("victim");
            fs::create_dir_all(log.beside("out")).expect("a folder");
            symlink(&victim, log.beside("out").join(name)).expect("a link");
            label(&log).run().exits(1).tells(&[name, "a symbolic link"]);
            assert!(!victim.exists(), "{name}");
        }
    }
}

// --- labels.md section 5 ----------------------------------------------------------------------

#[test]
fn section_5_no_labels_and_no_class_for_such_points_exits_with_2_before_any_sweep() {
    let log = TestLog::nano();
    log.edit("lidarseg", |rows| rows.clear());
    log.key_files().iter().for_each(|file| log.truncate(file, 3));
    let label = label(&log).with(&["--set", "relabel.unknown_class=drop"]);
    label.run().exits(2).tells(&[SCENE, "point labels", "relabel.unknown_class"]);
    assert!(!label.output.exists());
}

#[test]
fn section_5_a_labelled_scene_beside_it_is_labelled_under_skip() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let second: Vec<Value> = log.rows("lidarseg").into_iter().skip(3).collect();
    log.edit("lidarseg", |rows| *rows = second);
    let label = label(&log).with(&["--set", "relabel.unknown_class=drop"]);
    label.run().exits(1).tells(&[SCENE, "relabel.unknown_class"]);
    assert_nothing_written(&label);
    label.with(&SKIP).run().exits(3).tells(&["warning", SCENE]);
    assert!(gts_files(&log.beside("out")).keys().all(|name| name.starts_with("scene-0002/")));
}

// --- the policy -------------------------------------------------------------------------------

#[test]
fn a_scene_that_is_broken_is_skipped_and_the_others_are_labelled() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let token = field(&log.sweeps()[0], "token");
    log.edit("sample_data", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == token.as_str());
        row.expect("a sweep")["filename"] = json!("/etc/passwd");
    });
    let label = label(&log);
    assert_refused(&label, &["sample_data.json", &token]);
    label.clone().with(&SKIP).run().exits(3);
    assert_eq!(losses(&label.output, "file-name")[0]["scene"], SCENE);
    let written = gts_files(&label.output);
    assert!(written.len() == 6 && written.keys().all(|name| name.starts_with("scene-0002/")));
}
