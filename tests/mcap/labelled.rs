//! Logs described, and labelled by what is in them.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use crate::drive::Drive;
use crate::support::{Ended, gts_files, manifest, occlabel, read_arrays, report, text};

/// The log's own folder: one file of the data beside the project; `None`, with a word, if it is not
/// there.
fn recorded(name: &str) -> Option<TempDir> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or_else(beside, PathBuf::from);
    let file = data.join("mcap").join(name);
    if !file.is_file() {
        println!("skipped: no mcap/{name} in $OCCLABEL_DATA or ../shared/data");
        return None;
    }
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(&file, folder.path().join(name)).expect("a copy");
    Some(folder)
}

fn inspect(log: &Path, args: &[&str]) -> Ended {
    occlabel(&[&["inspect", "--format", "mcap", "--input", text(log)][..], args].concat())
}

/// The table that `inspect` prints.
fn table(printed: &str) -> String {
    let lines = printed.lines().skip_while(|line| *line != "[reader.mcap]");
    let is_table = |line: &&str| line.starts_with('[') || line.contains(" = ");
    lines.take_while(is_table).map(|line| format!("{line}\n")).collect()
}

/// All that is said of reading, without an `"auto"` in it or anywhere else.
fn reader_table(output: &Path) -> Value {
    let manifest = manifest(output);
    assert!(!manifest.to_string().contains("\"auto\""), "{manifest}");
    manifest["config"]["reader"]["mcap"].clone()
}

#[test]
fn a_drive_gets_the_arrays_that_it_gets_as_nuscenes() {
    let drive = Drive::new();
    let (mcap, nuscenes) = (drive.simulate("mcap"), drive.simulate("nuscenes"));
    let no_body = ["--set", "aggregate.ego_box_m=none"];
    drive.label("mcap", &mcap, "a", &no_body).exits(0);
    drive.label("nuscenes", &nuscenes, "b", &no_body).exits(0);
    let mut occupied = 0;
    for time in [0_u64, 500_000_000, 1_000_000_000] {
        let a = read_arrays(&drive.path("a"), "street", &time.to_string());
        let b = read_arrays(&drive.path("b"), "street", &format!("street-{time}"));
        assert_eq!(a.labels.semantics.values(), b.labels.semantics.values());
        assert_eq!(a.labels.mask_lidar.values(), b.labels.mask_lidar.values());
        assert_eq!(a.labels.mask_camera.values(), b.labels.mask_camera.values());
        occupied += a.labels.semantics.values().iter().filter(|&&class| class != 17).count();
    }
    assert!(occupied > 300, "{occupied}");
}

#[test]
fn the_printed_table_says_all_and_can_be_given_back() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    let printed = inspect(&log, &[]).exits(0).stdout;
    let own = table(&printed);
    for line in [
        "world_frame = \"map\"",
        "ego_frame = \"base_link\"",
        "label_field = \"label\"",
        "boxes = [\"/annotations\"]",
        "\"/LIDAR_TOP/points\" = \"LIDAR_TOP\"",
        "\"/CAM_FRONT/calibration\" = \"CAM_FRONT\"",
        "\"vehicle.car\" = \"vehicle.car\"",
        "= \"flat.driveable_surface\"",
    ] {
        assert!(own.contains(line), "no {line} in\n{own}");
    }
    let file = drive.path("own.toml");
    fs::write(&file, &own).expect("written");
    assert_eq!(inspect(&log, &["--config", text(&file)]).exits(0).stdout, printed);
    drive.label("mcap", &log, "a", &[]).exits(0);
    drive.label("mcap", &log, "b", &["--config", text(&file)]).exits(0);
    assert_eq!(gts_files(&drive.path("a")), gts_files(&drive.path("b")));
    let [a, b] = ["a", "b"].map(|output| reader_table(&drive.path(output)));
    assert_eq!(a["ego_frame"], "base_link");
    assert_eq!((&a["world_frame"], &a["label_field"]), (&b["world_frame"], &b["label_field"]));
}

#[test]
fn tables_of_other_formats_are_refused_and_stand_in_no_manifest() {
    let drive = Drive::new();
    let log = drive.simulate("nuscenes");
    let ended = drive.label("nuscenes", &log, "a", &["--set", "reader.mcap.time_unit_s=1e-6"]);
    ended.exits(2).tells(&["reader.mcap", "`--format mcap`"]);
    drive.label("nuscenes", &log, "b", &[]).exits(0);
    assert!(reader_table(&drive.path("b")).is_null());
}

#[test]
fn what_the_topics_lack_is_told() {
    let drive = Drive::new();
    let log = drive.simulate("mcap");
    let none = ["--set", "reader.mcap.boxes=[\"/none\"]", "--set", "reader.mcap.label_field=none"];
    let no_camera = ["--set", "reader.mcap.cameras={\"/none\" = \"x\"}"];
    let ended = drive.label("mcap", &log, "a", &[&none[..], &no_camera].concat()).exits(0);
    let ended = ended.tells(&["point labels", "found none"]).tells(&["boxes", "found none"]);
    ended.tells(&["calibrations of a camera", "found none"]);
    let rules: Vec<Value> =
        report(&drive.path("a"))["warnings"].as_array().expect("a list").clone();
    for rule in ["no-labels", "no-boxes", "camera-absent"] {
        assert!(rules.iter().any(|warning| warning["rule"] == rule), "no {rule} in {rules:?}");
    }
}

#[test]
fn a_recorded_ros_2_log_without_labels_and_boxes_is_labelled() {
    let Some(log) = recorded("kitti0002_ros2.mcap") else { return };
    let drive = Drive::new();
    let ended = drive.label("mcap", log.path(), "a", &[]).exits(0);
    ended.tells(&["point labels", "found none"]).tells(&["boxes", "found none"]);
    assert_eq!(gts_files(&drive.path("a")).len(), 16);
    assert_eq!(reader_table(&drive.path("a"))["world_frame"], "map");
}

#[test]
fn a_recorded_foxglove_log_asks_for_its_taxonomy_and_is_labelled_by_it() {
    let Some(log) = recorded("av2_foxglove.mcap") else { return };
    let drive = Drive::new();
    let ended = drive.label("mcap", log.path(), "a", &[]).exits(1);
    ended.tells(&["`REGULAR_VEHICLE` of 538 boxes", "reader.mcap.categories", "taxonomy"]);
    inspect(log.path(), &[]).exits(1).tells(&["`REGULAR_VEHICLE`"]);
    let own = ["--set", "reader.mcap.taxonomy=argoverse2"];
    drive.label("mcap", log.path(), "b", &own).exits(0).tells_nothing_of("no-boxes");
    let tracks = &manifest(&drive.path("b"))["scenes"]["av2_foxglove"]["tracks"];
    assert_eq!(tracks.as_array().expect("a list").len(), 85);
}
