//! What a sound log becomes.

use nalgebra::{Point3, Vector3};
use occlabel_core::Timestamp;
use occlabel_core::camera::CameraModel;
use occlabel_logs::{Inventory, Kitti360Log, SceneSource};

use crate::log::{
    BEGIN_NS, DRIVE, bare, is_there, load, object, open, put, put_boxes, stamps, told,
};

#[test]
fn the_layout_is_told_by_its_folder_of_raw_points() {
    let root = bare();
    assert!(Kitti360Log::is_log(root.path()));
    assert!(!Kitti360Log::is_log(&root.path().join("calibration")));
    assert_eq!(open(&root).scene_names(), [DRIVE]);
}

#[test]
fn the_ego_stands_on_the_road_below_the_imu_and_points_follow_the_poses() {
    let scene = load(&bare()).unwrap();
    for (frame, sweep) in scene.sweeps.iter().enumerate() {
        let ego = sweep.world_from_ego * Point3::origin();
        let expected = Point3::new(frame as f64, 50.0, 100.93 - 0.93);
        assert!((ego - expected).norm() < 1e-9, "{frame}: {ego}");
        let seen = sweep.world_from_lidar() * Point3::new(10.0, 2.0, -1.73);
        assert!((seen - Point3::new(frame as f64 + 10.0, 52.0, 100.0)).norm() < 1e-9, "{seen}");
    }
}

#[test]
fn a_frame_without_a_pose_stands_between_its_neighbours_and_is_told() {
    let root = bare();
    let scene = load(&root).unwrap();
    let times: Vec<i64> = scene.sweeps.iter().map(|sweep| sweep.time.0 - BEGIN_NS).collect();
    assert_eq!(times, [0, 100_000_000, 200_000_000, 300_000_000, 400_000_000]);
    assert_eq!((scene.keyframes.len(), scene.tracks.len()), (5, 0));
    assert!(told(&scene).contains(&"pose-between"), "{:?}", scene.warnings);
    let of = |frames: &[usize]| {
        let line = |frame: &usize| format!("{frame} 1 0 0 {frame} 0 -1 0 50 0 0 -1 100.93\n");
        let lines: String = frames.iter().map(line).collect();
        put(&root, &format!("data_poses/{DRIVE}/poses.txt"), lines);
        load(&root).unwrap()
    };
    let scene = of(&[1, 2]);
    assert_eq!((scene.sweeps.len(), scene.keyframes.len()), (2, 2));
    let left_out = scene.warnings.iter().find(|fault| fault.rule == "pose-absent").unwrap();
    assert!(left_out.to_string().contains("the first of 3 such records"), "{left_out}");
}

#[test]
fn poses_of_camera_0_serve_where_there_are_none_of_the_imu() {
    let root = bare();
    let whole = load(&root).unwrap();
    std::fs::remove_file(root.path().join(format!("data_poses/{DRIVE}/poses.txt"))).unwrap();
    // Camera 0 looks east, its right is south, 0.6 m above the IMU.
    let pose = |x: usize| format!("{x} 0 0 1 {x} -1 0 0 50 0 -1 0 101.53 0 0 0 1\n");
    let file = format!("data_poses/{DRIVE}/cam0_to_world.txt");
    put(&root, &file, [0, 1, 3, 4].map(pose).concat());
    let scene = load(&root).unwrap();
    assert_eq!(scene.sweeps.len(), 5);
    for (a, b) in scene.sweeps.iter().zip(&whole.sweeps) {
        let off = a.world_from_ego.inverse() * b.world_from_ego;
        assert!(off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-9, "{off}");
    }
    assert!(open(&root).tables().contains(&file) && is_there(root.path(), &file));
}

#[test]
fn boxes_of_what_may_move_are_tracks_at_a_frame_or_over_a_span() {
    let root = bare();
    let objects = [
        object(13, 7, [0, 4, 1], [20.0, 50.0, 100.75]),
        object(13, 7, [0, 4, 3], [22.0, 50.0, 100.75]),
        object(13, 9, [2, 3, -1], [5.0, 55.0, 100.75]),
        object(11, 1, [0, 4, -1], [5.0, 70.0, 105.0]),
    ];
    put_boxes(&root, &objects);
    let scene = load(&root).unwrap();
    let named: Vec<_> =
        scene.tracks.iter().map(|t| (t.source_id.as_str(), t.category.as_str())).collect();
    assert_eq!(named, [("car-7", "car"), ("car-9", "car")]);
    let at = |frame: i64| Timestamp(BEGIN_NS + frame * 100_000_000);
    let times = |track: usize| -> Vec<Timestamp> {
        scene.tracks[track].boxes.iter().map(|(time, _)| *time).collect()
    };
    assert_eq!((times(0), times(1)), (vec![at(1), at(3)], vec![at(2), at(3)]));
    let (_, moving) = &scene.tracks[0].boxes[1];
    // The cube's x is 4 m long and points north, its y 2 m and points west.
    assert!((moving.size_m - Vector3::new(4.0, 2.0, 1.5)).norm() < 1e-9);
    let front = moving.world_from_box * Point3::new(2.0, 0.0, 0.0);
    assert!((front - Point3::new(22.0, 52.0, 100.75)).norm() < 1e-9, "{front}");
}

#[test]
fn cameras_are_two_pinholes_and_fisheyes_exposed_at_their_images_times() {
    let root = bare();
    put(&root, &format!("data_2d_raw/{DRIVE}/image_00/timestamps.txt"), stamps());
    let scene = load(&root).unwrap();
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["image_00", "image_01", "image_02"]);
    assert!(matches!(scene.cameras[2].camera.model, CameraModel::Mei(_)));
    assert_eq!(told(&scene).iter().filter(|rule| **rule == "camera-absent").count(), 3);
    // The frame without a pose borrows its neighbour's image, 0.1 s away.
    let seen: Vec<usize> = scene.keyframes.iter().map(|key| key.exposures.len()).collect();
    assert_eq!(seen, [1; 5]);
    let exposure = &scene.keyframes[1].exposures[0];
    let p_camera = exposure.world_from_camera.inverse() * Point3::new(11.0, 49.0, 101.53);
    assert!((p_camera - Point3::new(1.0, 0.0, 10.0)).norm() < 1e-9, "{p_camera}");
}

#[test]
fn images_are_the_files_of_their_frames_or_none() {
    let root = bare();
    put(&root, &format!("data_2d_raw/{DRIVE}/image_00/timestamps.txt"), stamps());
    put(&root, &format!("data_2d_raw/{DRIVE}/image_02/timestamps.txt"), stamps());
    put(&root, &format!("data_2d_raw/{DRIVE}/image_00/data_rect/0000000003.png"), "ahead");
    put(&root, &format!("data_2d_raw/{DRIVE}/image_02/data_rgb/0000000003.png"), "aside");
    let (log, scene) = (open(&root), load(&root).unwrap());
    let images = |keyframe: usize| -> Vec<Option<Vec<u8>>> {
        let exposures = scene.keyframes[keyframe].exposures.iter();
        exposures.map(|exposure| log.read_image(&scene, exposure).unwrap()).collect()
    };
    assert_eq!(images(3), [Some(b"ahead".to_vec()), Some(b"aside".to_vec())]);
    assert_eq!(images(4), [None, None]);
}

#[test]
fn the_files_of_a_scene_are_listed() {
    let root = bare();
    let (log, scene) = (open(&root), load(&root).unwrap());
    let inventory = Inventory::take(&log, root.path(), &scene);
    assert_eq!((inventory.present.len(), inventory.missing.len()), (5, 0));
    assert_eq!(log.scene_points(&scene), 20);
    assert_eq!(log.tables().len(), 5);
}
