//! Logs that others wrote: points, poses, boxes and calibrations are those of their sources.

use nalgebra::{Point3, Vector3};
use occlabel_core::{
    BoxTrack, McapSettings, PointCloud, PointLabel, Scene, SweepHeader, Timestamp,
};
use occlabel_logs::{McapOptions, SceneSource, TimeSource};
use serde_json::Value;

use crate::support::{apart, expected, folder_of, open, options, shared};

fn mean(cloud: &PointCloud<PointLabel>) -> Point3<f64> {
    let sum: Vector3<f64> = cloud.positions.iter().map(|point| point.coords).sum();
    Point3::from(sum / cloud.len() as f64)
}

fn point(value: &Value) -> Point3<f64> {
    Point3::new(value[0].as_f64().unwrap(), value[1].as_f64().unwrap(), value[2].as_f64().unwrap())
}

#[test]
fn ros2_cdr_gives_sweeps_poses_and_optics() {
    let Some(file) = shared("mcap/kitti0002_ros2.mcap") else { return };
    let folder = folder_of(&file);
    let log = open(folder.path(), options(&[], McapSettings::default()));
    let (scene, expected) =
        (log.load("kitti0002_ros2").unwrap(), expected("mcap/kitti0002_ros2.expected.json"));
    assert!(scene.refused.is_empty(), "{:?}", scene.refused);
    let sweeps = expected["sweeps"].as_array().unwrap();
    assert_eq!((scene.sweeps.len(), sweeps.len()), (8, 8));
    for (sweep, told) in scene.sweeps.iter().zip(sweeps) {
        assert_eq!(Some(sweep.time.0), told["stamp_ns"].as_i64());
        assert_eq!(sweep.lidar, "velo_link");
        let off = apart(&sweep.world_from_lidar(), &told["map_from_velo_link"]);
        assert!(off < 1e-6, "{off}");
        let cloud = log.read_sweep(sweep).unwrap().cloud;
        assert_eq!(Some(cloud.len() as u64), told["points"].as_u64());
        assert!((cloud.positions[0] - point(&told["first_point"])).norm() < 1e-6);
        let in_map = sweep.world_from_lidar() * mean(&cloud);
        let off = (in_map - point(&told["mean_in_map"])).norm();
        assert!(off < 1e-6, "{off}");
    }
    let points: u64 = sweeps.iter().filter_map(|told| told["points"].as_u64()).sum();
    assert_eq!(log.scene_points(&scene), points);
    let camera = &scene.cameras[0].camera;
    assert_eq!((camera.width, camera.height, camera.model.name()), (1242, 375, "pinhole"));
    let matrix = camera.model.intrinsics().unwrap().matrix();
    let told = expected["camera"]["K"].as_array().unwrap();
    assert!(matrix.as_flattened().iter().zip(told).all(|(a, b)| Some(*a) == b.as_f64()));
    let (keyframe, reference) = (&scene.keyframes[2], &scene.sweeps[scene.keyframes[2].sweep]);
    assert_eq!((scene.keyframes.len(), keyframe.exposures.len()), (8, 1));
    let lidar_from_world = reference.world_from_lidar().inverse();
    let lidar_from_camera = lidar_from_world * keyframe.exposures[0].world_from_camera;
    let off = apart(&lidar_from_camera, &expected["camera"]["velo_link_from_camera"]);
    assert!(off < 0.2, "the camera was exposed within 0.1 s: {off}");
}

#[test]
fn ros2_images_are_those_of_the_exposures() {
    let Some(file) = shared("mcap/kitti0002_ros2.mcap") else { return };
    let folder = folder_of(&file);
    let log = open(folder.path(), options(&[], McapSettings::default()));
    let scene = log.load("kitti0002_ros2").unwrap();
    let mut images = Vec::new();
    for exposure in scene.keyframes.iter().flat_map(|keyframe| &keyframe.exposures) {
        let Some(image) = log.read_image(&scene, exposure).unwrap() else { continue };
        let size = image_size(&image);
        assert_eq!(size, (1242, 375));
        images.push((exposure.time, image));
    }
    images.dedup();
    let times: std::collections::BTreeSet<Timestamp> =
        images.iter().map(|(time, _)| *time).collect();
    assert_eq!((images.len(), times.len()), (3, 3), "three images were recorded");
}

/// Width and height that the head of a PNG tells.
fn image_size(png: &[u8]) -> (u32, u32) {
    assert_eq!(&png[1..4], b"PNG");
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn foxglove_protobuf_gives_sweeps_and_boxes_with_their_points() {
    let Some(file) = shared("mcap/av2_foxglove.mcap") else { return };
    let folder = folder_of(&file);
    let log = open(folder.path(), options(&[], McapSettings::default()));
    let (scene, expected) =
        (log.load("av2_foxglove").unwrap(), expected("mcap/av2_foxglove.expected.json"));
    assert!(scene.refused.is_empty(), "{:?}", scene.refused);
    let sweeps = expected["sweeps"].as_array().unwrap();
    assert_eq!((scene.sweeps.len(), scene.cameras.len()), (4, 9));
    let mut in_world = Vec::new();
    for told in sweeps {
        let lidar = told["topic"].as_str().unwrap().trim_start_matches("/lidar/");
        let is_it = |sweep: &&SweepHeader| {
            Some(sweep.time.0) == told["timestamp_ns"].as_i64() && sweep.lidar == lidar
        };
        let sweep = scene.sweeps.iter().find(is_it).unwrap();
        let off = apart(&sweep.world_from_lidar(), &told["map_from_lidar"]);
        assert!(off < 1e-6, "{off}");
        let cloud = log.read_sweep(sweep).unwrap().cloud;
        assert_eq!(Some(cloud.len() as u64), told["points"].as_u64());
        let off = (sweep.ego_from_lidar * mean(&cloud) - point(&told["mean_in_base_link"])).norm();
        assert!(off < 1e-6, "{off}");
        let place = sweep.world_from_lidar();
        in_world.extend(cloud.positions.iter().map(|point| (sweep.time, place * point)));
    }
    assert_boxes_hold_their_points(&scene, &expected["boxes"], &in_world);
}

fn assert_boxes_hold_their_points(
    scene: &Scene,
    boxes: &Value,
    in_world: &[(Timestamp, Point3<f64>)],
) {
    let boxes = boxes.as_array().unwrap();
    assert_eq!(boxes.len(), 162);
    for told in boxes {
        let is_it = |track: &&BoxTrack| told["id"] == track.source_id.as_str();
        let track = scene.tracks.iter().find(is_it).unwrap();
        assert_eq!(told["category"], track.category.as_str());
        let at = told["timestamp_ns"].as_i64();
        let (time, boxed) = track.boxes.iter().find(|(time, _)| Some(time.0) == at).unwrap();
        let center = Point3::from(boxed.world_from_box.translation.vector);
        assert!((center - point(&told["center_map"])).norm() < 1e-6);
        let (inverse, half) = (boxed.world_from_box.inverse(), boxed.size_m / 2.0);
        let inside = in_world.iter().filter(|(then, point)| {
            let p = inverse * point;
            then == time && (0..3).all(|axis| p[axis].abs() <= half[axis])
        });
        assert_eq!(Some(inside.count() as u64), told["num_interior_pts"].as_u64(), "{told}");
    }
}

#[test]
fn a_description_names_topics_and_frames_and_fills_the_table_in() {
    let Some(file) = shared("mcap/kitti0002_ros2.mcap") else { return };
    let folder = folder_of(&file);
    let log = open(folder.path(), options(&[], McapSettings::default()));
    let lines = log.describe("kitti0002_ros2").unwrap();
    for line in [
        "/kitti/velo/pointcloud: cdr sensor_msgs/msg/PointCloud2, sweeps",
        "/tf_static: cdr tf2_msgs/msg/TFMessage, transforms",
        "frame base_link in map: 10 poses",
        "frame velo_link in imu_link: fixed",
        "world_frame = \"map\"",
        "ego_frame = \"base_link\"",
        "\"/kitti/velo/pointcloud\" = \"velo_link\"",
    ] {
        assert!(lines.iter().any(|found| found == line), "no {line} in {lines:#?}");
    }
}

#[test]
fn fault_33_a_file_without_its_end_is_read_with_recover_only() {
    let Some(file) = shared("mcap/kitti0002_ros2.mcap") else { return };
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(file).unwrap();
    std::fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() * 3 / 4]).unwrap();
    let strict = options(&[], McapSettings::default());
    let recovering = McapOptions { recover: true, ..strict.clone() };
    let fault = open(folder.path(), strict).load("cut").unwrap_err();
    assert!(fault.offset.is_some() && fault.hint.is_some(), "{fault}");
    let scene = open(folder.path(), recovering).load("cut").unwrap();
    assert!((1..8).contains(&scene.sweeps.len()), "{}", scene.sweeps.len());
    assert!(!scene.refused.is_empty());
}

#[test]
fn fault_17_the_log_s_time_counts_if_it_is_asked_for() {
    let Some(file) = shared("mcap/kitti0002_ros2.mcap") else { return };
    let folder = folder_of(&file);
    let header = options(&[], McapSettings::default());
    let log = McapOptions { time_source: TimeSource::Log, ..header.clone() };
    let times = |options| {
        let scene = open(folder.path(), options).load("kitti0002_ros2").unwrap();
        scene.sweeps.into_iter().map(|sweep| sweep.time.0).collect::<Vec<_>>()
    };
    let (header, log) = (times(header), times(log));
    let later = log.iter().zip(&header).map(|(log, header)| log - header);
    assert!(later.into_iter().all(|ns| (61_000_000..63_000_000).contains(&ns)), "{log:?}");
}
