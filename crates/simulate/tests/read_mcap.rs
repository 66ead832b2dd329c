//! A tiny drive, written as nuScenes and as MCAP: both logs give the same scene, to the bit.

use std::path::Path;

use occlabel_core::{McapSettings, Scene, Taxonomy};
use occlabel_logs::{
    McapLog, McapOptions, NuScenesLog, NuScenesOptions, QuaternionOrder, ReadOptions, SceneSource,
    TimeSource,
};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, Images, Output, World, write_mcap, write_nuscenes};
use tempfile::TempDir;

const TINY: &str = include_str!("tiny.toml");

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

fn read() -> ReadOptions {
    ReadOptions::of(taxonomy())
}

fn nuscenes(drive: &Drive, images: Images, root: &Path) -> NuScenesLog {
    let output = Output::create(root).unwrap();
    let drives = std::slice::from_ref(drive);
    let (_, last) = write_nuscenes(drives, &taxonomy(), images, &output).unwrap();
    output.finish(last).unwrap();
    let options = NuScenesOptions {
        read: read(),
        version: None,
        quaternion_order: QuaternionOrder::default(),
        columns: None,
    };
    NuScenesLog::open(root, options).unwrap()
}

fn mcap(drive: &Drive, images: Images, root: &Path) -> McapLog {
    let output = Output::create(root).unwrap();
    let (_, last) = write_mcap(drive, &taxonomy(), images, &output).unwrap();
    output.finish(&last).unwrap();
    let options = McapOptions {
        read: read(),
        settings: McapSettings::default(),
        time_source: TimeSource::Header,
        recover: false,
    };
    McapLog::open(root, options).unwrap()
}

fn logs(images: Images) -> (TempDir, NuScenesLog, McapLog) {
    let world = World::parse(TINY, "tiny.toml").unwrap();
    let drive = Drive::new(world, &taxonomy()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("nuscenes"), folder.path().join("mcap"));
    let logs = (nuscenes(&drive, images, &a), mcap(&drive, images, &b));
    (folder, logs.0, logs.1)
}

#[test]
fn the_logs_of_one_drive_hold_the_same_scene() {
    let (_folder, nuscenes, mcap) = logs(Images::None);
    let (a, b) = (nuscenes.load("tiny").unwrap(), mcap.load("tiny").unwrap());
    assert!(b.warnings.is_empty() && b.refused.is_empty(), "{:?} {:?}", b.warnings, b.refused);
    assert_eq!(nuscenes.defaults().reference_lidar, mcap.defaults().reference_lidar);
    assert_eq!((a.sweeps.len(), b.sweeps.len()), (42, 42));
    let mut points = 0;
    for (a, b) in a.sweeps.iter().zip(&b.sweeps) {
        assert_eq!((a.time, &a.lidar, a.labelled), (b.time, &b.lidar, b.labelled));
        assert_eq!((a.world_from_ego, a.ego_from_lidar), (b.world_from_ego, b.ego_from_lidar));
        let (a, b) = (nuscenes.read_sweep(a).unwrap(), mcap.read_sweep(b).unwrap());
        assert!(b.warnings.is_empty(), "{:?}", b.warnings);
        assert_eq!(a.cloud, b.cloud);
        points += b.cloud.len();
    }
    assert!(points > 1000, "{points}");
    assert_same_tracks(&a, &b);
    assert_same_keyframes(&a, &b);
}

#[test]
fn an_exposures_image_is_the_same_bytes_in_both_logs() {
    let (folder, nuscenes, mcap) = logs(Images::All);
    let (a, b) = (nuscenes.load("tiny").unwrap(), mcap.load("tiny").unwrap());
    let mut seen = 0;
    for (a_key, b_key) in a.keyframes.iter().zip(&b.keyframes) {
        for (a_seen, b_seen) in a_key.exposures.iter().zip(&b_key.exposures) {
            let file = folder.path().join("nuscenes").join(a_seen.image.as_ref().unwrap());
            let bytes = std::fs::read(file).unwrap();
            assert_eq!(b_seen.image, None, "no file of its own");
            assert_eq!(nuscenes.read_image(&a, a_seen).unwrap(), Some(bytes.clone()));
            assert_eq!(mcap.read_image(&b, b_seen).unwrap(), Some(bytes));
            seen += 1;
        }
    }
    assert_eq!(seen, 5);
    let mut elsewhen = b.keyframes[0].exposures[0].clone();
    elsewhen.time.0 += 1_000_000_000_000;
    assert_eq!(mcap.read_image(&b, &elsewhen).unwrap(), None);
}

#[test]
fn without_images_there_are_none() {
    let (_folder, nuscenes, mcap) = logs(Images::None);
    let (a, b) = (nuscenes.load("tiny").unwrap(), mcap.load("tiny").unwrap());
    for (a_key, b_key) in a.keyframes.iter().zip(&b.keyframes) {
        assert_eq!(nuscenes.read_image(&a, &a_key.exposures[0]).unwrap(), None);
        assert_eq!(mcap.read_image(&b, &b_key.exposures[0]).unwrap(), None);
    }
}

fn assert_same_tracks(a: &Scene, b: &Scene) {
    assert_eq!(a.tracks.len(), b.tracks.len());
    for (a, b) in a.tracks.iter().zip(&b.tracks) {
        assert_eq!((a.id, &a.category, a.meaning), (b.id, &b.category, b.meaning));
        assert_eq!(a.boxes, b.boxes);
    }
}

fn assert_same_keyframes(a: &Scene, b: &Scene) {
    let cameras =
        |scene: &Scene| scene.cameras.iter().map(|named| named.camera.clone()).collect::<Vec<_>>();
    assert_eq!(cameras(a), cameras(b));
    assert_eq!((a.keyframes.len(), b.keyframes.len()), (5, 5));
    for (a, b) in a.keyframes.iter().zip(&b.keyframes) {
        assert_eq!((a.time, a.sweep, a.exposures.len()), (b.time, b.sweep, b.exposures.len()));
        for (a, b) in a.exposures.iter().zip(&b.exposures) {
            assert_eq!((a.camera, a.time), (b.camera, b.time));
            let apart = a.world_from_camera.inverse() * b.world_from_camera;
            assert!(apart.translation.vector.norm() + apart.rotation.angle() < 1e-9, "{apart}");
        }
    }
}
