//! Cameras and their exposures.

use std::io::Cursor;

use image::{GrayImage, ImageFormat, Luma};
use nalgebra::{Point2, Point3};
use occlabel_core::camera::CameraModel;
use occlabel_core::{KeyframeSource, Loss, Scene, Timestamp};
use serde_json::{Value, json};

use crate::tiny_log::{NAN, TinyLog};

/// The time of each keyframe's only exposure, milliseconds; 0 where there is none.
fn exposed_ms(scene: &Scene) -> Vec<i64> {
    let time = |keyframe: &occlabel_core::Keyframe| {
        keyframe.exposures.first().map_or(0, |exposure| exposure.time.0 / 1_000_000)
    };
    scene.keyframes.iter().map(time).collect()
}

/// A log whose camera has this calibration, and its scene.
fn calibrated(fields: Value) -> (TinyLog, Scene) {
    let mut log = TinyLog::new();
    for (field, value) in fields.as_object().unwrap() {
        log.row("calibrated_sensor", "cal-cam")[field] = value.clone();
    }
    let scene = log.scene();
    (log, scene)
}

fn refusals(scene: &Scene) -> Vec<(Loss, &str)> {
    scene.refused.iter().map(|refusal| (refusal.loss, refusal.fault.rule)).collect()
}

#[test]
fn section_2_a_keyframes_own_images_come_first_with_their_own_time_and_pose() {
    let scene = TinyLog::new().scene();
    assert_eq!(exposed_ms(&scene), [1010, 1510]);
    let exposure = &scene.keyframes[1].exposures[0];
    assert!((exposure.world_from_camera.translation.x - 16.6).abs() < 1e-12);
    assert_eq!((scene.cameras[0].camera.width, scene.cameras[0].camera.height), (8, 4));
    let pixel = scene.cameras[0].camera.model.project(&Point3::new(1.0, 0.5, 2.0));
    assert_eq!(pixel, Some(Point2::new(7.0, 3.5)));
}

#[test]
fn section_2_other_keyframes_take_the_nearest_image_within_a_tenth_of_a_second() {
    let mut log = TinyLog::new();
    log.keyframes.source = KeyframeSource::Sweeps;
    assert_eq!(exposed_ms(&log.scene()), [1010, 1260, 1510]);
    log.row("sample_data", "c1")["timestamp"] = json!(1_350_000);
    assert_eq!(exposed_ms(&log.scene()), [1010, 1350, 1510], "the limit is closed");
    log.row("sample_data", "c1")["timestamp"] = json!(1_350_001);
    assert_eq!(exposed_ms(&log.scene()), [1010, 0, 1510]);
    log.row("sample_data", "c1")["timestamp"] = json!(1_290_000);
    log.copy("sample_data", "c1", &[("token", json!("c1b")), ("timestamp", json!(1_210_000))]);
    assert_eq!(exposed_ms(&log.scene()), [1010, 1210, 1510], "the earlier on ties");
}

#[test]
fn section_2_an_image_that_is_no_key_frame_serves_where_the_format_names_none() {
    let mut log = TinyLog::new();
    log.row("sample_data", "c0")["is_key_frame"] = json!(false);
    log.copy("sample_data", "c0", &[("token", json!("far")), ("timestamp", json!(1_050_000))]);
    assert_eq!(exposed_ms(&log.scene()), [1010, 1510]);
    log.row("sample_data", "far")["is_key_frame"] = json!(true);
    assert_eq!(exposed_ms(&log.scene()), [1050, 1510], "the named one, though farther");
}

#[test]
fn section_2_cameras_stand_in_byte_order_and_at_most_sixteen() {
    let with_cameras = |count: usize| {
        let mut log = TinyLog::new();
        for number in 1..count {
            let (sensor, calibration) = (format!("sensor-{number}"), format!("cal-{number}"));
            let channel = format!("CAM_{:02}", 99 - number);
            log.copy(
                "sensor",
                "sensor-cam",
                &[("token", json!(sensor)), ("channel", json!(channel))],
            );
            log.copy(
                "calibrated_sensor",
                "cal-cam",
                &[("token", json!(calibration)), ("sensor_token", json!(sensor))],
            );
            log.copy(
                "sample_data",
                "c0",
                &[
                    ("token", json!(format!("c0-{number}"))),
                    ("calibrated_sensor_token", json!(calibration)),
                ],
            );
        }
        log
    };
    let scene = with_cameras(16).scene();
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!((names.len(), names[0], names[15]), (16, "CAM_84", "CAM_FRONT"));
    assert!(names.is_sorted());
    let order: Vec<usize> = scene.keyframes[0].exposures.iter().map(|e| e.camera).collect();
    assert_eq!(order, (0..16).collect::<Vec<_>>());
    assert!(with_cameras(17).refusal().contains("expected at most 16 cameras, found 17"));
}

#[test]
fn section_2_each_camera_model_is_read_from_its_optional_fields() {
    let model = |fields: Value| calibrated(fields).1.cameras[0].camera.model.clone();
    let with = |name: &str, count: usize| {
        model(json!({"camera_model": name, "camera_distortion": vec![0.01; count]}))
    };
    assert!(matches!(model(json!({})), CameraModel::Pinhole(_)));
    assert!(matches!(model(json!({"camera_model": "pinhole"})), CameraModel::Pinhole(_)));
    assert!(matches!(with("brown-conrady", 5), CameraModel::BrownConrady(_)));
    assert!(matches!(with("kannala-brandt", 4), CameraModel::KannalaBrandt(_)));
    assert!(matches!(with("mei", 5), CameraModel::Mei(_)));
    let plain = |name: &str| model(json!({"camera_model": name}));
    assert!(matches!(plain("brown-conrady"), CameraModel::BrownConrady(_)), "none is zero");
    let ocam = |affine: Value| {
        model(json!({"camera_model": "ocam", "camera_intrinsic": [], "ocam": {
            "poly": [-300.0, 0.0, 0.001], "centre": [4.0, 2.0], "affine": affine,
            "max_angle_rad": 1.6,
        }}))
    };
    let short = ocam(json!([1.1, 0.2, 0.3]));
    assert!(matches!(short, CameraModel::Ocam(_)));
    assert_eq!(ocam(json!([[1.1, 0.2], [0.3, 1.0]])), short, "the same affine part in full");
}

#[test]
fn calibrations_of_no_camera_cost_the_camera_and_nothing_else() {
    for fields in [
        json!({"camera_intrinsic": []}),
        json!({"camera_intrinsic": [[6.0, 0.0], [0.0, 6.0], [0.0, 0.0]]}),
        json!({"camera_intrinsic": [[NAN, 0.0, 4.0], [0.0, 6.0, 2.0], [0.0, 0.0, 1.0]]}),
        json!({"camera_model": "telescope"}),
        json!({"camera_model": "ocam"}),
        json!({"camera_model": "kannala-brandt", "camera_distortion": [0.1]}),
        json!({"camera_distortion": [0.1, 0.0, 0.0, 0.0]}),
    ] {
        let (_, scene) = calibrated(fields.clone());
        assert_eq!(refusals(&scene), [(Loss::Camera, "camera-model")], "{fields}");
        assert!(scene.cameras.is_empty() && scene.keyframes.len() == 2);
    }
}

#[test]
fn a_body_mask_is_read_and_has_to_have_the_cameras_size() {
    let mut log = TinyLog::new();
    log.row("calibrated_sensor", "cal-cam")["mask"] = json!("masks/front.png");
    let png = |width: u32, height: u32| {
        let mut mask = GrayImage::new(width, height);
        mask.put_pixel(2, 1, Luma([7]));
        let mut bytes = Cursor::new(Vec::new());
        mask.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    log.files.insert("masks/front.png".into(), png(8, 4));
    let scene = log.scene();
    let covered = (0..4).flat_map(|row| (0..8).map(move |column| (column, row)));
    let camera = &scene.cameras[0].camera;
    assert_eq!(covered.filter(|&(x, y)| camera.is_body(x, y)).collect::<Vec<_>>(), [(2, 1)]);
    for bad in [png(9, 4), png(8, 3), b"no png".to_vec(), png(8, 4)[..40].to_vec()] {
        log.files.insert("masks/front.png".into(), bad);
        assert_eq!(refusals(&log.scene()), [(Loss::Camera, "camera-mask")]);
    }
    log.files.clear();
    assert_eq!(refusals(&log.scene()), [(Loss::Camera, "missing-file")]);
    log.row("calibrated_sensor", "cal-cam")["mask"] = json!("../front.png");
    assert_eq!(refusals(&log.scene()), [(Loss::Camera, "file-name")]);
}

#[test]
fn a_camera_without_a_size_is_refused() {
    let mut log = TinyLog::new();
    for token in ["c0", "c1", "c2"] {
        log.row("sample_data", token)["width"] = json!(0);
    }
    assert_eq!(refusals(&log.scene()), [(Loss::Camera, "camera-size")]);
}

#[test]
fn a_camera_that_moves_is_followed_and_one_that_changes_its_optics_is_refused() {
    let mut log = TinyLog::new();
    log.copy(
        "calibrated_sensor",
        "cal-cam",
        &[("token", json!("cal-moved")), ("translation", json!([2.5, 0.0, 1.5]))],
    );
    log.row("sample_data", "c2")["calibrated_sensor_token"] = json!("cal-moved");
    let x = log.scene().keyframes[1].exposures[0].world_from_camera.translation.x;
    assert!((x - 17.6).abs() < 1e-12, "{x}");
    log.row("calibrated_sensor", "cal-moved")["camera_intrinsic"][0][0] = json!(7.0);
    let scene = log.scene();
    assert_eq!(exposed_ms(&scene), [1010, 0]);
    assert_eq!(refusals(&scene), [(Loss::Camera, "camera-changed")]);
}

#[test]
fn fault_12_a_cameras_bad_pose_costs_its_exposure_its_bad_mounting_the_camera() {
    let mut log = TinyLog::new();
    log.row("ego_pose", "pose-c2")["rotation"] = json!([NAN, 0.0, 0.0, 0.0]);
    let scene = log.scene();
    assert_eq!(
        (exposed_ms(&scene), refusals(&scene)),
        (vec![1010, 0], vec![(Loss::Camera, "quaternion-norm")])
    );
    let (_, scene) = calibrated(json!({"rotation": [0.0, 0.0, 0.0, 0.0]}));
    assert_eq!(refusals(&scene), [(Loss::Camera, "quaternion-norm")]);
    assert!(scene.cameras.is_empty());
}

#[test]
fn fault_29_an_absent_camera_is_a_warning() {
    let mut log = TinyLog::new();
    log.row("sample_data", "c2")["timestamp"] = json!(9_000_000);
    log.row("sample_data", "c2")["is_key_frame"] = json!(false);
    let scene = log.scene();
    assert_eq!(exposed_ms(&scene), [1010, 0]);
    assert!(scene.refused.is_empty());
    assert_eq!(
        scene.warnings[0].to_string(),
        "CAM_FRONT (s1): expected an image within 0.1 s of the keyframe, found none"
    );
    log.tables.get_mut("sample_data").unwrap().retain(|row| row["width"] == 0);
    let scene = log.scene();
    assert!(scene.cameras.is_empty() && scene.keyframes.len() == 2);
    assert_eq!(scene.warnings[0].rule, "camera-absent");
    assert_eq!(scene.keyframes[0].time, Timestamp::from_micros(1_000_000));
}
