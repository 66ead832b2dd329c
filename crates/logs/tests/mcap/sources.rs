//! Logs that others converted: their numbers are those of the logs they were converted from.

use std::path::Path;

use nalgebra::Point3;
use occlabel_core::{McapSettings, Pose, Scene};
use occlabel_logs::{McapLog, SceneSource};

use crate::support::{apart, expected, folder_of, open, options, shared};

/// Numbers are doubles all the way; metres, or a rotation's cells.
const TOLERANCE: f64 = 1e-6;

/// The log with the ego's frame as its world: cameras then stand where they are mounted.
fn mountings(folder: &Path) -> McapLog {
    let frame = || "base_link".to_owned();
    let settings =
        McapSettings { world_frame: frame(), ego_frame: frame(), ..McapSettings::default() };
    open(folder, options(&[], settings))
}

/// Where a camera is mounted, and how many exposures say so.
fn mounting(scene: &Scene, name: &str) -> (Pose, usize) {
    let camera = scene.cameras.iter().position(|camera| camera.name == name).unwrap();
    let exposures = scene.keyframes.iter().flat_map(|keyframe| &keyframe.exposures);
    let poses: Vec<Pose> =
        exposures.filter(|e| e.camera == camera).map(|e| e.world_from_camera).collect();
    assert!(poses.iter().all(|pose| *pose == poses[0]), "{name}");
    (poses[0], poses.len())
}

#[test]
fn kitti_points_are_those_of_its_files() {
    let (Some(file), Some(raw)) = (shared("mcap/kitti0002_ros2.mcap"), shared("kitti_raw")) else {
        return;
    };
    let folder = folder_of(&file);
    let log = open(folder.path(), options(&[], McapSettings::default()));
    let scene = log.load("kitti0002_ros2").unwrap();
    let scans = raw.join("2011_09_26/2011_09_26_drive_0002_sync/velodyne_points/data");
    let mut points = 0;
    for (sweep, number) in scene.sweeps.iter().zip(1..) {
        let bytes = std::fs::read(scans.join(format!("{number:010}.bin"))).unwrap();
        let (numbers, _) = bytes.as_chunks::<4>();
        let numbers: Vec<f64> = numbers.iter().map(|b| f32::from_le_bytes(*b).into()).collect();
        let every_second = numbers.chunks(4).step_by(2);
        let source: Vec<_> = every_second.map(|p| Point3::new(p[0], p[1], p[2])).collect();
        let cloud = log.read_sweep(sweep).unwrap().cloud;
        assert_eq!(cloud.positions, source, "scan {number}");
        points += cloud.len();
    }
    assert_eq!(points, 483_571);
}

#[test]
fn kitti_s_camera_stands_where_its_calibration_says() {
    let Some(file) = shared("mcap/kitti0002_ros2.mcap") else { return };
    let folder = folder_of(&file);
    let scene = mountings(folder.path()).load("kitti0002_ros2").unwrap();
    let (ego_from_camera, exposures) = mounting(&scene, "camera_color_left");
    assert_eq!(exposures, 8);
    let lidar_from_camera = scene.sweeps[0].ego_from_lidar.inverse() * ego_from_camera;
    let told = &expected("mcap/kitti0002_ros2.expected.json")["camera"]["velo_link_from_camera"];
    let off = apart(&lidar_from_camera, told);
    assert!(off < TOLERANCE, "{off}");
}

#[cfg(feature = "av2")]
mod argoverse2 {
    use std::collections::BTreeMap;
    use std::fs::File;

    use arrow_array::Array;
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, Int64Type, UInt16Type, UInt32Type};
    use arrow_ipc::reader::FileReader;
    use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
    use occlabel_core::{BoxTrack, SweepHeader};
    use occlabel_logs::Argoverse2Log;

    use super::*;

    const LOG: &str = "7fab2350-7eaf-3b7e-a39d-6937a4c1bede";
    /// What 32-bit numbers round off, as a share.
    const ROUNDING: f64 = 1e-7;

    /// The same drive as MCAP and as it was published.
    fn logs() -> Option<(tempfile::TempDir, McapLog, Argoverse2Log)> {
        let (file, root) = (shared("mcap/av2_foxglove.mcap")?, shared("argoverse2/sensor/val")?);
        let folder = folder_of(&file);
        let log = open(folder.path(), options(&[], McapSettings::default()));
        let read = options(&[], McapSettings::default()).read;
        let source = Argoverse2Log::open(&root.join(LOG), read).unwrap();
        Some((folder, log, source))
    }

    /// The points of both lidars in world, each in the order of the published file.
    fn published(source: &Argoverse2Log, sweep: &SweepHeader) -> [Vec<Point3<f64>>; 2] {
        let cloud = source.read_sweep(sweep).unwrap().cloud;
        let of = |lidar: usize| {
            let all = cloud.positions.iter().enumerate();
            let own = all.filter(|(point, _)| cloud.origin_of[*point] as usize == lidar);
            own.map(|(_, point)| sweep.world_from_lidar() * point).collect()
        };
        [of(0), of(1)]
    }

    #[test]
    fn points_and_poses_are_those_of_the_published_log() {
        let Some((_folder, log, source)) = logs() else { return };
        let (scene, theirs) = (log.load("av2_foxglove").unwrap(), source.load(LOG).unwrap());
        let mut points = 0;
        for sweep in &theirs.sweeps {
            for (lidar, published) in
                ["up_lidar", "down_lidar"].iter().zip(published(&source, sweep))
            {
                let is_it = |s: &&SweepHeader| s.time == sweep.time && s.lidar == *lidar;
                let own = scene.sweeps.iter().find(is_it).unwrap();
                let off =
                    own.world_from_ego.to_homogeneous() - sweep.world_from_ego.to_homogeneous();
                assert!(off.amax() < TOLERANCE, "{lidar}: {off}");
                let cloud = log.read_sweep(own).unwrap().cloud;
                assert_eq!(cloud.len(), published.len());
                for (a, b) in cloud.positions.iter().zip(&published) {
                    let off = (own.world_from_lidar() * a - b).norm();
                    assert!(off < TOLERANCE + ROUNDING * a.coords.norm(), "{lidar}: {off} m");
                }
                points += cloud.len();
            }
        }
        assert_eq!(points, 99_229 + 99_466);
    }

    #[test]
    fn boxes_are_those_of_the_published_log() {
        let Some((_folder, log, source)) = logs() else { return };
        let (scene, theirs) = (log.load("av2_foxglove").unwrap(), source.load(LOG).unwrap());
        let mut boxes = 0;
        for track in &scene.tracks {
            let is_it = |other: &&BoxTrack| other.source_id == track.source_id;
            let other = theirs.tracks.iter().find(is_it).unwrap();
            assert_eq!(track.category, other.category);
            for (time, boxed) in &track.boxes {
                let (_, same) = other.boxes.iter().find(|(at, _)| at == time).unwrap();
                let (a, b) = (&boxed.world_from_box, &same.world_from_box);
                let off = (a.to_homogeneous() - b.to_homogeneous()).amax();
                let size_off = (boxed.size_m - same.size_m).amax();
                assert!(off < TOLERANCE && size_off < TOLERANCE, "{off} {size_off}");
                boxes += 1;
            }
        }
        assert!(boxes > 900, "{boxes}");
    }

    /// Numbers of a published table, by sensor.
    fn table(name: &str, columns: &[&str]) -> BTreeMap<String, Vec<f64>> {
        let path = shared(&format!("argoverse2/sensor/val/{LOG}/calibration/{name}")).unwrap();
        let mut rows = BTreeMap::new();
        for batch in FileReader::try_new(File::open(path).unwrap(), None).unwrap() {
            let batch = batch.unwrap();
            let sensors = batch.column_by_name("sensor_name").unwrap().as_string::<i32>();
            let number = |column: &&str, row: usize| {
                let column = batch.column_by_name(column).unwrap();
                let sides = column.as_primitive_opt::<UInt16Type>().map(|c| c.value(row).into());
                sides
                    .or(column.as_primitive_opt::<UInt32Type>().map(|c| c.value(row).into()))
                    .or(column.as_primitive_opt::<Int64Type>().map(|c| c.value(row) as f64))
                    .or(column.as_primitive_opt::<Float64Type>().map(|c| c.value(row)))
                    .unwrap_or_else(|| panic!("a column of {}", column.data_type()))
            };
            for (row, sensor) in sensors.iter().enumerate() {
                let numbers = columns.iter().map(|column| number(column, row)).collect();
                rows.insert(sensor.unwrap().to_owned(), numbers);
            }
        }
        rows
    }

    #[test]
    fn calibrations_are_those_of_the_published_log() {
        let Some((folder, ..)) = logs() else { return };
        let lenses = ["fx_px", "fy_px", "cx_px", "cy_px", "width_px", "height_px"];
        let lenses = table("intrinsics.feather", &lenses);
        let places = ["tx_m", "ty_m", "tz_m", "qw", "qx", "qy", "qz"];
        let places = table("egovehicle_SE3_sensor.feather", &places);
        let scene = mountings(folder.path()).load("av2_foxglove").unwrap();
        assert_eq!(scene.cameras.len(), 9);
        for named in &scene.cameras {
            let camera = &named.camera;
            let lens = camera.model.intrinsics().unwrap().matrix();
            let (width, height) = (f64::from(camera.width), f64::from(camera.height));
            let found = [lens[0][0], lens[1][1], lens[0][2], lens[1][2], width, height];
            let off = found.iter().zip(&lenses[&named.name]).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < TOLERANCE, "{}: {found:?}", named.name);
            let numbers = &places[&named.name];
            let rotation = Quaternion::new(numbers[3], numbers[4], numbers[5], numbers[6]);
            let place = Translation3::new(numbers[0], numbers[1], numbers[2]);
            let place = Isometry3::from_parts(place, UnitQuaternion::new_normalize(rotation));
            let (found, exposures) = mounting(&scene, &named.name);
            let off = (found.to_homogeneous() - place.to_homogeneous()).amax();
            assert!(off < TOLERANCE && exposures == 2, "{}: {off} {exposures}", named.name);
        }
    }
}
