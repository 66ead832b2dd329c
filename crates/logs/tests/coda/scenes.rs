//! What a sound log becomes.

use std::fs;

use nalgebra::{Point3, Vector3};
use occlabel_core::camera::CameraModel;
use occlabel_core::{ClassId, PointLabel};
use occlabel_logs::{CodaLog, Inventory, ReadOptions, SceneSource};

use crate::log::{POINTS, POSES, boxed, boxes, load, open, options, put, remove, taxonomy, tiny};

#[test]
fn frames_are_sweeps_at_the_lidars_poses_and_those_with_boxes_are_keyframes() {
    let root = tiny();
    let scene = load(&root).unwrap();
    let times: Vec<i64> = scene.sweeps.iter().map(|sweep| sweep.time.0).collect();
    let first = 1_673_884_185_589_118_000;
    assert_eq!(times, [first, first + 100_000_000, first + 200_000_000]);
    let seen = Point3::new(10.0, 1.0, -0.5);
    let expected = [[15.0, 1.0, -0.5], [17.0, 1.0, -0.5], [6.0, 10.0, -0.5]].map(Point3::from);
    for (sweep, expected) in scene.sweeps.iter().zip(expected) {
        let found = sweep.world_from_lidar() * seen;
        assert!((found - expected).norm() < 1e-6, "{}: {found}, {expected}", sweep.source_id);
        assert_eq!(sweep.world_from_ego, sweep.world_from_lidar(), "the ego frame is the lidar's");
    }
    let labelled: Vec<bool> = scene.sweeps.iter().map(|sweep| sweep.labelled).collect();
    assert_eq!(labelled, [false, true, false]);
    let keys: Vec<_> = scene.keyframes.iter().map(|key| (key.sweep, key.token.clone())).collect();
    let tokens = [1, 2].map(|sweep| (sweep, scene.sweeps[sweep].time.0.to_string()));
    assert_eq!(keys, tokens);
    assert!(scene.refused.is_empty() && scene.warnings.is_empty(), "{:?}", scene.warnings);
    let inventory = Inventory::take(&open(&root), root.path(), &scene);
    assert_eq!((inventory.present.len(), inventory.missing.len()), (4, 0));
    assert_eq!(open(&root).tables().len(), 8, "poses, times, calibrations, boxes");
}

#[test]
fn poses_in_the_frame_of_all_sequences_go_before_those_in_their_own() {
    let root = tiny();
    put(&root, "poses/dense_global/7.txt", POSES.replace(" 5 0 0 1", " 105 0 0 1"));
    let scene = load(&root).unwrap();
    assert_eq!(scene.sweeps[0].world_from_ego.translation.x, 105.0);
    assert!(open(&root).tables().contains(&"poses/dense_global/7.txt".to_owned()));
}

#[test]
fn the_older_name_of_times_is_read_too() {
    let root = tiny();
    let times = fs::read(root.path().join("timestamps/7.txt")).unwrap();
    remove(&root, "timestamps/7.txt");
    put(&root, "timestamps/7_frame_to_ts.txt", times);
    assert_eq!(load(&root).unwrap().sweeps.len(), 3);
}

#[test]
fn compensated_points_go_before_raw_ones_which_are_told() {
    let root = tiny();
    let points = fs::read(root.path().join("3d_comp/os1/7/3d_comp_os1_7_0.bin")).unwrap();
    put(&root, "3d_raw/os1/7/3d_raw_os1_7_0.bin", &points);
    assert!(load(&root).unwrap().sweeps[0].file.starts_with("3d_comp/"));
    fs::remove_dir_all(root.path().join("3d_comp")).unwrap();
    let scene = load(&root).unwrap();
    assert_eq!(scene.sweeps[0].file, "3d_raw/os1/7/3d_raw_os1_7_0.bin");
    let rules: Vec<_> = scene.warnings.iter().map(|warning| warning.rule).collect();
    assert_eq!(rules, ["sweep-motion"]);
    assert_eq!(Inventory::take(&open(&root), root.path(), &scene).missing.len(), 2);
}

#[test]
fn sequences_stand_in_order_of_their_numbers() {
    let root = tiny();
    for name in ["10", "9"] {
        put(&root, &format!("3d_raw/os1/{name}/3d_raw_os1_{name}_0.bin"), "");
    }
    assert_eq!(open(&root).scene_names(), ["7", "9", "10"]);
    let wanted = |name: &str| ReadOptions { scenes: Some([name.to_owned()].into()), ..options() };
    let log = CodaLog::open(root.path(), wanted("9")).unwrap();
    assert_eq!(log.scene_names(), ["9"]);
    let fault = CodaLog::open(root.path(), wanted("11")).unwrap_err();
    assert!(fault.rule == "scene-unknown" && fault.to_string().contains("`10`"), "{fault}");
}

#[test]
fn boxes_stand_in_the_lidars_frame_of_their_frame() {
    let scene = load(&tiny()).unwrap();
    let ids: Vec<_> = scene.tracks.iter().map(|track| track.source_id.as_str()).collect();
    assert_eq!(ids, ["Car:1", "Fire Hydrant:1"]);
    let car = &scene.tracks[0];
    assert_eq!((car.category.as_str(), car.boxes.len()), ("Car", 2));
    // 3 m ahead, a yaw of 0.5; the second time after the robot turned by a quarter.
    for ((_, boxed), (centre, yaw)) in
        car.boxes.iter().zip([([10.0, 0.0, 0.1], 0.5), ([7.0, 3.0, 0.1], 0.5 + 1.570_796_3)])
    {
        let pose = &boxed.world_from_box;
        assert!((pose.translation.vector - Vector3::from(centre)).norm() < 1e-6, "{pose}");
        let ahead = pose * Vector3::x();
        let expected = Vector3::new(libm::cos(yaw), libm::sin(yaw), 0.0);
        assert!((ahead - expected).norm() < 1e-6, "{ahead}");
        assert_eq!(boxed.size_m, Vector3::new(4.0, 2.0, 1.5));
    }
}

/// An id that was not seen for more than 30 frames is another object's: no box moves from one to the other.
#[test]
fn an_id_that_comes_back_after_long_is_another_track() {
    let root = tiny();
    let lines = |line: &dyn Fn(usize) -> String| (0..60).map(line).collect::<String>();
    put(&root, "poses/dense/7.txt", lines(&|n| format!("{}.0 {n} 0 0 1 0 0 0\n", n)));
    put(&root, "timestamps/7.txt", lines(&|n| format!("{n}.0\n")));
    put(&root, "3d_bbox/os1/7/3d_bbox_os1_7_40.json", boxes(&[boxed("Car", "Car:1", 0.0)]));
    let scene = load(&root).unwrap();
    let tracks: Vec<_> =
        scene.tracks.iter().map(|track| (&track.source_id[..], track.boxes.len())).collect();
    assert_eq!(tracks, [("Car:1", 2), ("Car:1 from frame 40", 1), ("Fire Hydrant:1", 1)]);
}

#[test]
fn a_label_is_a_byte_and_no_terrain_is_a_class_where_the_taxonomy_has_one() {
    let root = tiny();
    let (log, scene) = (open(&root), load(&root).unwrap());
    let read = log.read_sweep(&scene.sweeps[1]).unwrap();
    let [other, road, terrain] = [0, 16, 18].map(|id| PointLabel::Class(ClassId(id)));
    assert_eq!(read.cloud.labels, [road, other, PointLabel::Unlabelled, terrain]);
    for (point, [x, y, z, _]) in read.cloud.positions.iter().zip(POINTS) {
        assert_eq!(*point, Point3::new(x, y, z).cast::<f64>());
    }
    let bare = log.read_sweep(&scene.sweeps[2]).unwrap();
    assert_eq!(bare.cloud.labels, [PointLabel::Unlabelled; 4]);
    let cityscapes = include_str!("../../../../configs/taxonomies/mobileocc.toml");
    let log = CodaLog::open(root.path(), ReadOptions::of(taxonomy(cityscapes))).unwrap();
    let read = log.read_sweep(&log.load("7").unwrap().sweeps[1]).unwrap();
    assert_eq!(read.cloud.labels[1], PointLabel::Unlabelled);
    assert_eq!(read.cloud.labels[0], PointLabel::Class(ClassId(0)));
}

#[test]
fn cameras_are_exposed_at_every_frame_as_the_lidar_triggers_them() {
    let root = tiny();
    let scene = load(&root).unwrap();
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["cam0", "cam1"]);
    let camera = &scene.cameras[0].camera;
    assert!(matches!(camera.model, CameraModel::BrownConrady(_)));
    assert_eq!((camera.width, camera.height), (1224, 1024));
    for keyframe in &scene.keyframes {
        assert_eq!(keyframe.exposures.len(), 2);
        let exposure = &keyframe.exposures[0];
        assert!(exposure.time == keyframe.time && exposure.image.is_none());
        // Straight ahead of the camera, on its axis.
        let lidar = scene.sweeps[keyframe.sweep].world_from_lidar();
        let seen = exposure.world_from_camera.inverse() * lidar * Point3::new(8.0, 0.1, -0.2);
        assert!((seen - Point3::new(0.0, 0.0, 8.0)).norm() < 1e-6, "{seen}");
    }
}

#[test]
fn raw_images_are_seen_through_the_lens_and_rectified_ones_through_a_pinhole() {
    let root = tiny();
    put(&root, "2d_rect/cam1/7/2d_rect_cam1_7_1.jpg", "a");
    put(&root, "2d_raw/cam0/7/2d_raw_cam0_7_2.png", "b");
    put(&root, "2d_rect/cam0/7/2d_rect_cam0_7_1.jpg", "c");
    let (log, scene) = (open(&root), load(&root).unwrap());
    let [raw, rectified] = [0, 1].map(|at| &scene.cameras[at].camera.model);
    assert!(matches!(raw, CameraModel::BrownConrady(_)));
    assert_eq!(rectified.project(&Point3::new(0.5, 0.0, 1.0)).unwrap().x, 912.0);
    let image = |keyframe: usize, camera: usize| {
        let exposure = &scene.keyframes[keyframe].exposures[camera];
        log.read_image(&scene, exposure).unwrap()
    };
    assert_eq!([image(0, 0), image(0, 1)], [None, Some(b"a".to_vec())]);
    assert_eq!([image(1, 0), image(1, 1)], [Some(b"b".to_vec()), None]);
}
