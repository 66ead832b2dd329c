//! One drive in every encoding: the same scene.

use nalgebra::{Point3, Vector3};
use occlabel_core::{ClassId, McapSettings, PointLabel, Pose, Scene, SweepHeader, Timestamp};

use super::samples::{LOOK_NS, Sample, TELLINGS, Told, drive, file, options};
use super::{McapLog, McapOptions, TimeSource};
use crate::{SceneSource, SweepPoints};

/// What doubles and 32-bit times leave, metres.
const TOLERANCE_M: f64 = 1e-9;

/// The scene of these messages, and its only sweep's points.
fn read(samples: &[Sample], options: McapOptions) -> (Scene, SweepPoints) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mcap"), file(samples, None)).unwrap();
    let log = McapLog::open(folder.path(), options).unwrap_or_else(|fault| panic!("{fault}"));
    let scene = log.load("a").unwrap_or_else(|fault| panic!("{fault}"));
    assert!(scene.refused.is_empty(), "{:?}", scene.refused);
    let points = log.read_sweep(&scene.sweeps[0]).unwrap_or_else(|fault| panic!("{fault}"));
    (scene, points)
}

#[track_caller]
fn assert_at(pose: &Pose, place: [f64; 3], ahead: [f64; 3]) {
    let off = (pose.translation.vector - Vector3::from(place)).norm();
    let turned = (pose.rotation * Vector3::x() - Vector3::from(ahead)).norm();
    assert!(off < TOLERANCE_M && turned < TOLERANCE_M, "{pose}");
}

#[test]
fn every_encoding_tells_the_same_drive() {
    for told in TELLINGS {
        let (scene, points) = read(&drive(told), options());
        assert!(scene.warnings.is_empty(), "{told:?}: {:?}", scene.warnings);
        let [SweepHeader { time, lidar, world_from_ego, ego_from_lidar, .. }] = &scene.sweeps[..]
        else {
            panic!("{told:?}: {:?}", scene.sweeps)
        };
        assert_eq!((time.0, lidar.as_str()), (LOOK_NS, "lidar"), "{told:?}");
        assert_at(world_from_ego, [12.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        assert_at(ego_from_lidar, [1.0, 0.0, 1.5], [0.0, 1.0, 0.0]);
        let expected = [Point3::new(1.0, 2.0, 3.0), Point3::new(4.0, 5.0, 6.0)];
        assert_eq!(points.cloud.positions, expected, "{told:?}");
        assert_eq!(points.cloud.labels, [PointLabel::Class(ClassId(0)); 2], "9 is unknown");
        assert_eq!(points.warnings[0].rule, "unknown-label");
        assert!(points.warnings[0].record.is_some() && !points.unknown.is_empty());
        assert_car_and_camera(&scene);
    }
}

fn assert_car_and_camera(scene: &Scene) {
    let [track] = &scene.tracks[..] else { panic!("{:?}", scene.tracks) };
    assert_eq!((track.source_id.as_str(), track.category.as_str()), ("car/7", "car"));
    let [(Timestamp(LOOK_NS), car)] = &track.boxes[..] else { panic!("{:?}", track.boxes) };
    assert_at(&car.world_from_box, [17.0, 0.0, 0.75], [1.0, 0.0, 0.0]);
    assert_eq!(car.size_m, Vector3::new(4.0, 2.0, 1.5));
    let camera = &scene.cameras[0].camera;
    assert_eq!((camera.width, camera.height), (640, 480));
    assert_eq!(camera.model.coefficients()[0], 0.1);
    assert_eq!(scene.keyframes.len(), 1);
    let [exposure] = &scene.keyframes[0].exposures[..] else { panic!("{:?}", scene.keyframes) };
    assert_at(&exposure.world_from_camera, [13.5, 0.0, 1.2], [0.0, -1.0, 0.0]);
}

/// A point seen a quarter of a second later was seen from a metre farther ahead, which is to the
/// lidar's right: from (0, -1, 0).
fn assert_deskewed(settings: McapSettings, samples: &[Sample]) {
    let (_, points) = read(samples, McapOptions { settings, ..options() });
    let cloud = &points.cloud;
    let origins = cloud.origin_of.iter().map(|origin| cloud.origins[*origin as usize]);
    let expected = [
        (Point3::new(1.0, 2.0, 3.0), Point3::origin()),
        (Point3::new(4.0, 4.0, 6.0), Point3::new(0.0, -1.0, 0.0)),
    ];
    for ((point, origin), (at, from)) in cloud.positions.iter().zip(origins).zip(expected) {
        let off = (point - at).norm() + (origin - from).norm();
        // A double tells the seconds since the epoch to 0.24 microseconds: 1 micrometre here.
        assert!(off < 1e-5, "{point} from {origin}");
    }
}

#[test]
fn points_are_moved_by_their_own_times() {
    for told in TELLINGS {
        let settings = McapSettings { time_field: "offset".into(), ..options().settings };
        assert_deskewed(settings, &drive(told));
    }
}

#[test]
fn times_of_points_may_be_counted_from_the_epoch() {
    for told in TELLINGS {
        let (time_field, time_unit_s) = ("stamp".into(), 1.0);
        let settings = McapSettings { time_field, time_unit_s, ..options().settings };
        assert_deskewed(settings, &drive(told));
    }
}

#[test]
fn a_field_of_times_that_is_not_there_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mcap"), file(&drive(Told::Ros1), None)).unwrap();
    let settings = McapSettings { time_field: "t".into(), ..options().settings };
    let log = McapLog::open(folder.path(), McapOptions { settings, ..options() }).unwrap();
    let scene = log.load("a").unwrap();
    let fault = log.read_sweep(&scene.sweeps[0]).unwrap_err();
    assert_eq!(fault.rule, "cloud-fields");
    assert!(fault.expected.contains('t'), "{fault}");
}

#[test]
fn fault_17_the_header_s_time_counts_and_another_log_time_is_told() {
    for told in TELLINGS {
        let mut late = drive(told);
        late.iter_mut().for_each(|sample| sample.time_ns += 2_000_000_000);
        let (scene, _) = read(&late, options());
        assert_eq!(scene.sweeps[0].time.0, LOOK_NS);
        let warned = scene.warnings.iter().find(|fault| fault.rule == "mcap-clock").unwrap();
        assert!(warned.found.contains("2.000 s"), "{warned}");
        assert!(warned.hint.as_ref().unwrap().contains("--time-source log"));
        let log = McapOptions { time_source: TimeSource::Log, ..options() };
        let (scene, _) = read(&late, log);
        assert_eq!(scene.sweeps[0].time.0, LOOK_NS + 2_000_000_000);
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        late.iter_mut().for_each(|sample| sample.time_ns -= 1_000_000_000);
        let (scene, _) = read(&late, options());
        assert!(scene.warnings.is_empty(), "1 s is not more than 1 s: {:?}", scene.warnings);
    }
}
