//! Class masks of images give the points of any log their classes.

mod support;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{Ended, SMALL, files_under, gts_files, occlabel, report, text, tree_hash};

/// A street with a parked and a passing car, seen by two small cameras.
const WORLD: &str = r#"
name = "painted"
duration_s = 1.05
seed = 1
taxonomy = "occ3d-nuscenes"
keyframe_hz = 2.0

[ground]
bands = [
    { until_y_m = -5.61, class = "flat.sidewalk", raise_m = 0.12 },
    { until_y_m = 5.61, class = "flat.driveable_surface" },
    { class = "flat.terrain", raise_m = 0.12 },
]

[ego]
trajectory.straight = { start = { x_m = 0.1, y_m = -1.61 }, speed_mps = 6.0 }
heave_m = { mean = 0.07 }

[[lidar]]
name = "LIDAR_TOP"
mounting.position_m = [0.9, 0.0, 1.84]
pattern.spinning = { beams.even = { count = 16, min_rad = -0.42, max_rad = 0.15 }, azimuths = 360 }
rate_hz = 10.0
max_range_m = 50.0

[[camera]]
name = "CAM_FRONT"
mounting.position_m = [1.5, 0.0, 1.5]
model.pinhole.matrix = [[160.0, 0.0, 160.0], [0.0, 160.0, 90.0], [0.0, 0.0, 1.0]]
width = 320
height = 180
rate_hz = 10.0
offset_s = 0.02

[[camera]]
name = "CAM_LEFT"
mounting = { position_m = [1.2, 0.5, 1.5], yaw_rad = 1.4 }
model.pinhole.matrix = [[160.0, 0.0, 160.0], [0.0, 160.0, 90.0], [0.0, 0.0, 1.0]]
width = 320
height = 180
rate_hz = 10.0
offset_s = 0.03

[[static]]
class = "static.manmade"
pose.position_m = [10.0, 9.03, 2.0]
shape.box.size_m = [30.0, 1.0, 4.0]

[[static]]
class = "static.vegetation"
pose.position_m = [12.0, -6.53, 2.0]
shape.cylinder = { radius_m = 0.4, height_m = 4.0 }

[[mover]]
name = "parked"
category = "vehicle.car"
size_m = [4.4, 1.8, 1.5]
lift_m = 0.02
trajectory.straight = { start = { x_m = 11.0, y_m = -4.3 }, speed_mps = 0.0 }

[[mover]]
name = "passing"
category = "vehicle.car"
size_m = [4.4, 1.8, 1.5]
lift_m = 0.02
trajectory.straight = { start = { x_m = 2.0, y_m = 3.1 }, speed_mps = 9.0 }
"#;

/// The small world's masks are painted with a return hiding less of the few pixels there are.
const PAINT: [&str; 4] = ["--set", "paint.masks=masks", "--set", "paint.splat_px=3"];

fn simulated(folder: &Path, format: &str, sets: &[&str]) -> PathBuf {
    let (world, log) = (folder.join("world.toml"), folder.join(format));
    fs::write(&world, WORLD).expect("a world");
    let line = ["simulate", "--world", text(&world), "--format", format, "--output", text(&log)];
    occlabel(&[&line[..], &["--images", "all", "--masks"], sets].concat()).exits(0);
    log
}

fn label(log: &Path, format: &str, output: &Path, more: &[&str]) -> Ended {
    let line = ["label", "--format", format, "--input", text(log), "--output", text(output)];
    let rules = ["--set", "taxonomy.file=occ3d-nuscenes", "--set", "aggregate.ego_box_m=none"];
    occlabel(&[&line[..], &rules, &SMALL, more].concat())
}

/// A log without point labels, and where its labels may go.
fn unlabelled() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let log = simulated(folder.path(), "nuscenes", &["--set", "annotator.point_labels=none"]);
    let labels = folder.path().join("labels");
    (folder, log, labels)
}

fn first_mask(log: &Path) -> PathBuf {
    let masks = log.join("masks");
    let is_mask = |name: &String| name.ends_with(".png") && !name.contains(".instances");
    masks.join(files_under(&masks).into_keys().find(is_mask).expect("a mask"))
}

#[test]
fn section_5_painted_points_have_the_class_of_their_label() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = simulated(folder.path(), "nuscenes", &["--set", "annotator.point_labels=all"]);
    let line = ["quality", "--painted", "--json", "--format", "nuscenes", "--input", text(&log)];
    let ended = occlabel(&[&line[..], &PAINT].concat()).exits(0);
    let told: Value = serde_json::from_str(&ended.stdout).expect("JSON");
    let all = &told["total"][0];
    let share = |name: &str| all[name].as_f64().expect("a share");
    assert!(share("accuracy") >= 0.98, "{all}");
    assert!(all["points"].as_u64().expect("a count") > 10_000 && share("painted") > 0.25, "{all}");
}

#[test]
fn section_5_every_format_that_carries_cameras_is_painted_alike() {
    let folder = tempfile::tempdir().expect("a folder");
    let unlabelled = ["--set", "annotator.point_labels=none"];
    let trees = ["nuscenes", "mcap"].map(|format| {
        let log = simulated(folder.path(), format, &unlabelled);
        let output = folder.path().join(format!("{format}-labels"));
        label(&log, format, &output, &[&PAINT[..], &["--evidence"]].concat()).exits(0);
        let counts = &report(&output)["scenes"]["painted"]["class_from"];
        assert!(counts["masks"].as_u64() > Some(5_000) && counts["labels"] == 0, "{counts}");
        gts_files(&output)
    });
    let arrays = trees.map(|tree| tree.into_values().collect::<Vec<_>>());
    assert_eq!(arrays[0].len(), 6);
    assert!(arrays[0] == arrays[1], "the same arrays by both formats");
}

#[test]
fn section_5_instances_of_masks_come_after_the_tracks() {
    let folder = tempfile::tempdir().expect("a folder");
    let sets = ["--set", "annotator.point_labels=none", "--set", "annotator.unlabelled_movers=1.0"];
    let log = simulated(folder.path(), "nuscenes", &sets);
    let output = folder.path().join("labels");
    label(&log, "nuscenes", &output, &[&PAINT[..], &["--evidence"]].concat()).exits(0);
    let arrays = support::read_arrays(&output, "painted", "painted-500000000");
    let (instances, semantics) = (&arrays.evidence.instances, &arrays.labels.semantics);
    let pairs = instances.values().iter().zip(semantics.values());
    let seen: std::collections::BTreeSet<_> = pairs.filter(|(id, _)| **id > 0).collect();
    // Without boxes, ids are the movers' own: the parked car is 1, the passing one 2; 4 is a car.
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), [(&1, &4), (&2, &4)]);
}

#[test]
fn fault_26_a_mask_of_an_unknown_class_is_refused_with_its_pixels() {
    let (_folder, log, labels) = unlabelled();
    let table = log.join("table.toml");
    fs::write(&table, "16 = \"vegetation\"\n255 = \"none\"\n").expect("a table");
    let classes = format!("paint.classes={}", text(&table));
    let more = [&PAINT[..], &["--set", &classes]].concat();
    label(&log, "nuscenes", &labels, &more).exits(1).tells(&["11 of", "pixels", "--unknown-as"]);
    let taken = [&more[..], &["--unknown-as", "others", "--resume", "never"]].concat();
    label(&log, "nuscenes", &labels, &taken).exits(0);
}

#[test]
fn fault_30_a_mask_that_paints_has_to_be_whole() {
    let (_folder, log, labels) = unlabelled();
    let mask = first_mask(&log);
    let bytes = fs::read(&mask).expect("a mask");
    fs::write(&mask, &bytes[..bytes.len() / 2]).expect("half a mask");
    let name = mask.file_name().and_then(|name| name.to_str()).expect("a name");
    label(&log, "nuscenes", &labels, &PAINT).exits(1).tells(&[name, "320 x 180"]);
    let skipped = [&PAINT[..], &["--on-error", "skip"]].concat();
    label(&log, "nuscenes", &labels, &skipped).exits(3).tells(&[name]);
}

#[test]
fn fault_40_other_masks_are_another_input() {
    let (_folder, log, labels) = unlabelled();
    label(&log, "nuscenes", &labels, &PAINT).exits(0);
    let tree = tree_hash(&labels);
    label(&log, "nuscenes", &labels, &PAINT).exits(0);
    assert_eq!(tree, tree_hash(&labels));
    let mask = first_mask(&log);
    let mut bytes = fs::read(&mask).expect("a mask");
    bytes.push(0);
    fs::write(&mask, bytes).expect("a longer mask");
    label(&log, "nuscenes", &labels, &PAINT).exits(2).tells(&["inputs"]);
}

#[test]
fn section_14_masks_that_are_not_there_are_told() {
    let (folder, log, labels) = unlabelled();
    let absent = ["--set", "paint.masks=elsewhere"];
    label(&log, "nuscenes", &labels, &absent).exits(2).tells(&["elsewhere", "folder of masks"]);
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).expect("a folder");
    let masks = format!("paint.masks={}", text(&empty));
    label(&log, "nuscenes", &labels, &["--set", &masks]).exits(0).tells(&["nothing is painted"]);
}
