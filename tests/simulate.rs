//! The command `simulate`, and its log labelled by the program itself.

mod support;

use std::fs;

use support::{Label, SMALL, files_under, occlabel, text};

/// Few rays: these tests are not about points.
const COARSE: [&str; 4] = ["--set", "lidar.*.pattern.spinning.azimuths=60", "--images", "none"];

fn simulate<'a>(format: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let line = ["simulate", "--world", "street", "--format", format, "--output", output];
    line.iter().chain(&COARSE).chain(more).copied().collect()
}

#[test]
fn a_simulated_log_is_labelled_without_further_flags() {
    let folder = tempfile::tempdir().expect("a folder");
    let (log, labels) = (folder.path().join("log"), folder.path().join("labels"));
    let told = occlabel(&simulate("nuscenes", text(&log), &[])).exits(0).stdout;
    for part in ["keyframes  5\n", "labelled\n", "label it with  occlabel label"] {
        assert!(told.contains(part), "no {part:?} in\n{told}");
    }
    let world = fs::read_to_string(log.join("truth/world.toml")).expect("the world");
    assert!(world.contains("azimuths = 60"), "the world as resolved");
    Label::new(&log, &labels).small().run().exits(0);
    let written = files_under(&labels);
    let keyframe = |time: u64| format!("gts/street/street-{time}/labels.npz");
    assert!((0..5).all(|half_s| written.contains_key(&keyframe(half_s * 500_000_000))));
}

#[test]
fn every_scene_of_a_log_has_its_world() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log");
    occlabel(&simulate("nuscenes", text(&log), &["--scenes", "2", "--set", "seed=7"])).exits(0);
    let world = |name: &str| fs::read_to_string(log.join(format!("truth/{name}.toml")));
    let worlds = ["street-0001", "street-0002"].map(|name| world(name).expect("a world"));
    assert!(worlds[0].contains("seed = 7") && worlds[1].contains("seed = 8"));
    let listed = occlabel(&["inspect", "--format", "nuscenes", "--input", text(&log)]).exits(0);
    assert!(listed.stdout.contains("2 scenes"), "{}", listed.stdout);
}

#[test]
fn the_other_formats_stand_under_their_own_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let kitti = ("semantickitti", "sequences/00/poses.txt");
    let coda = ("coda", "poses/dense/street.txt");
    for (format, file) in [kitti, coda, ("mcap", "street.mcap"), ("waymo", "street.tfrecord")] {
        let log = folder.path().join(format);
        let told = occlabel(&simulate(format, text(&log), &[])).exits(0).stdout;
        let line = format!("label it with  occlabel label --format {format} --input ");
        assert!(told.contains(&line), "{told}");
        let files = files_under(&log);
        assert!(files.contains_key(file) && files.contains_key("truth/world.toml"), "{files:?}");
    }
}

#[test]
fn a_log_without_points_is_labelled_with_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    for format in ["semantickitti", "mcap"] {
        let [log, labels] = ["log", "labels"].map(|kind| folder.path().join(format).join(kind));
        let blind = ["--set", "lidar.*.max_range_m=0.1"];
        occlabel(&simulate(format, text(&log), &blind)).exits(0);
        let label = ["label", "--format", format, "--input", text(&log), "--output", text(&labels)];
        occlabel(&[&label[..], &SMALL].concat()).exits(0).tells(&["points that count", "none"]);
    }
}

#[test]
fn what_cannot_be_simulated_exits_with_2() {
    let folder = tempfile::tempdir().expect("a folder");
    let taken = folder.path().join("taken");
    fs::create_dir(&taken).and_then(|()| fs::write(taken.join("a.txt"), "")).expect("a file");
    let line = simulate("nuscenes", text(&taken), &[]);
    occlabel(&line).exits(2).tells(&["taken", "an empty folder", "`a.txt`"]);
    let out = folder.path().join("out");
    let refused =
        |more: &[&str], format: &str| occlabel(&simulate(format, text(&out), more)).exits(2);
    refused(&["--set", "sead=7"], "nuscenes").tells(&["street.toml", "sead"]);
    refused(&["--set", "lidar.REAR.rate_hz=5.0"], "nuscenes").tells(&["lidar", "REAR"]);
    refused(&["--scenes", "2"], "mcap").tells(&["--scenes", "nuscenes"]);
    #[cfg(not(feature = "waymo-v2"))]
    refused(&[], "waymo-v2").tells(&["the cargo feature `waymo-v2`"]);
    let nowhere = ["simulate", "--world", "nowhere", "--format", "mcap", "--output", text(&out)];
    occlabel(&nowhere).exits(2).tells(&["nowhere", "street, crossing"]);
    assert!(!out.exists());
    let matrix = "[[250.0, 0.0, 240.0], [0.0, 250.0, 135.0], [0.0, 0.0, 1.0]]";
    let lens = format!("{{ matrix = {matrix}, distortion = [0.0, 0.0, 0.0, 0.0] }}");
    let model = format!("camera.CAM_BACK.model={{ kannala-brandt = {lens} }}");
    let fisheye = ["--set", &model];
    refused(&fisheye, "waymo").tells(&["camera.CAM_BACK.model", "kannala-brandt"]);
    assert!(!out.exists(), "no folder without a log");
    fs::create_dir(&out).expect("a folder");
    refused(&fisheye, "waymo");
    assert!(out.is_dir() && files_under(&out).is_empty(), "a folder that was there stays");
}
