//! A recorded drive: the first scans of sequence 00.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use nalgebra::Point3;
use occlabel_core::{ClassId, PointLabel, Scene};
use occlabel_logs::{ReadOptions, SceneSource, SemanticKittiLog};

/// Points nearer than this are neighbours, metres.
const NEAR_M: f64 = 0.2;

/// The shipped taxonomy, whose file is the pipeline's.
const TAXONOMY: &str = include_str!("../../../../configs/taxonomies/semantickitti.toml");

/// The log, wanted sequence 00 only: the sample called 08 has no poses.
fn recorded() -> Option<SemanticKittiLog> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or_else(beside, PathBuf::from);
    let root = data.join("semantickitti/dataset");
    if !root.is_dir() {
        println!("skipped: no semantickitti in $OCCLABEL_DATA or ../shared/data");
        return None;
    }
    let scenes = Some(["00".to_owned()].into());
    let all = ReadOptions::of(toml::from_str(TAXONOMY).unwrap());
    let options = ReadOptions { scenes, ..all };
    Some(SemanticKittiLog::open(&root, options).unwrap())
}

/// Labelled points of a sweep in world.
fn in_world(log: &SemanticKittiLog, scene: &Scene, sweep: usize) -> Vec<(Point3<f64>, ClassId)> {
    let header = &scene.sweeps[sweep];
    let cloud = log.read_sweep(header).unwrap().cloud;
    let world_from_lidar = header.world_from_lidar();
    let labelled =
        cloud.positions.iter().zip(&cloud.labels).filter_map(|(point, label)| match label {
            PointLabel::Class(class) => Some((world_from_lidar * point, *class)),
            _ => None,
        });
    labelled.collect()
}

fn cell(p: &Point3<f64>) -> [i64; 3] {
    [0, 1, 2].map(|axis| (p[axis] / NEAR_M).floor() as i64)
}

/// Of the points that have a neighbour in `first`, how many have its label; and how many there are.
fn agreement(first: &[(Point3<f64>, ClassId)], later: &[(Point3<f64>, ClassId)]) -> (usize, usize) {
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (at, (point, _)) in first.iter().enumerate() {
        cells.entry(cell(point)).or_default().push(at);
    }
    let nearest = |p: &Point3<f64>| {
        let around = (0..27).flat_map(|n| {
            let [x, y, z] = cell(p);
            let key = [x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1];
            cells.get(&key).into_iter().flatten()
        });
        let apart = |at: usize| (first[at].0 - p).norm();
        let best = around.copied().min_by(|&a, &b| apart(a).total_cmp(&apart(b)))?;
        (apart(best) <= NEAR_M).then_some(first[best].1)
    };
    let pairs = later.iter().filter_map(|(p, class)| Some(nearest(p)? == *class));
    pairs.fold((0, 0), |(same, all), agree| (same + usize::from(agree), all + 1))
}

#[test]
fn a_recorded_drive_is_read_as_its_makers_counted_it() {
    let Some(log) = recorded() else { return };
    let scene = log.load("00").unwrap();
    let clouds = scene.sweeps.iter().map(|sweep| log.read_sweep(sweep).unwrap().cloud);
    let counts: Vec<usize> = clouds.map(|cloud| cloud.len()).collect();
    assert_eq!((counts[0], counts[5], counts.len()), (124_668, 123_924, 6));
    assert_eq!(scene.sweeps.iter().filter(|sweep| sweep.labelled).count(), 3);
    let classes: BTreeSet<ClassId> =
        in_world(&log, &scene, 0).into_iter().map(|(_, class)| class).collect();
    assert!(classes.len() > 10, "{classes:?}");
    assert!(scene.refused.is_empty() && scene.warnings.is_empty());
}

#[test]
fn neighbours_in_later_scans_carry_the_first_ones_label() {
    let Some(log) = recorded() else { return };
    let scene = log.load("00").unwrap();
    let first = in_world(&log, &scene, 0);
    for sweep in [1, 2] {
        let (same, all) = agreement(&first, &in_world(&log, &scene, sweep));
        let share = same as f64 / all as f64;
        println!("scan {sweep}: {same} of {all}, {share:.4}");
        assert!(all > 80_000 && share > 0.98, "scan {sweep}: {same} of {all}");
    }
}

#[test]
fn the_road_lies_at_the_height_of_the_ego() {
    let Some(log) = recorded() else { return };
    let scene = log.load("00").unwrap();
    let road = ClassId(9);
    let mut heights: Vec<f64> = in_world(&log, &scene, 0)
        .into_iter()
        .filter(|(point, class)| *class == road && point.coords.norm() < 15.0)
        .map(|(point, _)| point.z)
        .collect();
    heights.sort_by(f64::total_cmp);
    let median_m = heights[heights.len() / 2];
    assert!(heights.len() > 1000 && median_m.abs() < 0.15, "{median_m}");
}
