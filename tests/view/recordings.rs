//! Recordings of Foxglove's schemas.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use mcap::MessageStream;

use crate::outside::python;
use crate::street::street;
use crate::support::{SMALL, manifest, occlabel, text};

/// The times of messages by topic, nanoseconds.
fn times(file: &Path) -> BTreeMap<String, Vec<u64>> {
    let bytes = fs::read(file).expect("a recording");
    let mut times = BTreeMap::<String, Vec<u64>>::new();
    for message in MessageStream::new(&bytes).expect("a recording") {
        let message = message.expect("a message");
        times.entry(message.channel.topic.clone()).or_default().push(message.log_time);
    }
    times
}

#[test]
fn a_recording_says_what_the_labels_and_the_log_say() {
    let street = street();
    let (file, ended) = street.view("scene.mcap", &street.with_log());
    ended.exits(0);
    let tables = street.log.join("v1.0-sim");
    let args = [text(&file), text(&street.labels), text(&tables)];
    let Some(compared) = python("mcap_agrees.py", &args) else { return };
    let count = |what: &str| compared[what].as_u64().unwrap_or_default();
    assert_eq!([count("keyframes"), count("cells")], [3, 3 * 40 * 40 * 8]);
    assert_eq!([count("sweeps"), count("calibrations"), count("images"), count("boxes")], [3; 4]);
    let at_least = [("centres", 1000), ("track", 20), ("hits", 1000), ("labelled", 1000)];
    assert!(at_least.iter().all(|&(what, few)| count(what) >= few), "{compared}");
}

#[test]
fn a_recording_without_a_log_has_the_labels_and_their_places() {
    let street = street();
    let (file, ended) = street.view("labels.mcap", &[]);
    ended.exits(0);
    let topics: Vec<_> = times(&file).into_keys().collect();
    assert_eq!(topics, ["/occupancy/grid", "/occupancy/voxels", "/tf"]);
    let Some(compared) = python("mcap_agrees.py", &[text(&file), text(&street.labels)]) else {
        return;
    };
    assert_eq!(compared["keyframes"], 3);
}

#[test]
fn a_grid_in_the_lidars_frame_stands_at_the_lidar() {
    let street = street();
    let labels = street.beside("lidar-labels");
    let line = ["label", "--output", text(&labels), "--set", "grid.frame=lidar"];
    occlabel(&[&line[..], &street.with_log(), &SMALL].concat()).exits(0);
    let tables = street.log.join("v1.0-sim");
    for (name, log, more) in [
        ("lidar.mcap", &street.with_log()[..], Some(text(&tables))),
        ("lidar-bare.mcap", &[], None),
    ] {
        let file = street.beside(name);
        let line = ["view", text(&labels), "--output", text(&file)];
        occlabel(&[&line[..], log].concat()).exits(0);
        let args = [text(&file), text(&labels)].into_iter().chain(more);
        let Some(compared) = python("mcap_agrees.py", &args.collect::<Vec<_>>()) else { return };
        assert_eq!(compared["keyframes"], 3);
    }
}

#[test]
fn keyframes_without_times_stand_a_second_apart_and_nowhere() {
    let street = street();
    let [bare, file] = ["bare", "bare.mcap"].map(|name| street.beside(name));
    let line = ["convert", text(&street.labels), "--to", "surroundocc", "--output", text(&bare)];
    occlabel(&line).exits(0);
    let _ = fs::remove_file(bare.join("manifest.json"));
    let line = ["view", text(&bare), "--dialect", "surroundocc", "--output", text(&file)];
    occlabel(&line).exits(0).tells(&["nothing tells when", "1 s apart"]);
    let seconds = vec![0, 1_000_000_000, 2_000_000_000];
    let topics =
        ["/occupancy/grid", "/occupancy/voxels"].map(|topic| (topic.to_owned(), seconds.clone()));
    assert_eq!(times(&file), BTreeMap::from(topics));
}

#[test]
fn all_sweeps_are_those_of_the_scene_or_those_between_the_wanted_keyframes() {
    let street = street();
    let sweeps = |name: &str, args: &[&str]| {
        let (file, ended) = street.view(name, &[&street.with_log(), args].concat());
        ended.exits(0);
        let times = times(&file);
        (times["/LIDAR_TOP/points"].clone(), times["/occupancy/grid"].clone())
    };
    let (own, keyframes) = sweeps("own.mcap", &[]);
    assert_eq!(own, keyframes);
    let (all, _) = sweeps("all.mcap", &["--all-sweeps"]);
    assert!(all.len() > 2 * own.len(), "{} sweeps", all.len());
    let tokens = manifest(&street.labels)["scenes"]["street"]["poses"].clone();
    let wanted = [0, 1].map(|at| tokens[at]["token"].as_str().expect("a token")).join(",");
    let (between, two) = sweeps("two.mcap", &["--all-sweeps", "--keyframes", &wanted]);
    assert_eq!(two, keyframes[..2]);
    let expected: Vec<_> = all.into_iter().filter(|&time| time <= keyframes[1]).collect();
    assert_eq!(between, expected);
}

#[test]
fn the_same_labels_are_the_same_bytes() {
    let street = street();
    let [one, two] = ["one.mcap", "another.mcap"].map(|name| {
        let (file, ended) = street.view(name, &street.with_log());
        ended.exits(0);
        file
    });
    assert_eq!(fs::read(one).expect("a file"), fs::read(two).expect("a file"));
}

#[test]
fn a_recording_is_a_log_that_we_read() {
    let street = street();
    let folder = street.beside("as-log");
    fs::create_dir(&folder).expect("a folder");
    let (file, ended) = street.view("as-log/street.mcap", &street.with_log());
    ended.exits(0);
    let lidars = "reader.mcap.lidars={\"/LIDAR_TOP/points\"=\"LIDAR_TOP\"}";
    let line = ["inspect", "--format", "mcap", "--input", text(&folder), "--set", lidars];
    let inspected = occlabel(&line).exits(0).stdout;
    for part in
        ["LIDAR_TOP: 3 sweeps, 3 labelled", "CAM_FRONT: pinhole", "vehicle.car: 1 with 3 boxes"]
    {
        assert!(inspected.contains(part), "no `{part}` in:\n{inspected}");
    }
    let line = ["check", "--format", "mcap", "--input", text(&folder), "--set", lidars];
    occlabel(&line).exits(0);
    assert!(file.exists());
}

#[test]
fn sweeps_and_settings_of_no_log_are_refused() {
    let refused = |args: &[&str], told| street().view("x.mcap", args).1.exits(2).tells(&[told]);
    refused(&["--all-sweeps"], "--input");
    refused(&["--set", "boxes.max_gap_s=1.0"], "a log to be read by it");
}
