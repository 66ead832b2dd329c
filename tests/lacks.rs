//! Scenes that go without boxes, point labels, cameras, or all but one annotated time: each is
//! labelled all the same, and says what it lacks.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::{Ended, SMALL, TestLog, nano_spec, occlabel, report, text};
use tempfile::TempDir;

/// The rules of all that can be lacking.
const LACKS: [&str; 4] = ["no-labels", "no-boxes", "boxes-at-one-time", "no-cameras"];

/// Labels a log, and gives the rules of what it lacks.
fn lacks(format: &str, log: &Path, more: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let labels = folder.path().join("labels");
    label(format, log, &labels, more).exits(0);
    let report = report(&labels);
    assert!(report["total"]["voxels"]["occupied"].as_u64() > Some(10), "{report}");
    let rules = report["warnings"].as_array().expect("warnings").iter();
    let rules = rules.filter_map(|warning| warning["rule"].as_str().map(str::to_owned));
    let lacks: Vec<String> = rules.filter(|rule| LACKS.contains(&rule.as_str())).collect();
    assert_eq!(checked(format, log, more), lacks, "`check` tells the same");
    lacks
}

/// The remarks of `check` on what a log lacks.
fn checked(format: &str, log: &Path, more: &[&str]) -> Vec<String> {
    let line = ["check", "--json", "--format", format, "--input", text(log)];
    let rules = ["--set", "relabel.unknown_class=taxonomy"];
    let told = occlabel(&[&line[..], &rules, more].concat()).stdout;
    let told: Value = serde_json::from_str(&told).expect("one object");
    let findings = told["findings"].as_array().expect("findings").iter();
    let remarks = findings.filter(|finding| finding["severity"] == "remark");
    let rules = remarks.filter_map(|remark| remark["rule"].as_str().map(str::to_owned));
    rules.filter(|rule| LACKS.contains(&rule.as_str())).collect()
}

fn label(format: &str, log: &Path, labels: &Path, more: &[&str]) -> Ended {
    let line = ["label", "--format", format, "--input", text(log), "--output", text(labels)];
    let rules = ["--set", "relabel.unknown_class=taxonomy"];
    occlabel(&[&line[..], &SMALL, &rules, more].concat())
}

/// A log of the nuScenes format, lacking what was taken out of its tables.
fn nuscenes(edit: impl Fn(&TestLog)) -> Vec<String> {
    let log = TestLog::simulated(&nano_spec());
    edit(&log);
    lacks("nuscenes", &log.root(), &[])
}

fn no_boxes(log: &TestLog) {
    log.edit("sample_annotation", |rows| rows.clear());
    log.edit("instance", |rows| rows.clear());
}

fn no_cameras(log: &TestLog) {
    log.edit("sample_data", |rows| rows.retain(|row| row["fileformat"] == "pcd"));
}

fn no_labels(log: &TestLog) {
    log.edit("lidarseg", |rows| rows.clear());
}

/// Keeps the annotations of the first sample, each the only one of its instance.
fn one_annotated_time(log: &TestLog) {
    let sample = Value::from(log.keyframes()[0].clone());
    log.edit("sample_annotation", |rows| {
        rows.retain(|row| row["sample_token"] == sample);
        for row in rows {
            (row["prev"], row["next"]) = ("".into(), "".into());
        }
    });
    let kept = log.rows("sample_annotation");
    log.edit("instance", |rows| {
        rows.retain(|row| kept.iter().any(|box_row| box_row["instance_token"] == row["token"]));
        for row in rows {
            let own = kept.iter().find(|box_row| box_row["instance_token"] == row["token"]);
            let token = own.expect("an annotation")["token"].clone();
            row["nbr_annotations"] = 1.into();
            (row["first_annotation_token"], row["last_annotation_token"]) = (token.clone(), token);
        }
    });
}

#[test]
fn nuscenes_works_without_and_says_what_it_lacks() {
    assert!(nuscenes(|_| ()).is_empty());
    assert_eq!(nuscenes(no_labels), ["no-labels"]);
    assert_eq!(nuscenes(no_boxes), ["no-boxes"]);
    assert_eq!(nuscenes(no_cameras), ["no-cameras"]);
    assert_eq!(nuscenes(one_annotated_time), ["boxes-at-one-time"]);
    let bare = nuscenes(|log| [no_labels, no_boxes, no_cameras].iter().for_each(|take| take(log)));
    assert_eq!(bare, ["no-labels", "no-boxes", "no-cameras"]);
}

/// A street with a car and a camera.
const WORLD: &str = r#"
    name = "small"
    duration_s = 0.6
    seed = 1
    taxonomy = "occ3d-nuscenes"
    keyframe_hz = 5.0
    ground.bands = [{ class = "flat.driveable_surface" }]
    ego.trajectory.straight = { start = { x_m = 0.0, y_m = 0.0 }, speed_mps = 5.0 }
    [[lidar]]
    name = "LIDAR_TOP"
    mounting.position_m = [0.9, 0.0, 1.84]
    rate_hz = 10.0
    max_range_m = 50.0
    pattern.spinning = { azimuths = 360, beams.even = { count = 16, min_rad = -0.42, max_rad = 0.15 } }
    [[camera]]
    name = "CAM_FRONT"
    mounting = { position_m = [1.7, 0.0, 1.5] }
    width = 160
    height = 90
    rate_hz = 10.0
    model.pinhole.matrix = [[130.0, 0.0, 80.0], [0.0, 130.0, 45.0], [0.0, 0.0, 1.0]]
    [model.sedan]
    category = "vehicle.car"
    size_m = [4.6, 1.86, 1.44]
    lift_m = 0.04
    part = [{ shape.box.size_m = [4.56, 1.82, 1.4] }]
    [[mover]]
    name = "lead"
    model = "sedan"
    trajectory.straight = { start = { x_m = 12.0, y_m = -2.0 }, speed_mps = 5.0 }
    [[static]]
    class = "static.manmade"
    pose = { position_m = [10.0, 9.0, 2.0] }
    shape.box.size_m = [30.0, 1.0, 4.0]
"#;

/// That street, written in a format.
fn simulated(format: &str) -> (TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let (world, log) = (folder.path().join("small.toml"), folder.path().join("log"));
    fs::write(&world, WORLD).expect("a world");
    let line = ["simulate", "--world", text(&world), "--format", format, "--output", text(&log)];
    occlabel(&[&line[..], &["--images", "none"]].concat()).exits(0);
    (folder, log)
}

#[test]
fn mcap_works_without_and_says_what_it_lacks() {
    let (_folder, log) = simulated("mcap");
    let labels = "reader.mcap.label_field=none";
    let boxes = "reader.mcap.boxes=['/none']";
    let cameras = "reader.mcap.cameras={'/none' = 'none'}";
    assert!(lacks("mcap", &log, &[]).is_empty());
    assert_eq!(lacks("mcap", &log, &["--set", labels]), ["no-labels"]);
    assert_eq!(lacks("mcap", &log, &["--set", boxes]), ["no-boxes"]);
    assert_eq!(lacks("mcap", &log, &["--set", cameras]), ["no-cameras"]);
}

#[test]
fn semantickitti_never_has_boxes_and_cameras() {
    let (_folder, log) = simulated("semantickitti");
    assert_eq!(lacks("semantickitti", &log, &[]), ["no-boxes", "no-cameras"]);
    fs::remove_dir_all(log.join("sequences/00/labels")).expect("removed");
    let bare = ["no-labels", "no-boxes", "no-cameras"];
    assert_eq!(lacks("semantickitti", &log, &[]), bare);
}

/// Moving classes drop movers where nothing boxes them.
#[test]
fn a_moving_class_may_be_ignored_where_there_are_no_boxes() {
    let (folder, log) = simulated("semantickitti");
    let occupied = |more: &[&str]| {
        let labels = folder.path().join(format!("labels-{}", more.len()));
        label("semantickitti", &log, &labels, &[more, &["--evidence"]].concat()).exits(0);
        let arrays = support::read_arrays(&labels, "00", "0").labels;
        arrays.semantics.values().iter().filter(|class| **class == 1).count()
    };
    let taxonomy = occlabel(&["presets", "taxonomies/semantickitti"]).exits(0).stdout;
    let file = folder.path().join("still.toml");
    let ignored = taxonomy.replace("moving-car = \"car\"", "moving-car = \"ignore\"");
    assert_ne!(ignored, taxonomy);
    fs::write(&file, ignored).expect("a taxonomy");
    let (all, still) =
        (occupied(&[]), occupied(&["--set", &format!("taxonomy.file={}", text(&file))]));
    assert!(all > 5 && still == 0, "{all} voxels of a car that moves, {still} once ignored");
}

/// The fixture of v2: a component that is left out is what is lacking.
#[cfg(feature = "waymo-v2")]
#[test]
fn waymo_works_without_and_says_what_it_lacks() {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/logs/tests/waymo/fixtures/v2");
    let without = |components: &[&str]| {
        let log = tempfile::tempdir().expect("a folder");
        for component in fs::read_dir(&fixture).expect("components") {
            let component = component.expect("a component").path();
            let name = component.file_name().expect("a name").to_str().expect("UTF-8");
            if !components.contains(&name) {
                support::copy(&component, &log.path().join(name));
            }
        }
        lacks("waymo", log.path(), &[])
    };
    assert!(without(&[]).is_empty());
    assert_eq!(without(&["lidar_segmentation"]), ["no-labels"]);
    assert_eq!(without(&["lidar_box"]), ["no-boxes"]);
    assert_eq!(without(&["camera_calibration"]), ["no-cameras"]);
    assert_eq!(without(&["camera_image"]), ["no-cameras"]);
}

/// The recorded logs have neither point labels nor images.
#[cfg(feature = "av2")]
#[test]
fn argoverse_2_works_without_and_says_what_it_lacks() {
    const LOG: &str = "sensor/val/7fab2350-7eaf-3b7e-a39d-6937a4c1bede";
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or(beside, std::path::PathBuf::from);
    let from = data.join("argoverse2").join(LOG);
    if !from.is_dir() {
        return eprintln!("skipped: no argoverse2 in OCCLABEL_DATA or ../shared/data");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("drive");
    support::copy(&from, &log);
    assert_eq!(lacks("av2", &log, &[]), ["no-labels", "no-cameras"]);
    fs::remove_file(log.join("annotations.feather")).expect("removed");
    assert_eq!(lacks("av2", &log, &[]), ["no-labels", "no-boxes", "no-cameras"]);
    fs::remove_dir_all(log.join("calibration")).expect("removed");
    label("av2", &log, &folder.path().join("labels"), &[])
        .exits(1)
        .tells(&["calibration/egovehicle_SE3_sensor.feather", "found none"]);
}

/// A flag that the format would not read is no flag of it.
#[test]
fn flags_of_another_format_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, out) = (text(folder.path()), folder.path().join("labels"));
    for (format, flag, reads) in [
        ("waymo", &["--version", "v1.0-mini"][..], "nuscenes"),
        ("semantickitti", &["--quat-order", "wxyz"], "nuscenes"),
        ("av2", &["--columns", "4"], "nuscenes"),
        ("nuscenes", &["--time-source", "header"], "mcap"),
        ("semantickitti", &["--recover"], "mcap"),
        ("nuscenes", &["--set", "reader.mcap.ego_frame=hull"], "mcap"),
        ("waymo", &["--set", "reader . mcap.classes.7=CAR"], "mcap"),
    ] {
        for command in ["label", "inspect"] {
            let line = [&[command, "--format", format, "--input", log], flag].concat();
            let output = ["--output", text(&out)];
            let line = if command == "label" { [&line[..], &output].concat() } else { line };
            let expected = format!("`--format {reads}`");
            occlabel(&line).exits(2).tells(&[flag[0], &expected, &format!("`{format}`")]);
        }
    }
}

/// A packed log's points are known before they are unpacked: memory is refused in time.
#[test]
fn memory_is_counted_in_points_not_in_packed_bytes() {
    let (folder, log) = simulated("mcap");
    let plan = |more: &[&str]| label("mcap", &log, &folder.path().join("labels"), more);
    let told = plan(&["--dry-run"]).exits(0).stdout;
    let number = |after: &str| -> u64 {
        let rest = told.split(after).nth(1).expect("a number");
        rest.split(' ').find_map(|word| word.parse().ok()).expect("a number")
    };
    let (points, memory) = (number("at most "), number("rays, "));
    assert!(points > 20_000 && memory > 64 * points, "{told}");
    plan(&["--memory", "1MB"]).exits(1).tells(&["expected a scene that fits", "bytes needed"]);
}

/// Two scans of a round of points on the road, in KITTI-360's layout, and nothing else.
fn bare_kitti_360(root: &Path) {
    let put = |file: &str, bytes: &[u8]| {
        let path = root.join(file);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    };
    let points = (0..400).flat_map(|i| {
        let (azimuth, range_m) = (i as f32 * 0.1, 4.0 + i as f32 * 0.02);
        [range_m * libm::cosf(azimuth), range_m * libm::sinf(azimuth), -1.65, 0.5]
    });
    let points: Vec<u8> = points.flat_map(f32::to_le_bytes).collect();
    let velodyne = "data_3d_raw/drive/velodyne_points";
    put(&format!("{velodyne}/timestamps.txt"), b"2013-05-28 08:46:02.0\n2013-05-28 08:46:02.1\n");
    (0..2).for_each(|frame| put(&format!("{velodyne}/data/{frame:010}.bin"), &points));
    let poses = b"0 1 0 0 0 0 -1 0 0 0 0 -1 0\n1 1 0 0 1 0 -1 0 0 0 0 -1 0\n";
    put("data_poses/drive/poses.txt", poses);
    let camera = |number| format!("image_{number:02}: 0 0 1 0 1 0 0 0 0 1 0 -0.6\n");
    let cameras: String = (0..4).map(camera).collect();
    put("calibration/calib_cam_to_pose.txt", cameras.as_bytes());
    put("calibration/calib_cam_to_velo.txt", b"0 0 1 0 -1 0 0 0 0 -1 0 -0.2\n");
}

#[test]
fn kitti_360_works_without_and_says_what_it_lacks() {
    let log = tempfile::tempdir().expect("a folder");
    bare_kitti_360(log.path());
    assert_eq!(lacks("semantickitti", log.path(), &[]), ["no-labels", "no-boxes", "no-cameras"]);
}
