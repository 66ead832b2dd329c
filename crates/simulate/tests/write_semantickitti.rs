//! A tiny drive, written as SemanticKITTI and read back by a reader that knows nothing but the
//! format.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use nalgebra::{Matrix4, Point3};
use occlabel_core::Taxonomy;
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, Output, What, World, write_semantickitti};
use tempfile::TempDir;

const TINY: &str = include_str!("tiny.toml");

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

fn logged() -> (TempDir, PathBuf, Drive) {
    let folder = tempfile::tempdir().unwrap();
    let world = World::parse(TINY, "tiny.toml").unwrap();
    let drive = Drive::new(world, &taxonomy()).unwrap();
    let output = Output::create(folder.path()).unwrap();
    let (written, last) = write_semantickitti(&drive, &output).unwrap();
    assert_eq!((written.sweeps, written.keyframes), (21, 5));
    output.finish(last).unwrap();
    let sequence = folder.path().join("sequences/00");
    (folder, sequence, drive)
}

/// Sweeps of the reference lidar, by their number in the scene.
fn reference(drive: &Drive) -> Vec<usize> {
    let sweeps = &drive.scene().sweeps;
    (0..sweeps.len()).filter(|&at| sweeps[at].lidar == "LIDAR_TOP").collect()
}

fn matrix(line: &str) -> Matrix4<f64> {
    let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    assert_eq!(numbers.len(), 12);
    let mut matrix = Matrix4::identity();
    (0..12).for_each(|at| matrix[(at / 4, at % 4)] = numbers[at]);
    matrix
}

fn words(path: &Path) -> Vec<[u8; 4]> {
    let bytes = std::fs::read(path).unwrap();
    assert!(bytes.len().is_multiple_of(4));
    bytes.chunks_exact(4).map(|word| word.try_into().unwrap()).collect()
}

#[test]
fn poses_move_every_sweep_into_the_first_ones_frame() {
    let (_folder, sequence, drive) = logged();
    let text = |name: &str| std::fs::read_to_string(sequence.join(name)).unwrap();
    let (calib, poses, times) = (text("calib.txt"), text("poses.txt"), text("times.txt"));
    let tr = matrix(calib.lines().find_map(|line| line.strip_prefix("Tr: ")).unwrap());
    let sweeps: Vec<_> =
        reference(&drive).into_iter().map(|at| drive.scene().sweeps[at].clone()).collect();
    assert_eq!((poses.lines().count(), times.lines().count()), (sweeps.len(), sweeps.len()));
    let inverse = tr.try_inverse().unwrap();
    for ((pose, time), sweep) in poses.lines().zip(times.lines()).zip(&sweeps) {
        let first_from_now = inverse * matrix(pose) * tr;
        let true_one = sweeps[0].world_from_lidar().inverse() * sweep.world_from_lidar();
        assert!((first_from_now - true_one.to_homogeneous()).amax() < 1e-9, "{pose}");
        assert_eq!((time.parse::<f64>().unwrap() * 1e9).round() as i64, sweep.time.0);
    }
    // A lidar 1.84 m above the ego's origin is 0.19 m above the camera: y points down.
    assert!((tr[(1, 3)] + 0.19).abs() < 1e-12 && (tr[(2, 3)] - 0.9).abs() < 1e-12, "{tr}");
}

#[test]
fn points_are_those_of_the_reference_lidar() {
    let (_folder, sequence, drive) = logged();
    let mut count = 0;
    for (number, sweep) in reference(&drive).into_iter().enumerate() {
        let words = words(&sequence.join(format!("velodyne/{number:06}.bin")));
        let cloud = drive.points(sweep);
        assert_eq!(words.len(), 4 * cloud.len());
        for (word, p) in words.chunks_exact(4).zip(&cloud.positions) {
            let read = Point3::from([0, 1, 2].map(|axis| f32::from_le_bytes(word[axis])));
            assert_eq!(read, p.cast::<f32>());
            count += 1;
        }
    }
    assert!(count > 50_000, "{count}");
}

#[test]
fn labels_name_class_motion_and_instance() {
    let (_folder, sequence, drive) = logged();
    let mut ids: BTreeMap<What, BTreeSet<(u32, u32)>> = BTreeMap::new();
    let mut labelled = 0;
    for (number, sweep) in reference(&drive).into_iter().enumerate() {
        let path = sequence.join(format!("labels/{number:06}.label"));
        assert_eq!(path.exists(), drive.scene().sweeps[sweep].labelled, "{number}");
        if !path.exists() {
            continue;
        }
        let (labels, returns) = (words(&path), drive.returns(sweep));
        assert_eq!(labels.len(), returns.len());
        for (label, found) in labels.into_iter().map(u32::from_le_bytes).zip(&returns) {
            ids.entry(found.hit.what).or_default().insert((label & 0xffff, label >> 16));
        }
        labelled += 1;
    }
    let id = |what| ids.get(&what).map(|ids| ids.iter().copied().collect::<Vec<_>>());
    assert!(labelled >= 5, "{labelled}");
    assert_eq!(id(What::Ground(0)), Some(vec![(40, 0)]));
    assert_eq!(id(What::Ground(1)), Some(vec![(48, 0)]));
    assert_eq!(id(What::Static(0)), Some(vec![(50, 0)]));
    // Movers in byte order of their names: car, trailer, truck, walker; all of them move.
    let movers = [252, 259, 258, 254];
    for (at, class) in movers.into_iter().enumerate() {
        assert_eq!(id(What::Mover(at)), Some(vec![(class, at as u32 + 1)]));
    }
}
