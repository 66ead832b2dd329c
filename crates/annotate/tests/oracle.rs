//! `relabel` against its definition: sort all labelled points, let the first vote.

use std::cell::Cell;

use nalgebra::{Point3, Vector3};
use occlabel_annotate::{RelabelSettings, relabel};
use occlabel_core::{AggregatedScene, BackgroundSweep, ClassId, ClassSet, PointCloud, Timestamp};
use proptest::prelude::*;

type Point = (Point3<f64>, Option<ClassId>);

/// The first class of most votes among the first `k` by (distance, class) within reach.
fn by_sorting(
    labelled: &[(Point3<f64>, ClassId)],
    p: &Point3<f64>,
    s: &RelabelSettings,
) -> ClassId {
    let reach_m = s.max_distance_m.unwrap_or(f64::INFINITY);
    let mut all: Vec<(f64, ClassId)> =
        labelled.iter().map(|(q, class)| ((q - p).norm_squared(), *class)).collect();
    all.retain(|(squared, _)| *squared <= reach_m * reach_m);
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all.truncate(s.k);
    let votes = |class: &ClassId| all.iter().filter(|(_, other)| other == class).count();
    let most = all.iter().map(|(_, class)| votes(class)).max();
    let winner = all.iter().map(|(_, class)| class).find(|class| Some(votes(class)) == most);
    *winner.unwrap_or(&s.unknown.unwrap())
}

fn settings(k: usize, max_distance_m: Option<f64>) -> RelabelSettings {
    let (unknown, ghosts) = (Some(ClassId(99)), ClassSet::default());
    RelabelSettings { k, max_distance_m, unknown, ghosts }
}

/// The points as a scene of sweeps of at most so many.
fn scene(points: &[Point], a_sweep: usize) -> AggregatedScene<Option<ClassId>> {
    let sweep = |part: &[Point]| {
        let mut cloud = PointCloud::with_origins(vec![Point3::origin()]);
        part.iter().for_each(|(p, label)| cloud.push(*p, *label, 0));
        BackgroundSweep::new(Timestamp(0), cloud)
    };
    let background = points.chunks(a_sweep).map(sweep).collect();
    AggregatedScene::new(background, Vec::new())
}

fn relabelled(points: &[Point], a_sweep: usize, settings: &RelabelSettings) -> Vec<ClassId> {
    let relabelled = relabel(scene(points, a_sweep), settings);
    relabelled.background.into_iter().flat_map(|sweep| sweep.cloud.labels).collect()
}

/// Fails unless every `step`-th point has the class that sorting gives it. Tells how many it asked.
fn assert_as_by_sorting(points: &[Point], settings: &RelabelSettings, step: usize) -> usize {
    let labelled: Vec<_> = points.iter().filter_map(|(p, label)| Some((*p, (*label)?))).collect();
    let classes = relabelled(points, 1 + points.len() / 3, settings);
    let asked = points.iter().zip(&classes).filter(|((_, label), _)| label.is_none());
    let mut count = 0;
    for ((p, _), class) in asked.step_by(step) {
        assert_eq!(*class, by_sorting(&labelled, p, settings), "at {p}, {settings:?}");
        count += 1;
    }
    count
}

/// One coordinate: of a lattice, of a centimetre grid, any, far, or always the same.
fn coordinate() -> impl Strategy<Value = BoxedStrategy<f64>> {
    prop_oneof![
        Just((0_i32..6).prop_map(f64::from).boxed()),
        Just((0_i32..300).prop_map(|i| 0.01 * f64::from(i)).boxed()),
        Just((-4.0..4.0_f64).boxed()),
        Just(prop_oneof![20 => -4.0..4.0_f64, 1 => -1e9..1e9_f64].boxed()),
        Just(Just(0.25).boxed()),
    ]
}

/// Clouds, most of them planes, lines, lattices or with far outliers, somewhere in the world.
fn cloud() -> impl Strategy<Value = Vec<Point>> {
    let shift = prop_oneof![Just(0.0), Just(4_321_000.1)];
    let classes = prop_oneof![Just(1_u8), Just(2), Just(17)];
    ([coordinate(), coordinate(), coordinate()], shift, classes).prop_flat_map(
        |(coordinates, shift, classes)| {
            let label =
                prop_oneof![2 => Just(None), 1 => (0..classes).prop_map(|id| Some(ClassId(id)))];
            let point = coordinates.prop_map(move |at| Point3::from(at) + Vector3::repeat(shift));
            prop::collection::vec((point, label), 0..700)
        },
    )
}

#[test]
fn section_5_classes_are_those_that_sorting_gives() {
    let (asked, unknown) = (Cell::new(0), Cell::new(0));
    let reach = prop_oneof![Just(None), (0.0..2.0_f64).prop_map(Some), Just(Some(1.0))];
    proptest!(ProptestConfig::with_cases(200), |(points in cloud(), k in 1_usize..14, reach in reach)| {
        let settings = settings(k, reach);
        asked.set(asked.get() + assert_as_by_sorting(&points, &settings, 1));
        let classes = relabelled(&points, 100, &settings);
        unknown.set(unknown.get() + classes.iter().filter(|class| class.0 == 99).count());
    });
    assert!(asked.get() > 20_000, "{} points", asked.get());
    assert!(unknown.get() > 500, "{} points without a neighbour in reach", unknown.get());
}

/// The same scatter of numbers in [0, 1) on every machine.
fn scatter() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A wavy ground of stripes of classes, every tenth point labelled, and three outliers.
fn street(count: usize) -> Vec<Point> {
    let mut next = scatter();
    let mut points: Vec<Point> = (0..count)
        .map(|i| {
            let (x, y) = (80.0 * next(), 20.0 * next());
            let p = Point3::new(x, y, 0.2 * x.floor() + 0.02 * next());
            (p, (i % 10 == 0).then_some(ClassId((y / 3.0) as u8)))
        })
        .collect();
    points.extend([1e9, -1e5, 3e2].map(|far| (Point3::new(far, far, 1.0), None)));
    points
}

#[test]
fn section_5_a_street_of_many_points_is_relabelled_as_by_sorting() {
    let points = street(60_000);
    for reach in [None, Some(0.3), Some(1.0)] {
        assert!(assert_as_by_sorting(&points, &settings(5, reach), 97) > 500);
    }
}

#[test]
fn section_12_the_number_of_threads_and_the_order_of_sweeps_do_not_show() {
    let (points, settings) = (street(60_000), settings(5, Some(1.0)));
    let on = |threads: usize, a_sweep: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| relabelled(&points, a_sweep, &settings))
    };
    let expected = on(1, points.len());
    assert_eq!(on(4, points.len()), expected);
    assert_eq!(on(3, 17), expected, "many small sweeps");
}

#[test]
fn heaps_of_repeats_do_no_harm() {
    let here = Point3::new(1.0, 1.0, 1.0);
    let labelled = |i: u32| (here, Some(ClassId((i % 3) as u8)));
    let unlabelled = |_| (here + Vector3::new(0.0, 0.5, 0.0), None);
    let points: Vec<Point> = (0..60_000).map(labelled).chain((0..60_000).map(unlabelled)).collect();
    assert!(assert_as_by_sorting(&points, &settings(5, Some(1.0)), 20_000) == 3);
    assert!(assert_as_by_sorting(&points, &settings(40, None), 20_000) == 3);
}

#[test]
fn a_scene_without_labels_is_unknown_throughout() {
    let points: Vec<Point> = street(500).into_iter().map(|(p, _)| (p, None)).collect();
    assert!(relabelled(&points, 100, &settings(5, None)).iter().all(|class| class.0 == 99));
    assert!(relabelled(&[], 1, &settings(5, None)).is_empty());
}
