//! The reader of Argoverse 2 against recorded logs, and files bent from them.
#![cfg(feature = "av2")]

mod cameras;
mod flow;
mod packed;

use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};

use nalgebra::{Point3, Vector3};
use occlabel_core::{BoxGrowth, GrownBox, Scene, SweepHeader};
use occlabel_logs::{Argoverse2Log, ReadOptions, SceneSource};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use tempfile::TempDir;

const TAXONOMY: &str = include_str!("../../../../configs/taxonomies/argoverse2.toml");
const WHOLE: &str = "7fab2350-7eaf-3b7e-a39d-6937a4c1bede";
const UNCALIBRATED: &str = "adcf7d18-0510-35b0-a2fa-b4cea13a6d76";
const MOUNTINGS: &str = "calibration/egovehicle_SE3_sensor.feather";

fn data() -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or_else(beside, PathBuf::from);
    let root = data.join("argoverse2");
    if !root.is_dir() {
        println!("skipped: no argoverse2 in $OCCLABEL_DATA or ../shared/data");
    }
    root.is_dir().then_some(root)
}

fn options() -> ReadOptions {
    ReadOptions::of(toml::from_str(TAXONOMY).unwrap())
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to.parent().unwrap()).unwrap();
    fs::write(to, fs::read(from).unwrap()).unwrap();
}

/// A copy of a log, its mountings taken from the log that has them.
fn copied(data: &Path, name: &str) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    let (from, to) = (data.join("sensor/val").join(name), root.path().join(name));
    for file in ["city_SE3_egovehicle.feather", "annotations.feather"] {
        copy(&from.join(file), &to.join(file));
    }
    for entry in fs::read_dir(from.join("sensors/lidar")).unwrap() {
        let path = entry.unwrap().path();
        copy(&path, &to.join("sensors/lidar").join(path.file_name().unwrap()));
    }
    copy(&data.join("sensor/val").join(WHOLE).join(MOUNTINGS), &to.join(MOUNTINGS));
    root
}

/// Points in the boxes of a sweep's time, and boxes.
fn in_boxes(log: &Argoverse2Log, scene: &Scene, sweep: &SweepHeader) -> (usize, usize) {
    let cloud = log.read_sweep(sweep).unwrap().cloud;
    let exact = BoxGrowth { scale: 1.0, margin_m: 0.0 };
    let (mut points, mut boxes) = (0, 0);
    for track in &scene.tracks {
        for (_, boxed) in track.boxes.iter().filter(|(time, _)| *time == sweep.time) {
            let box_from_lidar = boxed.world_from_box.inverse() * sweep.world_from_lidar();
            let grown = GrownBox::new(&boxed.size_m, &exact);
            let inside = |p: &&Point3<f64>| grown.contains(&(box_from_lidar * **p));
            points += cloud.positions.iter().filter(inside).count();
            boxes += 1;
        }
    }
    (points, boxes)
}

#[test]
fn as_many_points_lie_in_boxes_as_the_makers_counted() {
    let Some(data) = data() else { return };
    let mut counts = Vec::new();
    for name in [WHOLE, UNCALIBRATED] {
        let root = copied(&data, name);
        let log = Argoverse2Log::open(root.path(), options()).unwrap();
        let scene = log.load(name).unwrap();
        assert!(scene.refused.is_empty());
        assert_eq!(scene.keyframes.len(), scene.sweeps.len());
        counts.extend(scene.sweeps.iter().map(|sweep| in_boxes(&log, &scene, sweep)));
    }
    assert_eq!(counts, [(9_399, 81), (9_289, 81), (17_972, 47)]);
}

#[test]
fn each_point_has_the_origin_of_its_own_lidar() {
    let Some(data) = data() else { return };
    let log = Argoverse2Log::open(
        &data,
        ReadOptions { scenes: Some([WHOLE.to_owned()].into()), ..options() },
    )
    .unwrap();
    let scene = log.load(WHOLE).unwrap();
    assert_eq!((scene.tracks.len(), scene.sweeps.len()), (114, 2));
    for (sweep, counts) in scene.sweeps.iter().zip([[51_785, 47_444], [51_807, 47_659]]) {
        let cloud = log.read_sweep(sweep).unwrap().cloud;
        let of = |origin: u32| cloud.origin_of.iter().filter(|&&of| of == origin).count();
        assert_eq!([of(0), of(1)], counts);
        let [up, down] = [0, 1].map(|at| cloud.origins[at]);
        assert!(up.coords.norm() < 1e-9, "the frame is the upper lidar's");
        let apart: Vector3<f64> = down - up;
        assert!((0.02..0.5).contains(&apart.norm()), "{apart}");
    }
}

#[test]
fn a_log_without_mountings_is_refused() {
    let Some(data) = data() else { return };
    let log = Argoverse2Log::open(&data, options()).unwrap();
    assert_eq!(log.scene_names(), [WHOLE, UNCALIBRATED]);
    let fault = log.load(UNCALIBRATED).unwrap_err();
    assert!(fault.rule == "missing-file" && fault.place.ends_with(MOUNTINGS), "{fault}");
}

#[test]
fn bent_files_are_read_or_refused() {
    let Some(data) = data() else { return };
    let root = copied(&data, WHOLE);
    let path = root.path().join(WHOLE).join(MOUNTINGS);
    let sound = fs::read(&path).unwrap();
    let log = Argoverse2Log::open(root.path(), options()).unwrap();
    let (read, refused) = (Cell::new(0), Cell::new(0));
    let mut runner =
        TestRunner::new(Config { failure_persistence: None, ..Config::with_cases(300) });
    let bent = (any::<usize>(), any::<u8>(), 0..8_u8);
    let outcome = runner.run(&bent, |(at, byte, kind)| {
        let (mut bytes, at) = (sound.clone(), at % sound.len());
        match kind {
            0 => bytes.truncate(at),
            _ => bytes[at] = byte,
        }
        fs::write(&path, bytes).unwrap();
        let sweep = fs::read(&path).map(|_| log.load(WHOLE));
        let count = if sweep.unwrap().is_ok() { &read } else { &refused };
        count.set(count.get() + 1);
        Ok(())
    });
    outcome.unwrap();
    assert!(read.get() > 20 && refused.get() > 20, "{read:?} {refused:?}");
}
