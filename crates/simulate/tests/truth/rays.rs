//! Where rays end, what they cross, and what they do not say about another time.

use std::collections::BTreeSet;

use nalgebra::UnitQuaternion;
use occlabel_core::{ClassId, GridSpec, PointLabel, Pose, VoxelGrid, VoxelTruth};
use occlabel_simulate::{Drive, TrueRays, TruthAt, TruthSettings, dense_ends, keyframe_truth};

use crate::support::*;

/// A beam along x, 1 m above the ground, ends on a wall at x = 10.1; at 0.5 s a car that drives
/// along y stands in it: its box from x = 3.7 on, its body from 4.5 on.
fn street(pivot: &str) -> String {
    let wall = solid("static.manmade", [11.1, 0.0, 0.0], "box.size_m = [2.0, 30.0, 8.0]");
    let way = "straight = { start = { x_m = 5.0, y_m = -4.0, yaw_rad = 1.5707963267948966 }, speed_mps = 8.0 }";
    let body = format!("[[mover.part]]\nshape.box.size_m = [2.0, 1.0, 1.6]\n{pivot}");
    head(0.0) + &lidar(1.0) + &wall + &mover("car", "vehicle.car", [2.0, 2.6, 1.6], way, &body)
}

/// Voxel [i][4][2] has its centre at x = 0.4 i in the beam.
fn beam_grid() -> GridSpec {
    grid([-0.2, -1.8, 0.0], [11.8, 2.2, 2.0], 0.4)
}

fn in_beam(truth: &VoxelGrid<VoxelTruth>, holds: impl Fn(&VoxelTruth) -> bool) -> Vec<usize> {
    (0..30).filter(|&x| holds(truth.at([x, 4, 2]))).collect()
}

#[test]
fn a_ray_ends_on_the_wall_and_crosses_what_lies_before_it() {
    let truth = truth_of(&street(""), 0, &beam_grid());
    assert_eq!(in_beam(&truth, |voxel| voxel.crossed), (0..25).collect::<Vec<_>>());
    assert_eq!(count(&truth, |voxel| voxel.crossed), 25, "no ray but one");
    assert_eq!(in_beam(&truth, |voxel| voxel.ends > 0), [25]);
    assert_eq!(truth.at([25, 4, 2]).ends, 7, "three of ten sweeps end on the car");
}

#[test]
fn air_in_a_movers_box_is_only_what_was_seen_then_or_moved_with_it() {
    let truth = truth_of(&street(""), 1, &beam_grid());
    // The box holds the centres 10 to 15; the car's own ray crosses 10 on its way from 11.
    let crossed: Vec<usize> = (0..=10).chain(16..25).collect();
    assert_eq!(in_beam(&truth, |voxel| voxel.crossed), crossed);
    // At 0.4 s and 0.6 s the beam met the car 0.8 m ahead of and behind its middle.
    let ends = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(|y| truth.at([11, y, 2]).ends);
    assert_eq!(ends, [0, 0, 1, 0, 1, 0, 1, 0, 0, 0]);
    assert!(truth.at([10, 2, 2]).crossed && truth.at([9, 6, 2]).crossed, "they moved along");
    assert_eq!(count(&truth, |voxel| voxel.ends > 0 && voxel.solid == 0.0), 0);
}

#[test]
fn rays_on_what_changes_its_shape_count_for_a_moment_only() {
    let pivot = "pivot = { at_m = [0.0, 0.0, 0.0], pitch_rad = { amplitude = 0.0 } }";
    let drive = drive(&street(pivot));
    let spec = beam_grid();
    let keyframe = &drive.scene().keyframes[1];
    let at = TruthAt { keyframe, spec: &spec, world_from_grid: Pose::identity() };
    let ends = |window_s: f64, deformable_window_s: f64| {
        let settings = TruthSettings { window_s, deformable_window_s, sight_depth_m: None };
        let truth = keyframe_truth(&drive, &TrueRays::cast(&drive), &at, &settings, None);
        [truth.at([11, 2, 2]).ends, truth.at([11, 4, 2]).ends, truth.at([25, 4, 2]).ends]
    };
    assert_eq!(ends(100.0, 0.1), [1, 1, 7]);
    assert_eq!(ends(100.0, 0.05), [0, 1, 7]);
    assert_eq!(ends(0.2, 0.05), [0, 1, 2]);
}

/// The class of most returns in each voxel of a world in which nothing moves, the lowest on ties.
fn most_met(drive: &Drive, spec: &GridSpec) -> Vec<Option<ClassId>> {
    let mut counts = vec![[0_u32; 32]; spec.len()];
    for (sweep, header) in drive.scene().sweeps.iter().enumerate() {
        for found in drive.returns(sweep) {
            let end = header.world_from_lidar() * found.position_m;
            if let (Some(flat), PointLabel::Class(class)) =
                (spec.flat_of(&end), drive.label_of(found.hit.what))
            {
                counts[flat][class.index()] += 1;
            }
        }
    }
    let best = |counts: &[u32; 32]| {
        let most = *counts.iter().max().filter(|&&most| most > 0)?;
        counts.iter().position(|&count| count == most).map(|class| ClassId(class as u8))
    };
    counts.iter().map(best).collect()
}

#[test]
fn the_class_met_is_that_of_most_rays() {
    let beams = "pattern.spinning = { beams.even = { count = 24, min_rad = -0.5, max_rad = 0.4 }, azimuths = 360 }";
    let wall = solid("static.manmade", [4.1, 0.0, 0.0], "box.size_m = [2.0, 30.0, 8.0]");
    let tree = solid("static.vegetation", [2.0, 0.5, 0.0], "box.size_m = [0.3, 0.3, 3.0]");
    let text = (head(0.05) + &lidar(1.0) + &wall + &tree)
        .replace("pattern.spinning = { beams.elevations-rad = [0.0], azimuths = 4 }", beams);
    let spec = beam_grid();
    let (drive, truth) = (drive(&text), truth_of(&text, 0, &spec));
    let met: Vec<_> = truth.values().iter().map(|voxel| voxel.hit_class).collect();
    assert_eq!(met, most_met(&drive, &spec));
    assert!(met.iter().flatten().count() > 40, "{}", met.iter().flatten().count());
    let classes: BTreeSet<_> = met.iter().flatten().collect();
    assert_eq!(classes.len(), 3, "{classes:?}");
}

#[test]
fn rays_on_the_ego_itself_do_not_count() {
    let body =
        "body = { min_m = [2.0, -1.0, 0.1], max_m = [3.0, 1.0, 2.0], class = \"vehicle.ego\" }\n";
    let text = street("").replace("[[lidar]]", &format!("{body}[[lidar]]"));
    let truth = truth_of(&text, 0, &beam_grid());
    assert_eq!(count(&truth, |voxel| voxel.ends > 0 || voxel.crossed), 0);
}

#[test]
fn dense_ends_are_the_ends_of_a_log_of_twice_the_density() {
    let beams = "pattern.spinning = { beams.even = { count = 12, min_rad = -0.4, max_rad = 0.3 }, azimuths = 90 }";
    let text = street("")
        .replace("pattern.spinning = { beams.elevations-rad = [0.0], azimuths = 4 }", beams);
    let spec = beam_grid();
    let sparse = drive(&text);
    let dense = truth_of(&text.replace("azimuths = 90", "azimuths = 90, density = 2"), 1, &spec);
    let keyframe = &sparse.scene().keyframes[1];
    let at = TruthAt { keyframe, spec: &spec, world_from_grid: Pose::identity() };
    let counted = &dense_ends(&sparse, &[at], &SETTINGS)[0];
    let truth = keyframe_truth(&sparse, &TrueRays::cast(&sparse), &at, &SETTINGS, Some(counted));
    let sum = |ends: fn(&VoxelTruth) -> u32, truth: &VoxelGrid<VoxelTruth>| {
        truth.values().iter().map(ends).sum::<u32>()
    };
    assert!(truth.values().iter().zip(dense.values()).all(|(a, b)| a.dense_ends == b.ends));
    let [once, four_times] = [sum(|v| v.ends, &truth), sum(|v| v.dense_ends, &truth)];
    let ratio = f64::from(four_times) / f64::from(once);
    assert!(once > 1_000 && (3.4..4.2).contains(&ratio), "{once} {four_times}");
}

#[test]
fn the_same_truth_on_any_number_of_threads() {
    let drive = drive(include_str!("../tiny.toml"));
    let spec = grid([-10.0, -10.0, -1.0], [20.0, 14.0, 5.4], 0.4);
    let turned = UnitQuaternion::from_euler_angles(0.01, 0.02, 0.3);
    let keyframe = &drive.scene().keyframes[2];
    let world_from_grid = Pose::from_parts(nalgebra::Translation3::new(4.0, 0.0, 0.1), turned);
    let at = TruthAt { keyframe, spec: &spec, world_from_grid };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let dense = dense_ends(&drive, &[at], &SETTINGS);
            keyframe_truth(&drive, &TrueRays::cast(&drive), &at, &SETTINGS, dense.first())
        })
    };
    // As text, for flow may be NaN.
    let alone = on(1);
    assert!(format!("{alone:?}") == format!("{:?}", on(2)));
    let seen = |holds: fn(&VoxelTruth) -> bool| count(&alone, holds);
    let counts = [
        seen(|v| v.surface),
        seen(|v| v.swept),
        seen(|v| v.crossed),
        seen(|v| v.ends > 0),
        seen(|v| v.sight > 0),
        seen(|v| v.instance.is_some()),
    ];
    assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
}
