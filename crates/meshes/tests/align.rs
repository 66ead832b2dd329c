//! Meshes that were displaced by exactly known motions, and a lidar's points of what they are of.

mod support;

use nalgebra::{Point3, Vector3};
use occlabel_core::{Pose, TriangleMesh};
use occlabel_meshes::{AlignSettings, Alignment, View, align};
use support::{mesh, person, turned};

const SETTINGS: AlignSettings =
    AlignSettings { max_pair_m: 0.3, point_error_m: 0.02, mesh_error_m: 0.1, mesh_error_rad: 0.1 };

/// What a lidar of 32 beams sees of a person, from so far away.
fn view(swing_rad: f64, away_m: f64, bearing_rad: f64) -> View {
    let parts = person(swing_rad);
    let (sin, cos) = libm::sincos(bearing_rad);
    let from = Point3::new(-away_m * cos, -away_m * sin, 0.05);
    let mut points = Vec::new();
    for beam in 0..32 {
        let (up, level) = libm::sincos(-0.5 + 0.85 * f64::from(beam) / 31.0);
        for shot in -120..=120 {
            let (left, ahead) = libm::sincos(bearing_rad + f64::from(shot) * 0.006_981);
            let way = Vector3::new(level * ahead, level * left, up);
            let met = parts.iter().filter_map(|part| part.cast(&from, &way, 30.0));
            points.extend(met.reduce(f64::min).map(|at_m| from + way * at_m));
        }
    }
    View { from, points }
}

/// Motions of 10 cm and 5 degrees, any way.
fn displacements() -> impl Iterator<Item = Pose> {
    let direction = |n: u32| {
        let (n, golden) = (f64::from(n), 2.399_963);
        let z = 1.0 - 2.0 * ((n * 0.618_034) % 1.0);
        let (sin, cos) = libm::sincos(n * golden);
        let across = (1.0 - z * z).sqrt();
        Vector3::new(across * cos, across * sin, z)
    };
    (0..12).map(move |n| {
        let (turn, shift) = (direction(n + 31) * 0.0873, direction(n) * 0.1);
        turned(turn.into(), shift.into())
    })
}

/// How far the vertices of an aligned mesh are from where they belong, as the root of the mean square.
fn off_m(given: &TriangleMesh, found: &Alignment, exact: &TriangleMesh) -> f64 {
    let aligned = given.moved(&found.aligned_from_given);
    let pairs = aligned.vertices().iter().zip(exact.vertices());
    let squares: f64 = pairs.map(|(a, b)| (a - b).norm_squared()).sum();
    (squares / exact.vertices().len() as f64).sqrt()
}

/// A person, displaced, and what a lidar sees of them; the number tells their step and the bearing.
fn trial(n: usize, moved: &Pose, away_m: f64) -> (TriangleMesh, TriangleMesh, View) {
    let swing_rad = [0.4, 0.1, -0.3][n % 3];
    let exact = mesh(&person(swing_rad), 20);
    (exact.moved(moved), exact, view(swing_rad, away_m, n as f64 * 0.7))
}

#[test]
fn section_9a_people_who_stand_10_cm_and_5_degrees_off_are_put_back_by_the_points_of_one_side() {
    for (away_m, limit_m) in [(2.0, 0.005), (6.0, 0.005), (12.0, 0.04)] {
        for (n, moved) in displacements().enumerate() {
            let (given, exact, view) = trial(n, &moved, away_m);
            assert!(view.points.len() >= 10, "{}", view.points.len());
            let found = align(&given, &[view], &SETTINGS);
            let off_m = off_m(&given, &found, &exact);
            assert!(off_m < limit_m, "{away_m} m away, displacement {n}: off by {off_m} m");
            assert!(found.residual_m < 0.01, "{}", found.residual_m);
        }
    }
}

#[test]
fn section_9a_an_exact_mesh_stays() {
    let (given, exact, view) = trial(0, &Pose::identity(), 5.0);
    let found = align(&given, &[view], &SETTINGS);
    assert!(off_m(&given, &found, &exact) < 0.003);
}

#[test]
fn section_9a_a_mesh_far_out_in_the_world_is_aligned_as_well() {
    let there = Pose::translation(400_000.0, -5_000_000.0, 120.0);
    let (given, exact, view) = trial(1, &turned([0.0, 0.0, 0.08], [0.06, 0.06, 0.0]), 5.0);
    let points = view.points.iter().map(|point| there * point).collect();
    let views = [View { from: there * view.from, points }];
    let found = align(&given.moved(&there), &views, &SETTINGS);
    assert!(off_m(&given.moved(&there), &found, &exact.moved(&there)) < 0.005);
}

#[test]
fn section_9a_a_few_points_of_the_ground_do_not_pull() {
    let (given, exact, mut view) = trial(2, &turned([0.0, 0.05, 0.0], [0.05, -0.05, 0.05]), 5.0);
    let ground = (0..view.points.len() / 8).map(|n| {
        let n = f64::from(n as u32);
        Point3::new((n * 0.37) % 0.8 - 0.4, (n * 0.61) % 0.6 - 0.3, -0.9)
    });
    view.points.extend(ground.collect::<Vec<_>>());
    let found = align(&given, &[view], &SETTINGS);
    let off_m = off_m(&given, &found, &exact);
    assert!(off_m < 0.01, "{off_m}");
}

#[test]
fn section_9a_what_lies_on_the_far_side_is_no_part_of_what_is_seen() {
    let wall = |x: f64| [[x, -1.0, -1.0], [x, 1.0, -1.0], [x, 0.0, 1.0]].map(Point3::from);
    let corners = [wall(0.0), wall(0.2)].concat();
    let slab = TriangleMesh::new(corners, [[0, 2, 1], [3, 5, 4]]).unwrap();
    let points = (0..9).map(|n| Point3::new(0.15, f64::from(n) * 0.05 - 0.2, 0.0)).collect();
    let view = View { from: Point3::new(-5.0, 0.0, 0.0), points };
    let found = align(&slab, &[view], &SETTINGS);
    let x = found.aligned_from_given.translation.x;
    assert!((x - 0.15).abs() < 0.02, "the hidden slab would have come nearer, by -0.05: {x}");
}

#[test]
fn section_9a_points_of_something_else_are_told_by_the_residual() {
    let (given, ..) = trial(0, &Pose::identity(), 5.0);
    let points = (0..60).map(|n| {
        let n = f64::from(n);
        Point3::new(-0.2 + (n * 0.37) % 0.9, (n * 0.61) % 1.2 - 0.6, (n * 0.23) % 1.8 - 0.9)
    });
    let view = View { from: Point3::new(-5.0, 0.0, 0.0), points: points.collect() };
    assert!(align(&given, &[view], &SETTINGS).residual_m > 0.08);
}

#[test]
fn section_9a_without_points_a_mesh_stays_and_its_residual_is_the_largest() {
    let (given, ..) = trial(0, &Pose::identity(), 5.0);
    let nothing = View { from: Point3::new(-5.0, 0.0, 0.0), points: Vec::new() };
    for views in [vec![], vec![nothing]] {
        let found = align(&given, &views, &SETTINGS);
        let moved = found.aligned_from_given.translation.vector.norm();
        assert!(moved < 1e-9 && found.residual_m == SETTINGS.max_pair_m, "{moved}");
    }
}
