//! What the calibration and the images' names tell of cameras.

use std::fs;
use std::path::Path;

use nalgebra::Point3;
use occlabel_core::camera::CameraModel;
use occlabel_core::{Loss, Timestamp};
use occlabel_logs::{Argoverse2Log, SceneSource};

use crate::{MOUNTINGS, WHOLE, copied, copy, data, options};

const LENSES: &str = "calibration/intrinsics.feather";
/// The first sweep's time, and one that no pose has.
const SWEEP_NS: i64 = 315_966_265_259_836_000;

fn with_lenses(data: &Path) -> tempfile::TempDir {
    let root = copied(data, WHOLE);
    copy(&data.join("sensor/val").join(WHOLE).join(LENSES), &root.path().join(WHOLE).join(LENSES));
    root
}

/// An image of a time; its camera's name is all there is in it, as no label opens it.
fn put_image(root: &Path, camera: &str, time_ns: i64) {
    let folder = root.join(WHOLE).join("sensors/cameras").join(camera);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(format!("{time_ns}.jpg")), camera).unwrap();
}

#[test]
fn a_log_without_images_has_cameras_that_saw_nothing_and_says_so() {
    let Some(data) = data() else { return };
    let root = with_lenses(&data);
    let scene = Argoverse2Log::open(root.path(), options()).unwrap().load(WHOLE).unwrap();
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!((names.len(), names[0], names[8]), (9, "ring_front_center", "stereo_front_right"));
    assert!(scene.keyframes.iter().all(|keyframe| keyframe.exposures.is_empty()));
    assert!(scene.refused.is_empty());
    let told: Vec<_> = scene.warnings.iter().map(|fault| fault.rule).collect();
    assert_eq!(told, ["camera-absent"]);
}

#[test]
fn images_tell_by_their_names_when_a_camera_was_exposed() {
    let Some(data) = data() else { return };
    let root = with_lenses(&data);
    for camera in ["ring_front_center", "ring_rear_left"] {
        put_image(root.path(), camera, SWEEP_NS);
    }
    put_image(root.path(), "ring_rear_left", SWEEP_NS + 1);
    let log = Argoverse2Log::open(root.path(), options()).unwrap();
    let scene = log.load(WHOLE).unwrap();
    let exposures = &scene.keyframes[0].exposures;
    let seen: Vec<(&str, Timestamp)> =
        exposures.iter().map(|e| (scene.cameras[e.camera].name.as_str(), e.time)).collect();
    let time = Timestamp(SWEEP_NS);
    assert_eq!(seen, [("ring_front_center", time), ("ring_rear_left", time)]);
    let image = |place: usize| log.read_image(&scene, &exposures[place]);
    assert_eq!(image(1).unwrap().as_deref(), Some(&b"ring_rear_left"[..]));
    fs::remove_file(root.path().join(exposures[1].image.as_ref().unwrap())).unwrap();
    assert_eq!(image(1).unwrap(), None, "it is gone");
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert_eq!(scene.warnings[0].rule, "ego-pose");
    let camera = &scene.cameras[exposures[0].camera].camera;
    assert_eq!((camera.width, camera.height), (1550, 2048));
    assert!(matches!(camera.model, CameraModel::Pinhole(_)));
    // 20 m ahead of the vehicle and 1 m up is seen near the middle, 20 m behind not at all.
    let ego = scene.sweeps[0].world_from_ego;
    let camera_from_ego = exposures[0].world_from_camera.inverse() * ego;
    let [ahead, behind] = [20.0, -20.0].map(|x| camera_from_ego * Point3::new(x, 0.0, 1.0));
    assert!((17.0..20.0).contains(&ahead.z) && behind.z < 0.0, "{ahead} {behind}");
    let pixel = camera.model.project(&ahead).expect("in view");
    assert!((pixel.x - 775.0).abs() < 60.0 && (pixel.y - 1024.0).abs() < 150.0, "{pixel}");
}

#[test]
fn a_camera_without_a_mounting_is_refused_and_the_rest_stays() {
    let Some(data) = data() else { return };
    let root = with_lenses(&data);
    let path = root.path().join(WHOLE).join(MOUNTINGS);
    let mut bytes = fs::read(&path).unwrap();
    // Names may be packed: this bends one at least.
    let at = bytes.windows(17).position(|part| part == b"ring_front_center");
    let Some(at) = at else { return println!("skipped: the mountings are packed") };
    bytes[at] = b'k';
    fs::write(&path, bytes).unwrap();
    let scene = Argoverse2Log::open(root.path(), options()).unwrap().load(WHOLE).unwrap();
    assert_eq!(scene.cameras.len() + scene.refused.len(), 9);
    assert!(!scene.refused.is_empty());
    assert!(scene.refused.iter().all(|refusal| refusal.loss == Loss::Camera));
}

#[test]
fn without_lenses_there_are_no_cameras_and_a_word() {
    let Some(data) = data() else { return };
    let root = copied(&data, WHOLE);
    let scene = Argoverse2Log::open(root.path(), options()).unwrap().load(WHOLE).unwrap();
    assert!(scene.cameras.is_empty());
    assert_eq!(scene.warnings[0].rule, "camera-absent");
    assert!(scene.warnings[0].place.ends_with(LENSES));
}
