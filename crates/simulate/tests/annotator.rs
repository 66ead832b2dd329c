//! What an annotator does to a drive, counted and measured.

use nalgebra::Vector3;
use occlabel_core::{Fault, Keyframe, PointLabel, Pose, Taxonomy, Timestamp, TrackId};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, What, World};

const MOVERS: usize = 30;
const KEYFRAMES: usize = 40;

/// 20 s straight ahead at 10 m/s.
const STREET: &str = r#"
name = "street"
duration_s = 20.0
taxonomy = "occ3d-nuscenes"
keyframe_hz = 2.0
ground.bands = [{ class = "flat.driveable_surface" }]
ego.trajectory.straight = { start = { x_m = 0.0, y_m = 0.0 }, speed_mps = 10.0 }

[[lidar]]
name = "LIDAR_TOP"
mounting = { position_m = [0.9, 0.0, 1.84], yaw_rad = -1.5 }
pattern.spinning = { beams.even = { count = 12, min_rad = -0.4, max_rad = 0.0 }, azimuths = 120 }
rate_hz = 10.0
max_range_m = 40.0

[[camera]]
name = "CAM_FRONT"
mounting = { position_m = [1.7, 0.0, 1.5] }
model.pinhole.matrix = [[40.0, 0.0, 40.0], [0.0, 40.0, 22.0], [0.0, 0.0, 1.0]]
width = 80
height = 45
rate_hz = 12.0
"#;

/// The street between two rows of slow cars, each with a name in byte order.
fn street(annotator: &str) -> String {
    let cars: String = (0..MOVERS).map(car).collect();
    format!("{STREET}{cars}[annotator]\n{annotator}\n")
}

fn car(at: usize) -> String {
    let (x_m, y_m) = (6.0 * at as f64, if at.is_multiple_of(2) { 5.0 } else { -5.0 });
    format!(
        "[[mover]]\nname = \"car-{at:02}\"\ncategory = \"vehicle.car\"\n\
         size_m = [4.4, 1.8, 1.5]\nlift_m = 0.02\n\
         trajectory.straight = {{ start = {{ x_m = {x_m}, y_m = {y_m} }}, speed_mps = 2.0 }}\n"
    )
}

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

fn try_drive(text: &str) -> Result<Drive, Fault> {
    Drive::new(World::parse(text, "street.toml")?, &taxonomy())
}

fn drive(annotator: &str) -> Drive {
    try_drive(&street(annotator)).unwrap_or_else(|fault| panic!("{fault}"))
}

fn rolling(annotator: &str) -> Drive {
    let text = street(annotator).replace("max_range_m", "rolling = true\nmax_range_m");
    try_drive(&text).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Every logged box beside the true one of its time: (true from logged, logged size - true size).
fn box_errors(drive: &Drive) -> Vec<(Pose, Vector3<f64>)> {
    let mut errors = Vec::new();
    for mover in 0..MOVERS {
        let Some(track) = drive.track_of(mover) else { continue };
        for (time, boxed) in &drive.scene().tracks[usize::from(track.0) - 1].boxes {
            let world = drive.world();
            let time_s = time.seconds_since(Timestamp(0));
            let exact = world.movers[mover].box_at(time_s, &world.ground);
            let off = exact.world_from_box.inverse() * boxed.world_from_box;
            errors.push((off, boxed.size_m - exact.size_m));
        }
    }
    errors
}

/// Asserts that values spread around 0 by a deviation: both within four standard errors.
#[track_caller]
fn assert_spread(values: impl Iterator<Item = f64>, deviation: f64) {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = (values.iter().map(|value| value * value).sum::<f64>() / count).sqrt();
    assert!(mean.abs() < 4.0 * deviation / count.sqrt(), "mean {mean} of {count}");
    let slack = 4.0 / (2.0 * count).sqrt();
    assert!((spread / deviation - 1.0).abs() < slack, "{spread}, expected {deviation}");
}

/// Asserts that so many of so many are a share: within four deviations of the binomial.
#[track_caller]
fn assert_share(found: usize, of: usize, share: f64) {
    let (expected, deviation) = (of as f64 * share, (of as f64 * share * (1.0 - share)).sqrt());
    assert!((found as f64 - expected).abs() < 4.0 * deviation, "{found} of {of}, not {share}");
}

#[test]
fn by_default_the_log_tells_the_truth_of_its_keyframes() {
    let drive = drive("");
    let errors = box_errors(&drive);
    assert_eq!(errors.len(), MOVERS * KEYFRAMES);
    assert!(
        errors.iter().all(|(off, size)| off.translation.vector.norm() < 1e-9 && size.norm() == 0.0)
    );
    let scene = drive.scene();
    for header in &scene.sweeps {
        let time_s = header.time.seconds_since(Timestamp(0));
        assert_eq!(header.world_from_ego, drive.world().world_from_ego(time_s));
    }
    let is_key = |sweep: usize| scene.keyframes.iter().any(|keyframe| keyframe.sweep == sweep);
    assert!((0..200).all(|sweep| scene.sweeps[sweep].labelled == is_key(sweep)));
    let labelled = |sweep| drive.points(sweep).labels.iter().all(|l| *l != PointLabel::Unlabelled);
    assert!(labelled(0) && !labelled(1) && labelled(5));
}

#[test]
fn boxes_jitter_as_far_as_told() {
    let drive = drive("jitter_m = 0.1\njitter_yaw_rad = 0.05\njitter_size_m = 0.2");
    let errors = box_errors(&drive);
    assert_eq!(errors.len(), MOVERS * KEYFRAMES);
    for axis in 0..3 {
        assert_spread(errors.iter().map(|(off, _)| off.translation.vector[axis]), 0.1);
        assert_spread(errors.iter().map(|(_, size)| size[axis]), 0.2);
    }
    assert_spread(errors.iter().map(|(off, _)| off.rotation.scaled_axis().z), 0.05);
}

#[test]
fn a_box_never_shrinks_below_half() {
    let drive = drive("jitter_size_m = 5.0");
    let boxes = drive.scene().tracks.iter().flat_map(|track| &track.boxes);
    let heights: Vec<f64> = boxes.map(|(_, boxed)| boxed.size_m.z).collect();
    let halved = heights.iter().filter(|&&height| height == 0.75).count();
    assert!(heights.iter().all(|&height| height >= 0.75) && halved > 300, "{halved}");
}

#[test]
fn boxes_are_missing_as_often_as_told() {
    let drive = drive("missing_boxes = 0.1");
    let missing = MOVERS * KEYFRAMES - box_errors(&drive).len();
    assert_share(missing, MOVERS * KEYFRAMES, 0.1);
    let lonely = rolling("missing_boxes = 1.0");
    assert!(lonely.scene().tracks.is_empty() && lonely.track_of(0).is_none());
}

#[test]
fn a_missing_keyframe_is_missing_altogether_but_its_sweep_is_there() {
    let every = street("missing_keyframes = 0.25").replace("keyframe_hz = 2.0", "keyframe_hz = 10");
    let drive = try_drive(&every).unwrap();
    let scene = drive.scene();
    assert_share(199 - (scene.keyframes.len() - 1), 199, 0.25);
    assert_eq!((scene.sweeps.len(), scene.keyframes[0].time), (200, Timestamp(0)));
    let labelled = scene.sweeps.iter().filter(|sweep| sweep.labelled).count();
    assert_eq!(labelled, scene.keyframes.len());
    let times: Vec<Timestamp> = scene.keyframes.iter().map(|keyframe| keyframe.time).collect();
    for track in &scene.tracks {
        assert!(track.boxes.iter().map(|(time, _)| *time).eq(times.iter().copied()));
    }
}

#[test]
fn one_fault_moves_no_other() {
    let (some, all) = (drive("jitter_m = 0.1\nmissing_boxes = 0.3"), drive("jitter_m = 0.1"));
    let mut compared = 0;
    for track in &some.scene().tracks {
        let whole = all.scene().tracks.iter().find(|t| t.source_id == track.source_id).unwrap();
        assert!(track.boxes.iter().all(|boxed| whole.boxes.contains(boxed)));
        compared += track.boxes.len();
    }
    assert!(compared > 700, "{compared}");
}

#[test]
fn movers_without_boxes_keep_their_points_and_leave_no_gap_in_the_ids() {
    let drive = drive("unlabelled_movers = [\"car-00\", \"car-07\"]\npoint_labels = \"all\"");
    let ids: Vec<_> = (0..MOVERS).map(|mover| drive.track_of(mover)).collect();
    assert_eq!((ids[0], ids[7]), (None, None));
    assert_eq!((ids[1], ids[8], ids[29]), (Some(TrackId(1)), Some(TrackId(7)), Some(TrackId(28))));
    let scene = drive.scene();
    assert_eq!(scene.tracks.len(), 28);
    assert!(scene.tracks.iter().zip(1..).all(|(track, id)| track.id.0 == id));
    let car = drive.label_of(What::Mover(0));
    let returns = drive.returns(0);
    let on_first = (0..returns.len()).filter(|&at| returns[at].hit.what == What::Mover(0));
    let labels: Vec<_> = on_first.map(|at| drive.points(0).labels[at]).collect();
    assert!(labels.len() > 10 && labels.iter().all(|label| *label == car), "{}", labels.len());
}

#[test]
fn a_share_of_movers_has_no_box() {
    let drive = drive("unlabelled_movers = 0.5");
    assert_share(MOVERS - drive.scene().tracks.len(), MOVERS, 0.5);
}

#[test]
fn poses_drift_by_their_share_of_the_way() {
    let drive = drive("pose_drift = 0.001");
    let world = drive.world();
    for header in &drive.scene().sweeps {
        let time_s = header.time.seconds_since(Timestamp(0));
        let off = world.world_from_ego(time_s).inverse() * header.world_from_ego;
        assert!((off.translation.vector.norm() - 0.01 * time_s).abs() < 1e-9, "{time_s}: {off}");
        assert!((off.rotation.angle() - 1e-4 * time_s).abs() < 1e-9, "{time_s}: {off}");
    }
}

#[test]
fn boxes_drift_along_with_what_the_lidar_sees() {
    let drive = drive("pose_drift = 0.001\ncalibration_m = 0.05\ncalibration_rad = 0.01");
    let (world, scene) = (drive.world(), drive.scene());
    let mut compared = 0;
    for track in &scene.tracks {
        for (keyframe, (_, boxed)) in scene.keyframes.iter().zip(&track.boxes) {
            let time_s = keyframe.time.seconds_since(Timestamp(0));
            let exact = world.movers[usize::from(track.id.0) - 1].box_at(time_s, &world.ground);
            let logged = scene.sweeps[keyframe.sweep].world_from_lidar().inverse();
            let truly = world.lidars[0].world_from_lidar(world, keyframe.time).inverse();
            let off = (logged * boxed.world_from_box).inverse() * (truly * exact.world_from_box);
            assert!(off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-6, "{off}");
            compared += 1;
        }
    }
    assert_eq!(compared, MOVERS * KEYFRAMES);
}

#[test]
fn every_sensor_is_mounted_as_wrongly_as_told() {
    let drive = drive("calibration_m = 0.03\ncalibration_rad = 0.01");
    let (world, poses) = (drive.world(), drive.poses());
    let lidar = world.lidars[0].ego_from_lidar.inverse() * poses.ego_from_lidar[0];
    let camera = world.cameras[0].ego_from_camera.inverse() * poses.ego_from_camera[0];
    for off in [lidar, camera] {
        assert!((off.translation.vector.norm() - 0.03).abs() < 1e-12, "{off}");
        assert!((off.rotation.angle() - 0.01).abs() < 1e-9, "{off}");
    }
    assert_ne!(lidar, camera);
    assert_eq!(drive.scene().sweeps[3].ego_from_lidar, poses.ego_from_lidar[0]);
    let exposure = &drive.exposures(0)[6];
    assert_eq!(exposure.time, Timestamp(500_000_000));
    let expected = world.world_from_ego(0.5) * poses.ego_from_camera[0];
    assert_eq!(exposure.world_from_camera, expected);
    assert_eq!(drive.scene().keyframes[1].exposures[0].world_from_camera, expected);
}

#[test]
fn what_is_measured_knows_nothing_of_the_faults() {
    let faulty = drive("pose_drift = 0.01\ncalibration_m = 0.1\njitter_m = 0.3");
    let perfect = drive("");
    assert!([0, 7, 100].into_iter().all(|sweep| faulty.points(sweep) == perfect.points(sweep)));
    assert!(faulty.points(100).len() > 500);
}

#[test]
fn points_are_mislabelled_as_often_as_told_and_can_be_logged() {
    let drive = drive("mislabelled_points = 0.2\npoint_labels = \"all\"");
    let (mut wrong, mut all) = (0, 0);
    for sweep in 0..10 {
        let (returns, labels) = (drive.returns(sweep), drive.points(sweep).labels);
        for (found, label) in returns.iter().zip(labels) {
            wrong += usize::from(label != drive.label_of(found.hit.what));
            let raw = drive.raw_label(found.hit.what, label).unwrap();
            let meaning = taxonomy().points[raw];
            assert!(
                matches!((meaning, label), (occlabel_core::Meaning::Class(a), PointLabel::Class(b)) if a == b)
            );
            all += 1;
        }
    }
    assert!(all > 5_000, "{all}");
    assert_share(wrong, all, 0.2);
    assert_eq!(drive.raw_label(What::Mover(0), PointLabel::Unlabelled), None);
}

/// How far, on average over its returns, a mover's box stands ahead of where the mover was at each
/// return's own time, metres; none if it has fewer than ten.
fn ahead_m(drive: &Drive, keyframe: &Keyframe, mover: usize) -> Option<f64> {
    let world = drive.world();
    let track = &drive.scene().tracks[usize::from(drive.track_of(mover)?.0) - 1];
    let (_, boxed) = track.boxes.iter().find(|(time, _)| *time == keyframe.time)?;
    let returns = drive.returns(keyframe.sweep);
    let own = returns.iter().filter(|found| found.hit.what == What::Mover(mover));
    let offs = own.map(|found| {
        let then_s = found.time.seconds_since(Timestamp(0));
        let then = world.movers[mover].box_at(then_s, &world.ground).world_from_box;
        (boxed.world_from_box.translation.vector - then.translation.vector).x
    });
    let offs: Vec<f64> = offs.collect();
    (offs.len() >= 10).then(|| offs.iter().sum::<f64>() / offs.len() as f64)
}

#[test]
fn a_rolling_sweeps_box_stands_amid_its_returns() {
    let (mean, sweep) = (rolling(""), rolling("box_time = \"sweep\""));
    let (mut compared, mut worst_m) = (0, 0.0_f64);
    for (at, keyframe) in mean.scene().keyframes.iter().enumerate().take(8) {
        for mover in 0..MOVERS {
            let Some(off_m) = ahead_m(&mean, keyframe, mover) else { continue };
            assert!(off_m.abs() < 1e-6, "{off_m}");
            let early_m = ahead_m(&sweep, &sweep.scene().keyframes[at], mover).unwrap();
            worst_m = worst_m.max(-early_m);
            let late_s = mean.mover_time_s(keyframe, mover) - sweep.mover_time_s(keyframe, mover);
            assert!((2.0 * late_s + early_m).abs() < 1e-6, "{late_s} s at 2 m/s, {early_m} m");
            compared += 1;
        }
    }
    assert!(compared > 30 && worst_m > 0.15, "{compared}, {worst_m}");
}

#[test]
fn between_keyframes_a_mover_stands_where_a_box_between_theirs_does() {
    let (drive, mut late) = (rolling(""), 0);
    let late_ns = |time: i64, mover| {
        let keyframe = drive.keyframe(&time.to_string()).unwrap();
        (drive.mover_time_s(&keyframe, mover) * 1e9).round() as i64 - time
    };
    for mover in 0..MOVERS {
        let [first, second, last] = [0, 500_000_000, 19_500_000_000].map(|at| late_ns(at, mover));
        let between = first + (second - first) / 5;
        assert!((late_ns(100_000_000, mover) - between).abs() <= 2, "{first} {second}");
        assert!((late_ns(19_900_000_000, mover) - last).abs() <= 2);
        late += usize::from(between > 0);
    }
    assert!(late > 3, "{late}");
}

#[test]
fn unseen_movers_have_boxes_unless_points_are_asked_for() {
    let asked = drive("min_points = 3");
    let scene = asked.scene();
    let (mut with, mut without) = (0, 0);
    for keyframe in &scene.keyframes {
        let returns = asked.returns(keyframe.sweep);
        for mover in 0..MOVERS {
            let seen = returns.iter().filter(|r| r.hit.what == What::Mover(mover)).count();
            let track = asked.track_of(mover).map(|id| &scene.tracks[usize::from(id.0) - 1]);
            let boxed =
                track.is_some_and(|t| t.boxes.iter().any(|(time, _)| *time == keyframe.time));
            assert_eq!(boxed, seen >= 3, "{seen}");
            *(if boxed { &mut with } else { &mut without }) += 1;
        }
    }
    assert!(with > 100 && without > 100, "{with} {without}");
}

#[test]
fn without_deskewing_points_are_logged_as_measured() {
    let text = street("").replace("max_range_m", "rolling = true\ndeskew = false\nmax_range_m");
    let drive = try_drive(&text).unwrap();
    let (cloud, returns) = (drive.points(4), drive.returns(4));
    assert_eq!((cloud.origins.len(), cloud.len()), (1, returns.len()));
    assert!(returns.len() > 500);
    assert!(cloud.positions.iter().zip(&returns).all(|(p, found)| *p == found.position_m));
    assert_ne!(cloud.positions, rolling("").points(4).positions);
}

#[test]
fn a_faulty_log_is_the_same_on_any_number_of_threads() {
    let faults = "jitter_m = 0.1\nmissing_boxes = 0.2\nmissing_keyframes = 0.2\nmin_points = 1\n\
                  pose_drift = 0.01\ncalibration_rad = 0.01\nmislabelled_points = 0.1";
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let drive = rolling(faults);
            (format!("{:?}", drive.scene()), drive.points(0))
        })
    };
    assert!(on(1) == on(2));
}

#[test]
fn bad_annotators_are_refused_by_their_key() {
    for (line, key) in [
        ("missing_boxes = 1.1", "annotator.missing_boxes"),
        ("missing_keyframes = nan", "annotator.missing_keyframes"),
        ("mislabelled_points = -0.1", "annotator.mislabelled_points"),
        ("jitter_m = inf", "annotator.jitter_m"),
        ("pose_drift = 2", "annotator.pose_drift"),
        ("calibration_rad = -1", "annotator.calibration_rad"),
        ("unlabelled_movers = [\"tank\"]", "annotator.unlabelled_movers"),
        ("unlabelled_movers = \"tank\"", "annotator.unlabelled_movers"),
        ("box_time = \"now\"", "annotator.box_time"),
        ("point_labels = \"some\"", "annotator.point_labels"),
        ("min_points = -1", "annotator.min_points"),
        ("misssing_boxes = 0.1", "annotator.misssing_boxes"),
    ] {
        let fault = try_drive(&street(line)).unwrap_err();
        assert_eq!(fault.record.as_deref(), Some(key), "{fault}");
    }
}
