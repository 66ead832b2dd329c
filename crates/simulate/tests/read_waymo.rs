//! A tiny drive, written as a Waymo log and read again: points, boxes, cameras and labels are those
//! of the drive.

use std::path::Path;

use nalgebra::Point3;
use occlabel_core::{PointCloud, PointLabel, Scene, SweepHeader, Taxonomy};
use occlabel_logs::{ReadOptions, SceneSource, WaymoLog};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, Output, World, world_text_with, write_waymo};
use tempfile::TempDir;

const TINY: &str = include_str!("tiny.toml");

/// Another lidar in the place of the rosette, tilted, whose name the format does not know.
const SECOND: [&str; 4] = [
    "lidar.ROSETTE.pattern={ spinning = { beams.elevations-rad = [0.2, -0.4, 0.0], azimuths = 77 } }",
    "lidar.ROSETTE.mounting={ position_m = [3.0, 0.4, 2.0], yaw_rad = 0.7, pitch_rad = 0.1, roll_rad = -0.05 }",
    "lidar.ROSETTE.rolling=false",
    "taxonomy=occ3d-waymo",
];

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-waymo").unwrap(), "occ3d-waymo").unwrap()
}

fn drive(settings: &[&str]) -> Drive {
    let settings: Vec<String> =
        SECOND.iter().chain(settings).map(|setting| setting.to_string()).collect();
    let text = world_text_with(TINY, &settings).unwrap();
    Drive::new(World::parse(&text, "tiny.toml").unwrap(), &taxonomy()).unwrap()
}

fn open(root: &Path) -> (WaymoLog, Scene) {
    let log = WaymoLog::open(root, ReadOptions::of(taxonomy())).unwrap();
    let scene = log.load("tiny").unwrap();
    assert!(scene.warnings.is_empty() && scene.refused.is_empty(), "{:?}", scene.warnings);
    (log, scene)
}

fn v1(drive: &Drive) -> (TempDir, WaymoLog, Scene) {
    let folder = tempfile::tempdir().unwrap();
    let output = Output::create(&folder.path().join("log")).unwrap();
    let (_, last) = write_waymo(drive, &output).unwrap();
    output.finish(&last).unwrap();
    let (log, scene) = open(&folder.path().join("log"));
    (folder, log, scene)
}

/// How far a sweep's points, and their rays' origins, are from the drive's, at most, metres.
#[derive(Debug, Default)]
struct Off {
    points: usize,
    labelled: usize,
    point_m: f64,
    origin_m: f64,
}

impl Off {
    /// Looks for each point of the drive among those that were read: the nearest is it.
    fn add(&mut self, expected: &Cloud, found: &Cloud) {
        let (sweep, points) = expected;
        assert_eq!(points.len(), found.1.len(), "{}", found.0.source_id);
        let places = places(found);
        for (i, place) in self::places(expected).iter().enumerate() {
            let apart_m = |j: &usize| (places[*j] - place).norm();
            let j = (0..places.len()).min_by(|a, b| apart_m(a).total_cmp(&apart_m(b))).unwrap();
            let origin = |(sweep, points): &Cloud, at| sweep.ego_from_lidar * points.origin(at);
            let origins_apart_m = (origin(expected, i) - origin(found, j)).norm();
            self.point_m = self.point_m.max(apart_m(&j));
            self.origin_m = self.origin_m.max(origins_apart_m);
            let is_labelled = sweep.labelled && found.0.lidar == "TOP";
            assert_eq!(found.1.labels[j], told(points.labels[i], is_labelled));
            self.labelled += usize::from(is_labelled);
        }
        self.points += places.len();
    }
}

type Cloud<'a> = (&'a SweepHeader, PointCloud<PointLabel>);

/// Points in the ego frame.
fn places((sweep, cloud): &Cloud) -> Vec<Point3<f64>> {
    cloud.positions.iter().map(|point| sweep.ego_from_lidar * point).collect()
}

/// What the format says of a label: it has no points to be ignored, only undefined ones, which
/// nobody labelled.
fn told(label: PointLabel, is_labelled: bool) -> PointLabel {
    match label {
        _ if !is_labelled => PointLabel::Unlabelled,
        PointLabel::Ignored => PointLabel::Unlabelled,
        label => label,
    }
}

/// The keyframes' sweeps of both lidars.
fn compare(drive: &Drive) -> Off {
    let (_folder, log, scene) = v1(drive);
    assert_eq!(scene.sweeps.len(), drive.scene().sweeps.len());
    let mut off = Off::default();
    for keyframe in drive.scene().keyframes.iter().step_by(2) {
        for (lidar, known) in [("LIDAR_TOP", "TOP"), ("ROSETTE", "FRONT")] {
            let is_it =
                |sweep: &&SweepHeader, name| sweep.time == keyframe.time && sweep.lidar == name;
            let here = drive.scene().sweeps.iter().find(|sweep| is_it(sweep, lidar)).unwrap();
            let there = scene.sweeps.iter().find(|sweep| is_it(sweep, known)).unwrap();
            let points = drive.points(drive.sweep_number(here).unwrap());
            off.add(&(here, points), &(there, log.read_sweep(there).unwrap().cloud));
        }
    }
    off
}

#[test]
fn every_point_comes_back_where_it_was_measured_with_its_label() {
    let off = compare(&drive(&[]));
    println!("{off:?}");
    assert!(off.points > 10_000 && off.labelled > 10_000, "{off:?}");
    assert!(off.point_m < 2e-5 && off.origin_m < 2e-5, "{off:?}");
}

#[test]
fn points_of_a_rolling_top_lidar_come_back_with_their_own_origins() {
    let off = compare(&drive(&["lidar.LIDAR_TOP.rolling=true"]));
    assert!(off.points > 10_000 && off.point_m < 2e-5, "{off:?}");
    // Origins of one column within 0.1 mm are one to the reader.
    assert!(off.origin_m < 1.1e-4, "{off:?}");
    let off = compare(&drive(&["lidar.LIDAR_TOP.rolling=true", "lidar.LIDAR_TOP.deskew=false"]));
    assert!(off.points > 10_000 && off.point_m < 2e-5 && off.origin_m < 2e-5, "{off:?}");
}

#[test]
fn drift_and_wrong_mountings_are_told_as_logged() {
    let faults = ["annotator.pose_drift=0.02", "annotator.calibration_rad=0.03"];
    let rolling = [&faults[..], &["lidar.LIDAR_TOP.rolling=true"]].concat();
    for settings in [&faults[..], &rolling] {
        let off = compare(&drive(settings));
        assert!(off.points > 10_000 && off.point_m < 2e-5 && off.origin_m < 1.1e-4, "{off:?}");
    }
}

#[test]
fn boxes_keep_place_size_and_heading_and_keyframes_their_times() {
    let drive =
        drive(&["ego.roll_rad.amplitude=0", "ego.pitch_rad.amplitude=0", "ego.pitch_rad.mean=0"]);
    let (_folder, _log, scene) = v1(&drive);
    let known = drive.scene();
    let kinds: Vec<_> = scene.tracks.iter().map(|t| (&*t.source_id, &*t.category)).collect();
    let expected = [
        ("car", "VEHICLE"),
        ("trailer", "VEHICLE"),
        ("truck", "VEHICLE"),
        ("walker", "PEDESTRIAN"),
    ];
    assert_eq!(kinds, expected);
    let mut boxes = 0;
    for (a, b) in known.tracks.iter().zip(&scene.tracks) {
        assert_eq!((a.id, a.meaning, a.boxes.len()), (b.id, b.meaning, b.boxes.len()));
        for ((a_time, a), (b_time, b)) in a.boxes.iter().zip(&b.boxes) {
            let apart = a.world_from_box.inverse() * b.world_from_box;
            assert!(apart.translation.vector.norm() + apart.rotation.angle() < 1e-7, "{apart}");
            assert_eq!((a_time, a.size_m), (b_time, b.size_m));
            boxes += 1;
        }
    }
    assert_eq!(boxes, 20);
    let times = |scene: &Scene| scene.keyframes.iter().map(|key| key.time).collect::<Vec<_>>();
    assert_eq!(times(known), times(&scene));
}

#[test]
fn cameras_keep_lens_shutter_and_exposures() {
    let shutter =
        "camera.CAM_FRONT.rolling_shutter={ direction = \"left-to-right\", readout_s = 0.03 }";
    let drive = drive(&[shutter]);
    let (_folder, _log, scene) = v1(&drive);
    let (known, read) = (&drive.scene().cameras[0].camera, &scene.cameras[0].camera);
    assert_eq!((scene.cameras.len(), &*scene.cameras[0].name), (1, "FRONT"));
    assert_eq!((known.width, known.height), (read.width, read.height));
    let [a, b] = [known, read].map(|camera| camera.rolling_shutter.unwrap());
    assert!(a.direction == b.direction && (a.readout_s - b.readout_s).abs() < 1e-12);
    let point = Point3::new(0.3, -0.2, 2.0);
    assert_eq!(known.model.project(&point), read.model.project(&point));
    for (a, b) in drive.scene().keyframes.iter().zip(&scene.keyframes) {
        let ([a], [b]) = (&a.exposures[..], &b.exposures[..]) else { panic!("one camera") };
        let apart = a.world_from_camera.inverse() * b.world_from_camera;
        assert_eq!(a.time, b.time);
        assert!(apart.translation.vector.norm() + apart.rotation.angle() < 1e-7, "{apart}");
    }
}

#[test]
fn what_the_format_has_no_words_for_is_refused_by_its_key() {
    let refused = |settings: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let output = Output::create(&folder.path().join("log")).unwrap();
        let fault = write_waymo(&drive(settings), &output).unwrap_err();
        assert_eq!(fault.rule, "world");
        (fault.place, fault.found)
    };
    let rosette =
        ["lidar.ROSETTE.pattern={ rosette = { shots = 9, min_rad = 0.0, max_rad = 0.9 } }"];
    let (place, found) = refused(&rosette);
    assert_eq!((&*place, &*found), ("lidar.ROSETTE.pattern", "rosette"));
    assert_eq!(refused(&["lidar.ROSETTE.rolling=true"]).0, "lidar.ROSETTE.deskew");
    assert_eq!(refused(&["lidar.ROSETTE.mounting.pitch_rad=1.57"]).0, "lidar.ROSETTE.mounting");
    let fisheye = "camera.CAM_FRONT.model={ kannala-brandt = { matrix = \
                   [[400.0, 0.0, 400.0], [0.0, 400.0, 225.0], [0.0, 0.0, 1.0]], distortion = [0.0, 0.0, 0.0, 0.0] } }";
    assert_eq!(refused(&[fisheye]), ("camera.CAM_FRONT.model".into(), "kannala-brandt".into()));
}

#[cfg(feature = "waymo-v2")]
#[test]
fn v1_and_v2_of_a_drive_are_the_same_scene_to_the_bit() {
    let drive = drive(&["lidar.LIDAR_TOP.rolling=true"]);
    let (_folder, first, mut a) = v1(&drive);
    let folder = tempfile::tempdir().unwrap();
    let output = Output::create(&folder.path().join("log")).unwrap();
    let (_, last) = occlabel_simulate::write_waymo_v2(&drive, &output).unwrap();
    output.finish(&last).unwrap();
    let (second, mut b) = open(&folder.path().join("log"));
    let mut points = 0;
    for (a, b) in a.sweeps.iter().zip(&b.sweeps) {
        let [a, b] = [first.read_sweep(a), second.read_sweep(b)].map(|read| read.unwrap().cloud);
        assert_eq!(a, b);
        points += a.len();
    }
    assert!(points > 50_000, "{points}");
    for scene in [&mut a, &mut b] {
        scene.sweeps.iter_mut().for_each(|sweep| sweep.file.clear());
    }
    assert_eq!(format!("{a:?}"), format!("{b:?}"), "but for the files");
}
