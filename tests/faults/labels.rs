//! Point labels and classes: unknown, too few, absent (cases 26 to 28; labels.md section 5).

use std::fs;

use serde_json::{Value, json};

use crate::asserts::{
    SKIP, arrays, assert_nothing_written, assert_refused, assert_skipped, field, keyframes_without,
    label, label_into, rename_category, untouched, warnings,
};
use crate::support::{SCENE, TestLog, gts_files, manifest, nano_spec, occlabel};

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

/// The labels of the middle keyframe's sweep.
fn label_file(log: &TestLog) -> String {
    let sweep = log.sweeps()[4]["token"].clone();
    let row = log.rows("lidarseg").into_iter().find(|row| row["sample_data_token"] == sweep);
    field(&row.expect("labels"), "filename")
}

#[test]
fn fault_26_an_unmapped_raw_label_is_refused_with_its_count() {
    let log = TestLog::nano();
    let file = label_file(&log);
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
    let file = label_file(&log);
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
