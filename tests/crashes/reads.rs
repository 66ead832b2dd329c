//! Disks that fail while a log is read: told, and never taken for a log that holds less.

use std::fs;
use std::path::Path;

use crate::failing::{MOST, TOLD, fail_by, is_told};
use crate::is_all;
use crate::line::{Line, OUT, log_of};
use crate::support::{SMALL, occlabel, report, text};

/// A format, the taxonomies of its world and of its labels, and how many operations are passed over.
const FORMATS: [(&str, [&str; 2], usize); 4] = [
    ("semantickitti", ["occ3d-nuscenes", "semantickitti"], 23),
    ("coda", ["occ3d-nuscenes", "coda"], 37),
    ("mcap", ["occ3d-waymo", "occ3d-waymo"], 19),
    ("waymo", ["occ3d-waymo", "occ3d-waymo"], 29),
];

/// A wall and a tree along a road, seen twice.
const WORLD: &str = r#"
name = "drive"
duration_s = 0.6
seed = 3
taxonomy = "TAXONOMY"
keyframe_hz = 2.0

[ground]
bands = [{ class = "flat.driveable_surface" }]

[ego]
trajectory.straight = { start = { x_m = 0.1, y_m = -1.61 }, speed_mps = 6.0 }

[[lidar]]
name = "LIDAR_TOP"
mounting.position_m = [0.9, 0.0, 1.84]
rate_hz = 10.0
max_range_m = 40.0
[lidar.pattern.spinning]
azimuths = 90
beams.even = { count = 8, min_rad = -0.42, max_rad = 0.15 }

[[static]]
class = "static.manmade"
pose = { position_m = [10.0, 9.0, 2.0] }
shape.box.size_m = [30.0, 1.0, 4.0]

[[static]]
class = "static.vegetation"
pose = { position_m = [12.0, -6.5, 2.0] }
shape.cylinder = { radius_m = 0.4, height_m = 4.0 }
"#;

/// The readers of the other formats, whose every look and every read fails.
#[test]
fn a_read_that_fails_is_told_whatever_the_format() {
    for (format, [world, labels], stride) in FORMATS {
        let log = log_of(1);
        let (input, file) = (log.beside(format), log.beside("world.toml"));
        fs::write(&file, WORLD.replace("TAXONOMY", world)).expect("a world");
        let line = ["simulate", "--world", text(&file), "--format", format, "--images", "none"];
        occlabel(&[&line[..], &["--output", text(&input)]].concat()).exits(0);
        let taxonomy = format!("taxonomy.file={labels}");
        let rules = ["--set", &taxonomy, "--set", "aggregate.ego_box_m=none"];
        let line = ["label", "--format", format, "--input", text(&input), "--output", OUT];
        let line = Line::new(&log, &[&line[..], &rules, &SMALL, &["--jobs", "1"]].concat(), None);
        assert_eq!(line.code, 0, "{format}");
        let failed =
            ["eio", "short"].map(|way| fail_by(&line, &log.beside("failing"), way, stride));
        println!("{failed:?} failures in {format}");
        assert!(failed.iter().all(|failed| *failed >= 2), "{failed:?} failures in {format}");
    }
}

/// What a failing disk costs with `--on-error skip` is told in the report, and costs nothing else.
#[test]
fn a_read_that_fails_costs_that_scene_only() {
    let log = log_of(2);
    let skip = ["--on-error", "skip", "--jobs", "1"];
    let line = Line::label(&log, &skip);
    let (output, stride) = (log.beside("failing"), if is_all() { 1 } else { 29 });
    let (mut failed, mut lost) = (0, 0);
    for at in (0..MOST).step_by(stride) {
        line.prepare(&output);
        let fault = format!("{at}:eio");
        let ended = line.run(&output, Some(&fault));
        if !ended.stderr.contains(TOLD) {
            break;
        }
        failed += 1;
        if ended.code == Some(3) {
            lost += 1;
            is_one_scene(&line, &output, &fault);
        } else {
            is_told(&line, &output, &fault, &ended);
            line.ends_as_undisturbed(&output, &fault);
        }
    }
    println!("{failed} failures, {lost} told as losses");
    assert!(failed >= 10 && lost >= 3, "{failed} failures, {lost} losses");
}

/// The files of scenes that the report does not name are those of an undisturbed run.
fn is_one_scene(line: &Line, output: &Path, fault: &str) {
    let report = report(output);
    let told = report["skipped_or_degraded"].as_array().expect("a list").iter();
    let named: Vec<&str> = told.filter_map(|loss| loss["scene"].as_str()).collect();
    assert!(!named.is_empty(), "{fault}: {report}");
    let is_of_others = |path: &&String| {
        path.ends_with(".npz") && !named.iter().any(|scene| path.contains(&format!("/{scene}/")))
    };
    let left = line.left(output);
    for path in line.expected.keys().filter(is_of_others) {
        assert!(left.get(path) == line.expected.get(path), "{fault}: {path}");
    }
    let is_known = |path: &String| line.expected.contains_key(path) || path.ends_with(".lock");
    assert!(left.keys().all(is_known), "{fault}: {:?}", left.keys());
}
