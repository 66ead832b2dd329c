//! Held-out rays in worlds whose answer is geometry, and against a slow oracle.

use std::cell::Cell;

use nalgebra::Point3;
use occlabel_core::{ClassId, ClassSet, GridSpec, VoxelGrid, VoxelIndex, traverse};
use occlabel_evaluate::held_out::{
    GroundRule, HeldOutRay, HeldOutSettings, Labels, Source, Tally, Verdict, ask, flat_twin,
};
use proptest::prelude::*;

const ROAD: ClassId = ClassId(11);
const WALL: ClassId = ClassId(15);

fn ray(origin: [f64; 3], point: [f64; 3]) -> HeldOutRay {
    HeldOutRay {
        origin: origin.into(),
        point: point.into(),
        source: Source::Background(None),
        is_of_another_time: false,
    }
}

fn settings(tolerance_m: f64) -> HeldOutSettings {
    let ground = GroundRule::Classes(ClassSet::from_iter([ROAD]));
    HeldOutSettings { ground, tolerance_m }
}

/// A row of voxels of 1 m along x, the occupied ones given.
fn row(occupied: &[usize]) -> (GridSpec, VoxelGrid<Verdict>) {
    let spec = GridSpec::new([0.0; 3], [10.0, 1.0, 1.0], [1.0; 3]).unwrap();
    let mut verdicts = VoxelGrid::filled(&spec, Verdict::Free);
    occupied.iter().for_each(|&x| verdicts.values_mut()[x] = Verdict::Occupied(WALL));
    (spec, verdicts)
}

fn ask_row(occupied: &[usize], rays: &[HeldOutRay], standing: &[usize]) -> Tally {
    let (spec, verdicts) = row(occupied);
    let mut boxes = VoxelGrid::filled(&spec, false);
    standing.iter().for_each(|&x| boxes.values_mut()[x] = true);
    let labels = Labels { spec: &spec, verdicts: &verdicts, standing: Some(&boxes) };
    ask(&labels, rays, &settings(0.25)).labels
}

/// A ray along the row from its first voxel's centre.
fn along(x: f64) -> HeldOutRay {
    ray([0.5, 0.5, 0.5], [x, 0.5, 0.5])
}

// --- one ray ----------------------------------------------------------------------------------

#[test]
fn a_return_hits_its_voxel_or_one_within_the_tolerance() {
    let hits = |x: f64| ask_row(&[5], &[along(x)], &[]).structure.hits;
    assert_eq!([5.5, 6.2, 6.3, 4.8, 4.7].map(hits), [1, 1, 0, 1, 0]);
}

#[test]
fn depth_is_to_the_near_face_of_the_first_occupied_voxel() {
    let error = |occupied: &[usize], x: f64| {
        ask_row(occupied, &[along(x)], &[]).structure.depth.mean_m().unwrap()
    };
    assert!((error(&[5], 5.75) - 0.75).abs() < 1e-6);
    assert!((error(&[2, 5], 5.75) - 3.75).abs() < 1e-6, "something is in the way");
    assert!((error(&[8], 5.75) - 2.25).abs() < 1e-6, "the surface is missing");
    let nothing = ask_row(&[], &[along(5.75)], &[]).structure;
    assert_eq!((nothing.meet_nothing, nothing.depth.rays()), (1, 0));
}

#[test]
fn only_air_more_than_a_voxel_from_a_return_is_compared() {
    let one = ask_row(&[1, 4, 5], &[along(5.5)], &[]).structure;
    assert_eq!((one.crossings, one.crossings_of_occupied), (4, 1), "voxels 0 to 3");
    let two = ask_row(&[1, 4, 5], &[along(5.5), along(1.5)], &[]).structure;
    assert_eq!((two.crossings, two.crossings_of_occupied), (1, 0), "voxel 3");
}

#[test]
fn three_crossings_and_no_return_contradict() {
    let contradicted = |rays: usize| {
        let tally = ask_row(&[2, 5], &vec![along(5.5); rays], &[]);
        (tally.contradicted, tally.occupied_asked)
    };
    assert_eq!([2, 3].map(contradicted), [(0, 1), (1, 2)]);
    let mut with_return = vec![along(5.5); 3];
    with_return.push(along(2.5));
    assert_eq!(ask_row(&[2, 5], &with_return, &[]).contradicted, 0);
}

#[test]
fn rays_of_another_time_are_cut_where_a_track_stands_now() {
    let then = |x: f64| HeldOutRay { is_of_another_time: true, ..along(x) };
    let tally = ask_row(&[2, 6], &[then(6.5), then(2.5)], &[2]);
    assert_eq!((tally.covered, tally.structure.returns), (1, 1));
    assert!((tally.structure.depth.mean_m().unwrap() - 0.5).abs() < 1e-6, "voxel 2 is not met");
    assert_eq!(tally.structure.crossings_of_occupied, 0);
    let now = ask_row(&[2, 6], &[along(6.5)], &[2]).structure;
    assert!((now.depth.mean_m().unwrap() - 4.5).abs() < 1e-6);
}

#[test]
fn a_return_outside_the_grid_tells_of_air_alone() {
    let tally = ask_row(&[3], &[along(14.0)], &[]);
    assert_eq!((tally.returns(), tally.structure.crossings), (0, 10));
    assert_eq!(tally.structure.crossings_of_occupied, 1);
}

// --- the floor --------------------------------------------------------------------------------

const SENSOR_M: f64 = 2.1;

/// Rings of rays onto a flat ground at a height, from 4 m to 12 m away.
fn rings(height_m: f64) -> Vec<HeldOutRay> {
    let ring = |radius: f64| {
        (0..90).map(move |step| {
            let angle = f64::from(step) * std::f64::consts::TAU / 90.0 + 0.01;
            let point = [radius * libm::cos(angle), radius * libm::sin(angle), height_m];
            ray([0.0, 0.0, SENSOR_M], point)
        })
    };
    (8..=24).flat_map(|half| ring(f64::from(half) / 2.0)).collect()
}

fn street() -> GridSpec {
    GridSpec::new([-16.0, -16.0, -1.0], [16.0, 16.0, 3.0], [0.4; 3]).unwrap()
}

#[test]
fn the_floor_is_the_closed_form_wherever_the_ground_lies_in_its_voxel() {
    let spec = street();
    for (height_m, top_m) in [(-0.15, 0.2), (0.0, 0.2), (0.15, 0.2), (0.25, 0.6)] {
        let rays = rings(height_m);
        let twin = flat_twin(&spec, &rays.iter().collect::<Vec<_>>()).unwrap();
        assert_eq!((twin.height_m, twin.rays.len()), (height_m, rays.len()));
        let labels = Labels { spec: &spec, verdicts: &twin.verdicts, standing: None };
        let ground = GroundRule::Classes(ClassSet::from_iter([ClassId(0)]));
        let tally = ask(&labels, &twin.rays, &HeldOutSettings { ground, tolerance_m: 0.1 });
        let error = |ray: &HeldOutRay| {
            (ray.point - ray.origin).norm() * (top_m - height_m) / (SENSOR_M - height_m)
        };
        let mean = rays.iter().map(error).sum::<f64>() / rays.len() as f64;
        let found = tally.labels.ground.depth.mean_m().unwrap();
        assert!((found - mean).abs() < 1e-3, "ground at {height_m} m: {found} m, {mean} m");
        assert_eq!(tally.floor, tally.labels, "perfect labels are their own floor");
        assert_eq!(tally.labels.ground.hits, rays.len() as u64);
    }
}

#[test]
fn the_twin_needs_ground_in_the_grid_and_rays_that_come_down() {
    let spec = street();
    assert!(flat_twin(&spec, &[]).is_none());
    assert!(flat_twin(&spec, &[&ray([0.0, 0.0, 2.0], [90.0, 0.0, 0.0])]).is_none());
    let rays = [ray([0.0, 0.0, 2.0], [5.0, 0.0, 0.1]), ray([0.0, 0.0, 0.05], [5.0, 0.0, 0.2])];
    let twin = flat_twin(&spec, &[&rays[0], &rays[1]]).unwrap();
    assert_eq!((twin.height_m, twin.rays.len()), (0.1, 1), "the lower median");
}

// --- the oracle -------------------------------------------------------------------------------

fn small() -> GridSpec {
    GridSpec::new([0.0; 3], [6.0, 5.0, 4.0], [1.0; 3]).unwrap()
}

/// What one pass should find, voxel by voxel and ray by ray.
#[derive(Debug, Default, PartialEq)]
struct Slow {
    returns: u64,
    hits: u64,
    crossings: u64,
    crossings_of_occupied: u64,
    contradicted: u64,
}

fn slow(spec: &GridSpec, verdicts: &VoxelGrid<Verdict>, rays: &[HeldOutRay]) -> Slow {
    let end = |ray: &HeldOutRay| spec.snap(&ray.point).voxel();
    let is_occupied =
        |v: VoxelIndex| spec.flat(v).is_some_and(|at| verdicts.values()[at].is_occupied());
    let is_far =
        |v: VoxelIndex| rays.iter().all(|ray| (0..3).any(|a| (end(ray).0[a] - v.0[a]).abs() > 1));
    let mut found = Slow::default();
    let mut through = vec![0; spec.len()];
    for ray in rays {
        found.returns += u64::from(spec.flat(end(ray)).is_some());
        found.hits += u64::from(is_occupied(end(ray)));
        for voxel in traverse(spec.snap(&ray.point), spec.snap(&ray.origin)) {
            let Some(flat) = spec.flat(voxel) else { continue };
            through[flat] += 1;
            if is_far(voxel) {
                found.crossings += 1;
                found.crossings_of_occupied += u64::from(is_occupied(voxel));
            }
        }
    }
    let ends_in = |voxel: VoxelIndex| rays.iter().any(|ray| end(ray) == voxel);
    let is_wrong =
        |v: &VoxelIndex| is_occupied(*v) && through[spec.flat(*v).unwrap()] >= 3 && !ends_in(*v);
    found.contradicted = spec.voxels().filter(is_wrong).count() as u64;
    found
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    [-2.0..8.0_f64, -1.0..6.0_f64, -1.0..5.0_f64]
}

#[test]
fn a_pass_counts_as_the_slow_oracle_does() {
    let totals: [Cell<u64>; 5] = Default::default();
    let rays = prop::collection::vec((place(), place()), 1..40);
    let solid = prop::collection::vec(prop::bool::weighted(0.3), small().len());
    proptest!(ProptestConfig::with_cases(300), |(rays in rays, solid in solid)| {
        let spec = small();
        let rays: Vec<_> = rays.into_iter().map(|(from, to)| ray(from, to)).collect();
        let verdict = |s: &bool| if *s { Verdict::Occupied(WALL) } else { Verdict::Free };
        let verdicts = VoxelGrid::from_values(&spec, solid.iter().map(verdict).collect());
        let labels = Labels { spec: &spec, verdicts: &verdicts, standing: None };
        let tally = ask(&labels, &rays, &settings(0.0)).labels;
        let kind = &tally.structure;
        let found = Slow {
            returns: kind.returns,
            hits: kind.hits,
            crossings: kind.crossings,
            crossings_of_occupied: kind.crossings_of_occupied,
            contradicted: tally.contradicted,
        };
        let counts = [found.returns, found.hits, found.crossings, found.contradicted, 1];
        totals.iter().zip(counts).for_each(|(total, count)| total.set(total.get() + count));
        prop_assert_eq!(found, slow(&spec, &verdicts, &rays));
        prop_assert_eq!(kind.depth.rays() + kind.meet_nothing, kind.returns);
    });
    let [returns, hits, crossings, contradicted, cases] = totals.map(Cell::into_inner);
    assert_eq!(cases, 300);
    assert!(returns > 1000 && hits > 300, "{returns} returns, {hits} hits");
    assert!(crossings > 300 && contradicted > 300, "{crossings}, {contradicted}");
}

/// The order of rays, and so the number of threads, does not show.
#[test]
fn tallies_do_not_show_the_order_of_rays() {
    let spec = street();
    let mut rays = rings(0.0);
    rays.extend(rings(0.31));
    let twin = flat_twin(&spec, &rays.iter().collect::<Vec<_>>()).unwrap();
    let labels = Labels { spec: &spec, verdicts: &twin.verdicts, standing: None };
    let forth = ask(&labels, &rays, &settings(0.1));
    rays.reverse();
    assert_eq!(ask(&labels, &rays, &settings(0.1)), forth);
    let origin = Point3::new(0.0, 0.0, SENSOR_M);
    assert!(rays.iter().all(|ray| ray.origin == origin) && forth.labels.returns() == 3060);
}
