//! v2: the same drive as components gives the same scene.

use std::fs;
use std::path::Path;

use occlabel_core::{Fault, Scene};
use occlabel_logs::{Inventory, SceneSource, WaymoLog};
use proptest::prelude::*;
use tempfile::TempDir;

use crate::log::{SEGMENT, fixtures, options};
use crate::mutations::runner;
use crate::points::{LABELLED, POINTS, compare};

const COMPONENTS: [&str; 8] = [
    "camera_calibration",
    "camera_image",
    "lidar",
    "lidar_box",
    "lidar_calibration",
    "lidar_pose",
    "lidar_segmentation",
    "vehicle_pose",
];

fn open(root: &Path) -> Result<WaymoLog, Fault> {
    WaymoLog::open(root, options())
}

/// A copy of the components but some.
fn copy_without(absent: &[&str]) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    for component in COMPONENTS.iter().filter(|component| !absent.contains(component)) {
        fs::create_dir(root.path().join(component)).unwrap();
        let file = format!("{component}/{SEGMENT}.parquet");
        fs::copy(fixtures().join("v2").join(&file), root.path().join(&file)).unwrap();
    }
    root
}

fn load_without(absent: &[&str]) -> Result<Scene, Fault> {
    open(copy_without(absent).path())?.load(SEGMENT)
}

#[test]
fn v2_range_images_decode_to_their_writers_points() {
    let found = compare(&open(&fixtures().join("v2")).unwrap());
    assert!(found.off_m < 1e-5, "{} m", found.off_m);
    assert_eq!((found.points, found.labelled), (POINTS, LABELLED));
}

#[test]
fn v1_and_v2_of_a_drive_give_the_same_scene_and_the_same_points() {
    let logs = ["v1", "v2"].map(|version| open(&fixtures().join(version)).unwrap());
    assert_eq!(logs[0].defaults(), logs[1].defaults());
    let mut scenes = logs.each_ref().map(|log| log.load(SEGMENT).unwrap());
    let mut points = 0;
    for (first, second) in scenes[0].sweeps.iter().zip(&scenes[1].sweeps) {
        let clouds = [logs[0].read_sweep(first), logs[1].read_sweep(second)];
        let [first, second] = clouds.map(|points| points.unwrap().cloud);
        assert_eq!(first, second);
        points += first.len();
    }
    assert_eq!(points, POINTS);
    for scene in &mut scenes {
        scene.sweeps.iter_mut().for_each(|sweep| sweep.file.clear());
    }
    assert_eq!(format!("{:?}", scenes[0]), format!("{:?}", scenes[1]), "but for the files");
}

#[test]
fn a_sweep_names_its_files_and_a_log_its_tables() {
    let root = fixtures().join("v2");
    let log = open(&root).unwrap();
    assert_eq!(log.tables().len(), 4);
    let scene = log.load(SEGMENT).unwrap();
    let inventory = Inventory::take(&log, &root, &scene);
    let files: Vec<&str> = inventory.present.iter().map(|(file, _)| file.as_str()).collect();
    let expected = ["lidar", "lidar_pose", "lidar_segmentation"];
    assert_eq!(files, expected.map(|component| format!("{component}/{SEGMENT}.parquet")));
    assert!(inventory.missing.is_empty());
}

#[test]
fn a_scene_does_without_boxes_labels_and_cameras_and_says_so() {
    let scene = load_without(&["lidar_box", "lidar_segmentation", "camera_image"]).unwrap();
    assert!(scene.tracks.is_empty() && scene.cameras.is_empty() && !scene.has_point_labels());
    assert_eq!((scene.keyframes.len(), scene.sweeps.len()), (3, 15));
    let absent = scene.warnings.iter().filter(|fault| fault.rule == "component-absent").count();
    assert_eq!(absent, 3);
}

#[test]
fn a_scene_does_not_do_without_points_or_where_they_were_seen_from() {
    for component in ["lidar", "lidar_calibration"] {
        let fault = load_without(&[component]).unwrap_err();
        assert_eq!(
            (fault.rule, fault.place),
            ("missing-file", format!("{component}/{SEGMENT}.parquet"))
        );
    }
    let root = copy_without(&["lidar_pose"]);
    let log = open(root.path()).unwrap();
    let scene = log.load(SEGMENT).unwrap();
    assert_eq!(Inventory::take(&log, root.path(), &scene).missing.len(), 1);
    assert_eq!(log.read_sweep(&scene.sweeps[4]).unwrap_err().rule, "missing-file");
}

#[test]
fn rows_of_another_segment_are_refused() {
    let root = copy_without(&[]);
    for component in COMPONENTS {
        let folder = root.path().join(component);
        let file = folder.join(format!("{SEGMENT}.parquet"));
        fs::rename(file, folder.join("other.parquet")).unwrap();
    }
    let fault = open(root.path()).unwrap_err();
    assert_eq!((fault.rule, fault.found), ("segment-name", format!("`{SEGMENT}`")));
}

#[test]
fn both_versions_in_one_folder_are_one_too_many() {
    let root = copy_without(&[]);
    fs::copy(fixtures().join("v1/drive.tfrecord"), root.path().join("drive.tfrecord")).unwrap();
    assert_eq!(open(root.path()).unwrap_err().found, "both");
}

/// Damaged logs to read.
const CASES: u32 = 120;

/// Reads all that can be read: how many sweeps.
fn sweeps_read(root: &Path) -> usize {
    let Ok(log) = open(root) else { return 0 };
    let Ok(scene) = log.load(SEGMENT) else { return 0 };
    scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count()
}

#[test]
fn a_damaged_component_is_refused_or_read_but_never_a_panic() {
    let mut runner = runner(CASES);
    let damage = prop::collection::vec((0.0..1.0, any::<u8>()), 1..4);
    let counts = std::cell::RefCell::new([0; 3]);
    let root = copy_without(&[]);
    let run =
        runner.run(&(prop::sample::select(&COMPONENTS[..]), damage), |(component, damage)| {
            let file = root.path().join(component).join(format!("{SEGMENT}.parquet"));
            let whole = fs::read(&file).unwrap();
            let mut bytes = whole.clone();
            for (share, byte) in damage {
                bytes[(share * whole.len() as f64) as usize] = byte;
            }
            fs::write(&file, bytes).unwrap();
            let read = sweeps_read(root.path());
            fs::write(&file, whole).unwrap();
            counts.borrow_mut()[usize::from(read > 0) + usize::from(read == 15)] += 1;
            Ok(())
        });
    run.unwrap();
    let counts = counts.into_inner();
    assert!(
        counts.iter().sum::<usize>() == CASES as usize && counts.iter().all(|n| *n > 5),
        "{counts:?}"
    );
}
