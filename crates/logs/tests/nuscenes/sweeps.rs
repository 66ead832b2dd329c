//! Points, their labels, and files that are not there.

use std::io::Cursor;

use nalgebra::Point3;
use ndarray::Array1;
use ndarray_npy::NpzWriter;
use occlabel_core::{Loss, PointLabel, Scene};
use occlabel_logs::{Inventory, PointColumns, SceneSource, SweepPoints};
use serde_json::json;

use crate::tiny_log::{CAR, ROAD, TinyLog, points, sweep_file};

/// What is read of sweep l0.
fn read(log: &TinyLog) -> Result<SweepPoints, String> {
    let open = log.open().unwrap();
    let scene = open.log.load("scene-0001").unwrap();
    open.log.read_sweep(&scene.sweeps[0]).map_err(|fault| fault.to_string())
}

/// A log whose sweep l0 has these bytes.
fn with_sweep(bytes: Vec<u8>) -> TinyLog {
    let mut log = TinyLog::new();
    log.files.insert(sweep_file("l0"), bytes);
    log
}

/// A log whose sweep l0 is labelled by this file.
fn with_labels(table: &'static str, file: &str, bytes: Vec<u8>) -> TinyLog {
    let mut log = TinyLog::new();
    let row = json!({"token": "label-0", "sample_data_token": "l0", "filename": file});
    log.tables.insert(table, vec![row]);
    log.files.insert(file.into(), bytes);
    log
}

fn npz(values: Vec<u16>) -> Vec<u8> {
    let mut writer = NpzWriter::new_compressed(Cursor::new(Vec::new()));
    writer.add_array("data", &Array1::from(values)).unwrap();
    writer.finish().unwrap().into_inner()
}

/// KITTI's four columns: x, y, z and a reflectance from 0 to 1.
fn kitti(points: usize) -> Vec<u8> {
    let column = |i: usize| [i as f32 * 0.37 - 3.1, 0.71 * i as f32, -1.3, 0.31];
    (0..points).flat_map(column).flat_map(f32::to_le_bytes).collect()
}

#[test]
fn section_2_points_are_delivered_as_logged_from_the_lidars_own_origin() {
    let sweep = read(&TinyLog::new()).unwrap();
    assert_eq!(sweep.cloud.positions, [[0.0, 1.0, 2.0], [-1.5, 0.0, 0.5]].map(Point3::from));
    assert_eq!(sweep.cloud.labels, [PointLabel::Unlabelled; 2]);
    assert_eq!(sweep.cloud.origin(1), Point3::origin());
    assert!(sweep.warnings.is_empty());
    let far = [[0.1, f32::INFINITY, 0.0], [0.0; 3], [1e30, 0.0, 0.0], [1.0; 3]];
    let cloud = read(&with_sweep(points(&far))).unwrap().cloud;
    assert_eq!((cloud.len(), cloud.positions[0].x), (4, f64::from(0.1_f32)), "nothing is dropped");
}

#[test]
fn fault_01_a_file_of_no_whole_number_of_points_is_refused_with_its_sizes() {
    let message = read(&with_sweep(vec![0; 41])).unwrap_err();
    assert_eq!(
        message,
        "sweeps/LIDAR_TOP/l0.pcd.bin (scene-0001, sweep l0): expected a multiple of 20 bytes \
         (5 columns), found 41 bytes, 1 more than 2 points"
    );
}

#[test]
fn fault_02_an_empty_file_is_an_empty_sweep_with_a_warning() {
    let sweep = read(&with_sweep(Vec::new())).unwrap();
    assert!(sweep.cloud.is_empty());
    assert_eq!(sweep.warnings[0].rule, "sweep-empty");
}

#[test]
fn fault_03_four_columns_are_told_and_read_only_when_asked_for() {
    for count in [4, 5, 35] {
        let mut log = with_sweep(kitti(count));
        let message = read(&log).unwrap_err();
        assert!(message.contains("looks like 4-column KITTI"), "{message}");
        assert!(message.contains("--columns 4"), "{message}");
        log.options = |options| options.columns = Some(PointColumns::Four);
        assert_eq!(read(&log).unwrap().cloud.len(), count);
    }
    let mut log = with_sweep(kitti(35));
    log.options = |options| options.columns = Some(PointColumns::Five);
    assert_eq!(read(&log).unwrap().cloud.len(), 28, "five columns are trusted if asked for");
    let many = points(&[[1.0, 2.0, 3.0]; 40]);
    assert_eq!(read(&with_sweep(many)).unwrap().cloud.len(), 40, "rings tell five columns");
}

#[test]
fn fault_04_absent_files_are_listed_at_once_with_what_they_would_weigh() {
    let mut log = with_labels("lidarseg", "lidarseg/l0.bin", vec![17, 24]);
    log.files.remove(&sweep_file("l1"));
    log.files.remove("lidarseg/l0.bin");
    let open = log.open().unwrap();
    let scene = open.log.load("scene-0001").unwrap();
    let inventory = Inventory::take(&open.log, open.root.path(), &scene);
    let missing = &inventory.missing;
    let told: Vec<_> =
        missing.iter().map(|file| (file.file.as_str(), file.sweep, file.is_reference)).collect();
    let l1 = sweep_file("l1");
    assert_eq!(told, [("lidarseg/l0.bin", 0, true), (l1.as_str(), 1, false)]);
    assert_eq!(inventory.missing_bytes(), 40, "no other file of labels tells a size");
    let fault = open.log.read_sweep(&scene.sweeps[1]).unwrap_err();
    assert_eq!(fault.rule, "missing-file");
}

#[test]
fn fault_05_an_absent_reference_sweep_is_told_as_such() {
    let mut log = TinyLog::new();
    log.files.remove(&sweep_file("l2"));
    let open = log.open().unwrap();
    let scene = open.log.load("scene-0001").unwrap();
    let inventory = Inventory::take(&open.log, open.root.path(), &scene);
    let missing = &inventory.missing;
    assert!(missing.len() == 1 && missing[0].is_reference && missing[0].sweep == 2);
    assert_eq!(scene.keyframes[1].sweep, 2);
}

#[test]
fn fault_06_points_without_numbers_are_delivered_and_many_are_warned_of() {
    let bad = [f32::NAN, 0.0, 0.0];
    let half = read(&with_sweep(points(&[bad, [1.0; 3]]))).unwrap();
    assert!(half.warnings.is_empty() && half.cloud.len() == 2);
    let more = read(&with_sweep(points(&[bad, [1.0; 3], [0.0, 0.0, f32::INFINITY]]))).unwrap();
    assert!(more.warnings[0].to_string().contains("2 of 3 points"), "{}", more.warnings[0]);
    assert!(more.cloud.positions[0].x.is_nan());
}

#[test]
fn section_2_raw_labels_become_classes_by_name() {
    let lidarseg = read(&with_labels("lidarseg", "lidarseg/l0.bin", vec![24, 0])).unwrap();
    assert_eq!(lidarseg.cloud.labels, [PointLabel::Class(ROAD), PointLabel::Ignored]);
    let panoptic = with_labels("panoptic", "panoptic/l0.npz", npz(vec![17_004, 24_000]));
    let labels = read(&panoptic).unwrap().cloud.labels;
    assert_eq!(labels, [PointLabel::Class(CAR), PointLabel::Class(ROAD)]);
}

#[test]
fn section_2_panoptic_labels_come_before_lidarseg() {
    let mut log = with_labels("lidarseg", "lidarseg/l0.bin", vec![24, 24]);
    let panoptic = with_labels("panoptic", "panoptic/l0.npz", npz(vec![17_004, 17_000]));
    log.tables.extend(panoptic.tables);
    log.tables.insert(
        "lidarseg",
        with_labels("lidarseg", "lidarseg/l0.bin", vec![]).tables["lidarseg"].clone(),
    );
    log.files.extend(panoptic.files);
    assert_eq!(read(&log).unwrap().cloud.labels, [PointLabel::Class(CAR); 2]);
}

#[test]
fn fault_26_an_unknown_raw_label_is_told_with_its_count_and_file() {
    let mut log = with_labels("lidarseg", "lidarseg/l0.bin", vec![90, 90]);
    let message = read(&log).unwrap_err();
    assert!(message.starts_with("lidarseg/l0.bin (scene-0001, sweep l0)"), "{message}");
    assert!(message.contains("90 (no category) of 2 points"), "{message}");
    log.options = |options| options.read.unknown_as = Some(ROAD);
    let sweep = read(&log).unwrap();
    assert_eq!(sweep.cloud.labels, [PointLabel::Class(ROAD); 2]);
    assert_eq!(sweep.warnings[0].rule, "unknown-label");
    assert_eq!(sweep.unknown.to_string(), "90 (no category) of 2 points");
}

#[test]
fn fault_26_a_category_that_the_taxonomy_does_not_name_is_told_where_points_have_it() {
    let mut log = with_labels("lidarseg", "lidarseg/l0.bin", vec![17, 30]);
    let row = json!({"token": "cat-x", "name": "static.other", "index": 30});
    log.tables.get_mut("category").unwrap().push(row);
    assert!(read(&log).unwrap_err().contains("30 (static.other) of 1 points"));
    log.files.insert("lidarseg/l0.bin".into(), vec![17, 17]);
    assert!(read(&log).is_ok(), "what no point has does no harm");
}

#[test]
fn fault_26_categories_without_an_index_are_refused_where_points_are_labelled() {
    let mut log = TinyLog::new();
    log.row("category", "cat-car").as_object_mut().unwrap().remove("index");
    assert!(log.load().is_ok());
    log.tables
        .extend([("lidarseg", with_labels("lidarseg", "x", vec![]).tables["lidarseg"].clone())]);
    let refusal = log.refusal();
    assert!(refusal.starts_with("category.json (cat-car, at byte"), "{refusal}");
    log.row("category", "cat-car")["index"] = json!(24);
    assert!(log.refusal().contains("an `index` of its own"));
}

#[test]
fn fault_27_another_number_of_labels_is_refused_with_both_numbers_sweep_and_scene() {
    let lidarseg = with_labels("lidarseg", "lidarseg/l0.bin", vec![17; 3]);
    assert_eq!(
        read(&lidarseg).unwrap_err(),
        "lidarseg/l0.bin (scene-0001, sweep l0): expected 2 labels for 2 points, found 3 labels"
    );
    let panoptic = with_labels("panoptic", "panoptic/l0.npz", npz(vec![17_000; 5]));
    assert!(read(&panoptic).unwrap_err().ends_with("2 labels for 2 points, found 5 labels"));
}

#[test]
fn fault_28_sweeps_without_a_label_file_are_unlabelled() {
    let open = with_labels("lidarseg", "lidarseg/l0.bin", vec![17, 24]).open().unwrap();
    let scene: Scene = open.log.load("scene-0001").unwrap();
    assert_eq!(scene.sweeps.iter().map(|s| s.labelled).collect::<Vec<_>>(), [true, false, false]);
    let unlabelled = open.log.read_sweep(&scene.sweeps[1]).unwrap();
    assert_eq!(unlabelled.cloud.labels, [PointLabel::Unlabelled; 2]);
}

#[test]
fn fault_34_a_label_file_that_is_no_npz_is_refused() {
    let log = with_labels("panoptic", "panoptic/l0.npz", b"PK\x03\x04 no zip".to_vec());
    let message = read(&log).unwrap_err();
    assert!(
        message.starts_with("panoptic/l0.npz (scene-0001, sweep l0): expected an npz"),
        "{message}"
    );
}

#[test]
fn fault_36_label_files_stay_below_the_root_too() {
    let log = with_labels("lidarseg", "../l0.bin", Vec::new());
    let refused: Vec<_> = log.scene().refused.into_iter().map(|refusal| refusal.loss).collect();
    assert_eq!(refused, [Loss::Sweep, Loss::Keyframe]);
}
