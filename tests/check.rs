//! The command `check`: it agrees with `label`, and tells everything at once.

mod support;

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use support::{Ended, Label, TestLog, VERSION, files_under, gts_files, occlabel, report, text};

/// What `check --json` says.
struct Checked {
    ended: Ended,
    json: Value,
}

fn checked(format: &str, root: &Path, args: &[&str]) -> Checked {
    let line = ["check", "--format", format, "--input", text(root), "--json", "--quiet"];
    let ended = occlabel(&[&line[..], args].concat());
    let json = serde_json::from_str(&ended.stdout).expect("one object");
    Checked { ended, json }
}

fn check(log: &TestLog) -> Checked {
    checked("nuscenes", &log.root(), &[])
}

impl Checked {
    /// Asserts the exit code, and that these are the rules of a severity, in order.
    #[track_caller]
    fn finds(self, code: i32, severity: &str, rules: &[&str]) -> Self {
        let found = self.of(severity);
        let found: Vec<_> = found.iter().map(|finding| finding["rule"].clone()).collect();
        assert_eq!(json!(found), json!(rules), "{}", self.json);
        Self { ended: self.ended.exits(code), json: self.json }
    }

    fn of(&self, severity: &str) -> Vec<Value> {
        let findings = self.json["findings"].as_array().expect("findings");
        findings.iter().filter(|finding| finding["severity"] == severity).cloned().collect()
    }

    /// The finding of a rule.
    #[track_caller]
    fn one(&self, rule: &str) -> &Value {
        let findings = self.json["findings"].as_array().expect("findings");
        findings.iter().find(|finding| finding["rule"] == rule).expect("a finding of the rule")
    }
}

fn label(log: &TestLog) -> Label {
    Label::new(&log.root(), &log.beside("out")).small()
}

/// What the report of a run that ended well warns of by a rule.
#[track_caller]
fn warned(label: &Label, rule: &str) -> Vec<Value> {
    label.run().exits(0);
    let report = report(&label.output);
    let warnings = report["warnings"].as_array().expect("a list").iter();
    warnings.filter(|fault| fault["rule"] == rule).cloned().collect()
}

fn edit_row(log: &TestLog, table: &str, token: &Value, edit: impl FnOnce(&mut Value)) {
    log.edit(table, |rows| {
        edit(rows.iter_mut().find(|row| row["token"] == *token).expect("a row"));
    });
}

#[test]
fn a_sound_log_has_nothing_but_remarks_and_nothing_is_written() {
    let log = TestLog::nano();
    let before = files_under(&log.root());
    let found = check(&log).finds(0, "error", &[]).finds(0, "warning", &[]);
    let found = found.finds(0, "remark", &["image-absent"]);
    assert_eq!(found.one("image-absent")["found"], "18 of 18 absent");
    let scene = &found.json["scenes"]["scene-0001"];
    assert_eq!((&scene["sweeps"], &scene["keyframes"]), (&json!(9), &json!(3)));
    assert!(scene["ground_thickness_m"].as_f64().expect("a ground") < 0.05, "{scene}");
    assert!(files_under(&log.root()) == before);
}

#[test]
fn lines_tell_the_same_and_usage_is_2() {
    let log = TestLog::nano();
    log.truncate(&log.other_files()[2], 7);
    let root = log.root();
    let line = ["check", "--format", "nuscenes", "--input", text(&root)];
    let told = occlabel(&line).exits(1).stdout;
    let parts = ["error [sweep-length] scene-0001: ", &log.other_files()[2], "13 more than"];
    assert!(parts.iter().all(|part| told.contains(part)), "{told}");
    assert!(told.ends_with("errors: 1, warnings: 0, remarks: 1\n"), "{told}");
    occlabel(&["check", "--format", "nuscenes", "--input", "/no/log"]).exits(2);
    occlabel(&[&line[..], &["--set", "a.b=1"]].concat()).exits(2);
    let found = checked("nuscenes", Path::new("/no/log"), &[]).finds(2, "error", &["input"]);
    assert_eq!(found.json["errors"], 1);
}

#[test]
fn fault_36_all_files_outside_of_the_root_are_told_at_once() {
    let log = TestLog::nano();
    log.edit("sample_data", |rows| {
        let sweeps = rows.iter_mut().filter(|row| row["fileformat"] == "pcd").take(2);
        sweeps.for_each(|row| row["filename"] = "../a.bin".into());
        let image = rows.iter_mut().find(|row| row["fileformat"] != "pcd").expect("an image");
        image["filename"] = "../a.jpg".into();
    });
    check(&log).finds(1, "error", &["file-name", "file-name"]);
}

#[test]
fn fault_13_poses_in_other_axes_are_told_by_both() {
    let log = TestLog::nano();
    log.edit("ego_pose", |rows| {
        for (place, row) in rows.iter_mut().enumerate() {
            row["translation"] = json!([0.0, place as f64 * 2.0, 0.0]);
            row["rotation"] = json!([1.0, 0.0, 0.0, 0.0]);
        }
    });
    check(&log).one("heading");
    assert_eq!(warned(&label(&log), "heading").len(), 1);
}

#[test]
fn every_fault_is_told_at_once() {
    let log = TestLog::nano();
    let (others, keys) = (log.other_files(), log.key_files());
    log.remove(&others[0]);
    log.remove(&others[1]);
    log.truncate(&others[2], 7);
    log.truncate(&keys[1], 7);
    log.edit("category", |rows| {
        let car = rows.iter_mut().find(|row| row["name"] == "vehicle.car");
        car.expect("cars")["name"] = json!("vehicle.hover\u{1b}");
        let road = rows.iter_mut().find(|row| row["name"] == "flat.driveable_surface");
        road.expect("roads")["name"] = json!("flat.canal, dry");
    });
    let rules = ["missing-files", "missing-file", "missing-file", "unknown-category"];
    let rules = [&rules[..], &["sweep-length", "sweep-length", "unknown-label"]].concat();
    let found = check(&log).finds(1, "error", &rules);
    assert_eq!(found.one("missing-file")["file"], json!(others[0]));
    let missing = found.one("missing-files")["found"].as_str().expect("text").to_owned();
    assert!(missing.starts_with("2 missing, about "), "{missing}");
    assert_eq!(found.json["scenes"]["scene-0001"]["missing_files"], 2);
    let categories = found.one("unknown-category")["found"].as_str().expect("text").to_owned();
    assert!(categories.starts_with("`vehicle.hover\\u{1b}` of "), "{categories}");
    let labels = found.one("unknown-label")["found"].as_str().expect("text").to_owned();
    assert!(
        labels.contains("(flat.canal, dry) of ") && labels.ends_with(" in 2 sweeps"),
        "{labels}"
    );
    label(&log).run().exits(1);
}

#[test]
fn fault_26_unknown_names_with_a_class_are_warnings() {
    let log = TestLog::nano();
    log.edit("category", |rows| {
        let road = rows.iter_mut().find(|row| row["name"] == "flat.driveable_surface");
        road.expect("roads")["name"] = json!("flat.canal");
    });
    check(&log).finds(1, "error", &["unknown-label"]);
    let args = ["--unknown-as", "driveable_surface"];
    checked("nuscenes", &log.root(), &args).finds(3, "warning", &["unknown-label"]);
    label(&log).with(&args).run().exits(0);
}

/// Writes every rotation as x, y, z, w.
fn mix_quaternions(log: &TestLog) {
    for table in ["ego_pose", "calibrated_sensor", "sample_annotation"] {
        log.edit(table, |rows| {
            rows.iter_mut()
                .for_each(|row| row["rotation"].as_array_mut().expect("a list").rotate_left(1));
        });
    }
}

#[test]
fn fault_13_quaternions_in_another_order_are_told_by_the_ground() {
    let log = TestLog::nano();
    mix_quaternions(&log);
    let found = check(&log).finds(1, "error", &["ground-normal"]);
    let hint = found.one("ground-normal")["hint"].as_str().expect("a hint").to_owned();
    assert!(hint.contains("--quat-order"), "{hint}");
    let told = checked("nuscenes", &log.root(), &["--quat-order", "xyzw"]);
    told.finds(0, "error", &[]).finds(0, "warning", &[]);
}

#[test]
fn fault_13_a_rotation_step_is_warned_of_with_both_sweeps() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    edit_row(&log, "ego_pose", &sweep["ego_pose_token"], |row| {
        row["rotation"] = json!([quarter, 0.0, 0.0, quarter]);
    });
    let found = check(&log).finds(3, "warning", &["rotation-step", "rotation-step"]);
    let record = found.one("rotation-step")["record"].as_str().expect("a record").to_owned();
    assert!(record.contains(sweep["token"].as_str().expect("a token")), "{record}");
    let warned = warned(&label(&log), "rotation-step");
    assert_eq!(warned.len(), 2);
    assert!(warned[0]["hint"].as_str().is_some_and(|hint| hint.contains("--quat-order")));
}

/// A sequence of two scans of a road, whose second pose has these rows.
fn kitti_log(root: &Path, pose: &str) {
    let folder = root.join("sequences/00");
    fs::create_dir_all(folder.join("velodyne")).expect("a folder");
    fs::create_dir_all(folder.join("labels")).expect("a folder");
    let point = |i: usize| [(i % 20) as f32 + 3.0, (i / 20) as f32 - 10.0, -1.7, 0.5];
    let points: Vec<u8> = (0..400).flat_map(point).flat_map(f32::to_le_bytes).collect();
    for scan in ["000000", "000001"] {
        fs::write(folder.join(format!("velodyne/{scan}.bin")), &points).expect("written");
        let labels = [40_u32.to_le_bytes(); 400].concat();
        fs::write(folder.join(format!("labels/{scan}.label")), labels).expect("written");
    }
    let calib = "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";
    fs::write(folder.join("calib.txt"), calib).expect("written");
    fs::write(folder.join("times.txt"), "0.0\n0.1\n").expect("written");
    let poses = format!("1 0 0 0 0 1 0 0 0 0 1 0\n{pose}\n");
    fs::write(folder.join("poses.txt"), poses).expect("written");
}

#[test]
fn fault_14_a_mirrored_matrix_is_refused_and_a_rounded_one_is_mended() {
    for (pose, code) in [
        ("1 0 0 0 0 1 0 0 0 0 1 1", 0),
        ("1.00004 0 0 0 0 1 0.00003 0 0 0 1 1", 0),
        ("1 0 0 0 0 1 0 0 0 0 -1 1", 1),
        ("1.001 0 0 0 0 1 0 0 0 0 1 1", 1),
        ("1 0.001 0 0 0 1 0 0 0 0 1 1", 1),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        kitti_log(folder.path(), pose);
        let found = checked("semantickitti", folder.path(), &[]);
        found.finds(code, "error", &["scan-pose"][..code as usize]);
        let (root, output) = (text(folder.path()), folder.path().join("labels"));
        let line = ["label", "--format", "semantickitti", "--input", root, "--output"];
        let ended = occlabel(&[&line[..], &[text(&output)]].concat()).exits(code);
        if code == 1 {
            ended.tells(&["poses.txt", "12 numbers of a rigid transform"]);
        }
    }
}

/// Makes every row of a table from a time on later, microseconds.
fn delay(log: &TestLog, table: &str, from_us: i64, by_us: i64) {
    log.edit(table, |rows| {
        for row in rows {
            let time = row["timestamp"].as_i64().expect("a time");
            row["timestamp"] = json!(if time >= from_us { time + by_us } else { time });
        }
    });
}

#[test]
fn fault_18_a_gap_is_warned_of_and_listed_with_both_sweeps() {
    let log = TestLog::nano();
    let sweeps = log.sweeps();
    delay(&log, "sample_data", sweeps[5]["timestamp"].as_i64().expect("a time"), 2_000_000);
    let found = check(&log).finds(3, "warning", &["sweep-gap"]);
    assert_eq!(found.one("sweep-gap")["found"], "a gap of 2.125 s");
    let listed = warned(&label(&log), "sweep-gap");
    assert_eq!(listed.len(), 1);
    for sweep in &sweeps[4..6] {
        let token = sweep["token"].as_str().expect("a token");
        assert!(listed[0]["record"].as_str().is_some_and(|record| record.contains(token)));
    }
}

#[test]
fn fault_18_boxes_bridge_a_gap_of_max_gap_s_and_no_longer_one() {
    let log = TestLog::nano();
    let from_us = log.sweeps()[5]["timestamp"].as_i64().expect("a time");
    ["sample", "sample_data"].iter().for_each(|table| delay(&log, table, from_us, 2_000_000));
    let labels = |max_gap_s: &str| {
        let label = Label::new(&log.root(), &log.beside(max_gap_s)).small();
        let gap = format!("boxes.max_gap_s={max_gap_s}");
        label.with(&["--set", &gap, "--set", "boxes.extrapolate_s=0.0"]).run().exits(0);
        gts_files(&log.beside(max_gap_s))
    };
    let short = labels("1.6");
    assert!(short == labels("2.499") && short != labels("2.5"));
}

#[test]
fn fault_19_a_pose_jump_is_warned_of_and_listed_with_both_sweeps() {
    let log = TestLog::nano();
    let sweeps = log.sweeps();
    let from = sweeps[6]["timestamp"].as_i64();
    log.edit("ego_pose", |rows| {
        for row in rows.iter_mut().filter(|row| row["timestamp"].as_i64() >= from) {
            row["translation"][1] = json!(18.0);
        }
    });
    let found = check(&log).finds(3, "warning", &["pose-jump"]);
    let jump = found.one("pose-jump").to_string();
    assert!(jump.contains("160.1 m/s"), "20 m in 0.125 s: {jump}");
    let listed = warned(&label(&log), "pose-jump");
    assert_eq!(listed.len(), 1);
    for sweep in &sweeps[5..7] {
        assert!(listed[0].to_string().contains(sweep["token"].as_str().expect("a token")));
    }
}

/// A drive over the hill, coarse, in the nuScenes format.
fn hill(folder: &Path) {
    let settings = ["lidar.*.pattern.spinning.azimuths=60", "lidar.*.rate_hz=4.0"];
    let line = ["simulate", "--world", "hill", "--format", "nuscenes", "--output", text(folder)];
    let settings = settings.iter().flat_map(|setting| ["--set", *setting]);
    let line: Vec<&str> = line.into_iter().chain(["--images", "none"]).chain(settings).collect();
    occlabel(&line).exits(0);
}

/// Sets every ego pose's height to 0, and its roll and pitch too if told.
fn flatten(root: &Path, and_level: bool) {
    let table = root.join(VERSION).join("ego_pose.json");
    let version = || fs::read_dir(root).expect("a folder").flatten();
    let is_version = |name: &str| name.starts_with("v1.0-");
    let folder = version().find(|entry| entry.file_name().to_str().is_some_and(is_version));
    let table = folder.map_or(table, |folder| folder.path().join("ego_pose.json"));
    let bytes = fs::read(&table).expect("a table");
    let mut rows: Vec<Value> = serde_json::from_slice(&bytes).expect("rows");
    for row in &mut rows {
        row["translation"][2] = json!(0.0);
        if and_level {
            row["rotation"] = json!([1.0, 0.0, 0.0, 0.0]);
        }
    }
    fs::write(table, serde_json::to_vec(&rows).expect("JSON")).expect("written");
}

#[test]
fn fault_20_heights_of_zero_on_a_hill_are_told_with_the_grounds_thickness() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log");
    hill(&log);
    let found = checked("nuscenes", &log, &[]).finds(0, "warning", &[]);
    let thin = found.json["scenes"]["hill"]["ground_thickness_m"].as_f64().expect("a ground");
    assert!(thin < 0.15, "{thin}");
    flatten(&log, false);
    checked("nuscenes", &log, &[]).finds(3, "warning", &["boxes-empty", "level-world"]);
    let label = Label::new(&log, &folder.path().join("out")).small();
    assert_eq!(warned(&label, "level-world").len(), 1);
    flatten(&log, true);
    let found = checked("nuscenes", &log, &[]).finds(3, "warning", &["boxes-empty", "level-world"]);
    let told = found.one("level-world")["found"].as_str().expect("text").to_owned();
    assert!(told.contains("0 at all ") && told.ends_with(" m thick"), "{told}");
}

/// The beginning of a JPEG file of this size: its header, and no pixel.
fn jpeg_header(width: u16, height: u16) -> Vec<u8> {
    let [[w0, w1], [h0, h1]] = [width.to_be_bytes(), height.to_be_bytes()];
    let start = [0xff, 0xd8, 0xff, 0xe0, 0, 16, b'J', b'F', b'I', b'F', 0, 1, 1, 0, 0, 1, 0, 1];
    [&start[..], &[0, 0, 0xff, 0xc0, 0, 11, 8, h0, h1, w0, w1, 1, 1, 0x11, 0]].concat()
}

#[test]
fn fault_30_of_an_image_only_the_headers_size_counts() {
    let log = TestLog::nano();
    let rows = log.rows("sample_data");
    let image = rows.iter().find(|row| row["fileformat"] == "jpg").expect("an image");
    let file = log.file(image["filename"].as_str().expect("a name"));
    fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
    for (bytes, code, rules) in [
        (jpeg_header(1600, 900), 0, &[][..]),
        (jpeg_header(800, 450), 3, &["image-size"]),
        (jpeg_header(1600, 900)[..24].to_vec(), 3, &["image-header"]),
    ] {
        fs::write(&file, bytes).expect("written");
        let found = check(&log).finds(code, "warning", rules);
        assert_eq!(found.one("image-absent")["found"], "17 of 18 absent");
        label(&log).run().exits(0);
    }
}

#[test]
fn fault_31_chains_that_do_not_hold_are_refused() {
    type Bend = fn(&mut Value, &Value);
    let bends: [(&str, Bend, &[&str]); 3] = [
        ("dangling", |row, _| row["next"] = json!("nowhere"), &["dangling-token"]),
        ("broken", |row, other| row["prev"] = other["token"].clone(), &["chain-broken"; 2]),
        (
            "ring",
            |row, other| row["next"] = other["token"].clone(),
            &["chain-broken", "chain-ring"],
        ),
    ];
    for (name, bend, rules) in bends {
        let log = TestLog::nano();
        let sweeps = log.sweeps();
        edit_row(&log, "sample_data", &sweeps[4]["token"], |row| bend(row, &sweeps[1]));
        let found = check(&log);
        let errors = found.of("error");
        assert!(
            rules.iter().all(|rule| errors.iter().any(|error| error["rule"] == *rule)),
            "{name}"
        );
        found.ended.exits(1);
        label(&log).run().exits(1).tells(&["sample_data.json", "expected"]);
        label(&log).with(&["--on-error", "skip"]).run().exits(3);
    }
}

#[test]
fn fault_31_all_dangling_and_repeated_tokens_are_told_at_once() {
    let log = TestLog::nano();
    let poses = log.rows("ego_pose");
    log.edit("ego_pose", |rows| {
        rows.drain(1..4);
    });
    log.edit("instance", |rows| rows.push(rows[0].clone()));
    let found = check(&log);
    let errors = found.of("error");
    let rule = |rule: &str| errors.iter().filter(|error| error["rule"] == rule).count();
    let named = log.rows("sample_data");
    let is_dangling =
        |row: &&Value| poses[1..4].iter().any(|pose| pose["token"] == row["ego_pose_token"]);
    let dangling = named.iter().filter(is_dangling).count();
    assert!(dangling > 1);
    assert_eq!((rule("dangling-token"), rule("duplicate-token")), (dangling, 1), "{}", found.json);
    found.ended.exits(1);
    label(&log).run().exits(1);
}

#[test]
fn fault_35_a_pickle_in_place_of_labels_is_refused_unread() {
    let log = TestLog::nano();
    let sweep = log.sweeps()[0]["token"].clone();
    let row = json!({"token": "p", "sample_data_token": sweep, "filename": "panoptic/p.npz"});
    fs::write(log.root().join(VERSION).join("panoptic.json"), json!([row]).to_string())
        .expect("written");
    fs::create_dir_all(log.file("panoptic")).expect("a folder");
    fs::write(log.file("panoptic/p.npz"), b"\x80\x04cos\nsystem\n(S'true'\ntR.").expect("written");
    let found = check(&log).finds(1, "error", &["label-file"]);
    assert_eq!(found.one("label-file")["file"], "panoptic/p.npz");
    label(&log).run().exits(1).tells(&["panoptic/p.npz", "an npz with a 16-bit array"]);
}
