//! What a scene is: sweeps, poses, keyframes, tracks, cameras.

use nalgebra::{Point3, Vector3};
use occlabel_core::camera::{RollingShutter, ShutterDirection};
use occlabel_core::{Fault, KeyframeSource, Meaning, Scene, Timestamp, TrackId};
use occlabel_logs::{Inventory, ReadOptions, SceneSource, WaymoLog};

use crate::log::{MICROS, SEGMENT, fixtures, folder, folder_of, frames, load, options};
use crate::message::{edit, record, without};

/// The fixture as a scene.
fn drive() -> Scene {
    load(&frames()).unwrap()
}

#[test]
fn a_frame_has_a_sweep_of_each_lidar_and_the_top_one_is_labelled_on_some() {
    let scene = drive();
    assert_eq!(scene.name, SEGMENT);
    let names: Vec<&str> = scene.sweeps.iter().map(|sweep| sweep.lidar.as_str()).collect();
    assert_eq!(names, ["FRONT", "REAR", "SIDE_LEFT", "SIDE_RIGHT", "TOP"].repeat(3));
    let labelled: Vec<usize> = (0..15).filter(|i| scene.sweeps[*i].labelled).collect();
    assert_eq!(labelled, [4, 14]);
    let top = &scene.sweeps[9];
    assert_eq!(top.time, Timestamp::from_micros(MICROS[1]));
    assert_eq!(top.source_id, format!("{SEGMENT}/{}/TOP", MICROS[1]));
    assert!((top.world_from_ego.translation.x - (1200.0 + 9.0 * 0.0999)).abs() < 1e-9);
    assert!(
        (top.ego_from_lidar.translation.vector - Vector3::new(1.43, 0.0, 2.184)).norm() < 1e-12
    );
    assert!(scene.warnings.is_empty() && scene.refused.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn section_2_every_frame_with_boxes_is_a_keyframe_of_the_top_lidar() {
    let scene = drive();
    let tokens: Vec<String> = scene.keyframes.iter().map(|frame| frame.token.clone()).collect();
    assert_eq!(tokens, MICROS.map(|micros| format!("{micros}000")));
    assert!(scene.keyframes.iter().all(|frame| scene.reference_sweep(frame).lidar == "TOP"));
    let bare = without(&frames()[1], 6);
    let scene = load(&[frames()[0].clone(), bare, frames()[2].clone()]).unwrap();
    assert_eq!(scene.keyframes.len(), 2, "one frame has no boxes");
    let bare: Vec<Vec<u8>> = frames().iter().map(|frame| without(frame, 6)).collect();
    let scene = load(&bare).unwrap();
    assert_eq!((scene.keyframes.len(), scene.tracks.len()), (3, 0), "no frame has boxes");
}

#[test]
fn keyframes_have_a_stride_and_a_source() {
    let root = folder(&frames());
    let keyframes = |change: fn(&mut ReadOptions)| {
        let mut options = options();
        change(&mut options);
        let log = WaymoLog::open(root.path(), options).unwrap();
        log.load(SEGMENT).unwrap().keyframes.len()
    };
    assert_eq!(keyframes(|options| options.keyframes.stride = 2), 2);
    assert_eq!(keyframes(|options| options.keyframes.source = KeyframeSource::Sweeps), 3);
}

#[test]
fn section_2_boxes_stand_in_the_frames_vehicle_and_tracks_go_by_the_bytes_of_their_ids() {
    let scene = drive();
    let ids: Vec<_> = scene.tracks.iter().map(|track| (track.id, &*track.source_id)).collect();
    assert_eq!(ids, [(TrackId(1), "a-walker"), (TrackId(2), "b-car"), (TrackId(3), "c-sign")]);
    assert_eq!(scene.tracks.iter().map(|t| t.boxes.len()).collect::<Vec<_>>(), [3, 3, 2]);
    assert_eq!((&*scene.tracks[2].category, scene.tracks[2].meaning), ("SIGN", Meaning::Ignore));
    let (time, car) = &scene.tracks[1].boxes[1];
    assert_eq!(*time, scene.keyframes[1].time);
    assert_eq!(car.size_m, Vector3::new(4.5, 1.9, 1.6));
    // Heading 0.4 at (9, 4, 0.9) in the vehicle's frame: 2 m before the centre is the front.
    let front =
        scene.sweeps[9].world_from_ego.inverse() * car.world_from_box * Point3::new(2.0, 0.0, 0.0);
    let expected = Point3::new(9.0 + 2.0 * libm::cos(0.4), 4.0 + 2.0 * libm::sin(0.4), 0.9);
    assert!((front - expected).norm() < 1e-9, "{front}");
}

/// What the fixture's maker put in place of a JPEG.
const JPEG: &[u8] = b"\xff\xd8 no picture \xff\xd9";

/// The images of all exposures, in order.
fn images(log: &WaymoLog) -> Vec<Result<Option<Vec<u8>>, Fault>> {
    let scene = log.load(SEGMENT).unwrap();
    let exposures = scene.keyframes.iter().flat_map(|keyframe| &keyframe.exposures);
    exposures.map(|exposure| log.read_image(&scene, exposure)).collect()
}

#[test]
fn images_are_the_bytes_in_their_frames() {
    let versions = [
        "v1",
        #[cfg(feature = "waymo-v2")]
        "v2",
    ];
    for version in versions {
        let log = WaymoLog::open(&fixtures().join(version), options()).unwrap();
        let images = images(&log);
        assert!(images.len() >= 6, "{}", images.len());
        assert!(images.iter().all(|image| image.as_ref().unwrap().as_deref() == Some(JPEG)));
    }
}

#[test]
fn an_image_that_is_absent_is_none_and_one_in_a_broken_record_is_refused() {
    let bare = |frame: &Vec<u8>| edit(frame, &[(4, 0)], &mut |image| without(image, 2));
    let root = folder(&frames().iter().map(bare).collect::<Vec<_>>());
    let log = WaymoLog::open(root.path(), options()).unwrap();
    let absent = images(&log).into_iter().filter(|image| *image == Ok(None)).count();
    assert_eq!(absent, 3, "one of each frame");
    let mut bytes: Vec<u8> = frames().iter().flat_map(|frame| record(frame)).collect();
    let at = bytes.windows(JPEG.len()).position(|window| window == JPEG).unwrap();
    bytes[at + 5] ^= 1;
    let root = folder_of(&bytes);
    let log = WaymoLog::open(root.path(), options()).unwrap();
    let broken: Vec<_> = images(&log).into_iter().filter_map(Result::err).collect();
    assert!(!broken.is_empty() && broken.iter().all(|fault| fault.rule == "record-checksum"));
}

#[test]
fn cameras_look_along_their_x_at_their_own_times() {
    let scene = drive();
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["FRONT", "FRONT_LEFT", "FRONT_RIGHT", "SIDE_LEFT", "SIDE_RIGHT"]);
    let exposure = &scene.keyframes[0].exposures[1];
    assert_eq!((exposure.camera, exposure.time), (1, Timestamp::from_micros(MICROS[0] + 20_000)));
    // FRONT_LEFT is turned 0.78 to the left, and stands at (1.5, 0.2, 2.1); the vehicle has gone on
    // for 0.02 s, and is turned by 0.41.
    let ahead = exposure.world_from_camera * Point3::new(0.0, 0.0, 10.0);
    let here = exposure.world_from_camera * Point3::origin();
    let heading = libm::atan2(ahead.y - here.y, ahead.x - here.x);
    assert!((heading - (0.78 + 0.41)).abs() < 0.01, "{heading}");
    assert!(
        (here.x - 1200.0 - 9.0 * 0.02 - (1.5 * libm::cos(0.41) - 0.2 * libm::sin(0.41))).abs()
            < 0.05
    );
    let below = exposure.world_from_camera * Point3::new(0.0, 1.0, 0.0);
    assert!(here.z - below.z > 0.99, "y is down");
}

#[test]
fn cameras_have_lens_size_and_shutter() {
    let scene = drive();
    let front = &scene.cameras[0].camera;
    assert_eq!((front.width, front.height), (1920, 1280));
    let shutter = front.rolling_shutter.unwrap();
    assert_eq!(shutter.direction, ShutterDirection::LeftToRight);
    assert!((shutter.readout_s - 0.04).abs() < 1e-6);
    let centre = front.model.project(&Point3::new(0.0, 0.0, 5.0)).unwrap();
    assert!((centre.x - 939.6).abs() < 1e-9 && (centre.y - 640.1).abs() < 1e-9, "{centre}");
    assert_eq!(scene.cameras[4].camera.rolling_shutter, None::<RollingShutter>);
}

#[test]
fn section_13_the_vehicles_body_lies_about_the_top_lidar() {
    let defaults = WaymoLog::format_defaults(&fixtures().join("v1")).unwrap();
    let (min, max) = defaults.ego_box_m.unwrap();
    assert!((min[0] - (1.43 - 8.0)).abs() < 1e-12 && (max[0] - (1.43 + 4.0)).abs() < 1e-12);
    assert_eq!((min[1], max[1]), (-2.0, 2.0));
    assert_eq!((defaults.taxonomy, &*defaults.reference_lidar), ("occ3d-waymo", "TOP"));
}

#[test]
fn segments_are_told_apart_by_their_context_not_by_their_files() {
    let rename = |frame: &Vec<u8>| edit(frame, &[(1, 0), (1, 0)], &mut |_| b"other-1".to_vec());
    let mixed = [frames()[0].clone(), rename(&frames()[1]), frames()[2].clone()];
    let root = folder(&mixed);
    let log = WaymoLog::open(root.path(), options()).unwrap();
    assert_eq!(log.scene_names(), [SEGMENT, "other-1"]);
    assert_eq!(log.load("other-1").unwrap().sweeps.len(), 5);
    assert_eq!(log.load(SEGMENT).unwrap().sweeps.len(), 10);
    let only = ReadOptions { scenes: Some(["other-1".to_owned()].into()), ..options() };
    assert_eq!(WaymoLog::open(root.path(), only).unwrap().scene_names(), ["other-1"]);
    let none = ReadOptions { scenes: Some(["other-2".to_owned()].into()), ..options() };
    let fault = WaymoLog::open(root.path(), none).unwrap_err();
    assert!(fault.rule == "scene-unknown" && fault.to_string().contains("other-1"), "{fault}");
}

#[test]
fn frames_may_stand_in_any_order() {
    let backwards: Vec<Vec<u8>> = frames().into_iter().rev().collect();
    let times = |scene: Scene| scene.sweeps.iter().map(|sweep| sweep.time).collect::<Vec<_>>();
    assert_eq!(times(load(&backwards).unwrap()), times(drive()));
}

#[test]
fn a_file_that_many_sweeps_share_is_counted_once() {
    let root = folder(&frames());
    let log = WaymoLog::open(root.path(), options()).unwrap();
    let scene = log.load(SEGMENT).unwrap();
    let inventory = Inventory::take(&log, root.path(), &scene);
    assert_eq!((inventory.present.len(), inventory.missing.len()), (1, 0));
    std::fs::remove_file(root.path().join("drive.tfrecord")).unwrap();
    let inventory = Inventory::take(&log, root.path(), &scene);
    assert_eq!((inventory.present.len(), inventory.missing.len()), (0, 1));
    assert!(inventory.missing[0].is_reference);
}

#[test]
fn a_scene_without_cameras_says_so() {
    let bare: Vec<Vec<u8>> = frames().iter().map(|frame| without(frame, 4)).collect();
    let scene = load(&bare).unwrap();
    assert!(scene.cameras.is_empty() && scene.keyframes.len() == 3);
    assert_eq!(scene.warnings[0].rule, "camera-absent");
}

#[test]
fn a_camera_that_misses_a_frame_is_missed_there_only() {
    let image = |frame: &Vec<u8>| edit(frame, &[(4, 2)], &mut |_| vec![0x08, 60]);
    let scene = load(&[frames()[0].clone(), image(&frames()[1]), frames()[2].clone()]).unwrap();
    let counts: Vec<usize> = scene.keyframes.iter().map(|frame| frame.exposures.len()).collect();
    assert_eq!(counts, [5, 4, 5]);
    assert_eq!(
        scene.warnings[0].to_string(),
        format!(
            "FRONT_RIGHT (frame {}): expected an image in the keyframe's frame, found none",
            MICROS[1]
        )
    );
}
