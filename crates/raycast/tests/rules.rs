//! The rules of labels.md section 8, one by one, on rows of voxels whose answer is known by hand.

use nalgebra::{Point3, Vector3};
use occlabel_core::{
    AggregatedScene, BackgroundSweep, Box3, BoxGrowth, ClassId, ClassSet, GridSpec, GrownBox,
    Instant, ObjectSweep, PlacedObject, PointCloud, Pose, RayCounts, StandingBox, Timestamp,
    TrackId,
};
use occlabel_raycast::{
    Casting, Crossings, ObjectRays, Outside, RayRules, RaySettings, RaySource, count,
};

const ROAD: ClassId = ClassId(11);
const POLE: ClassId = ClassId(15);
const CAR: ClassId = ClassId(4);
const NOW: i64 = 1_532_402_927_647_951_000;

/// No rule at all.
const PLAIN: RaySettings = RaySettings {
    source: RaySource::Lidar,
    outside: Outside::Clip,
    ignore_near_hit_m: 0.0,
    ignore_near_origin_m: 0.0,
    flat_ignore_dz_m: 0.0,
    object_rays: ObjectRays::Own,
    same_time_s: 0.05,
};

fn point(p: [f64; 3]) -> Point3<f64> {
    Point3::from(p)
}

/// A row of voxels along x that starts at 0.
fn row(voxels: usize, size_m: f64) -> GridSpec {
    GridSpec::new([0.0; 3], [voxels as f64 * size_m, size_m, size_m], [size_m; 3]).unwrap()
}

/// A column of voxels along z that starts at 0.
fn column(voxels: usize, size_m: f64) -> GridSpec {
    GridSpec::new([0.0; 3], [size_m, size_m, voxels as f64 * size_m], [size_m; 3]).unwrap()
}

/// A ray along the middle of a row of 1 m voxels.
fn along_x(origin: f64, end: f64) -> PointCloud<ClassId> {
    ray([origin, 0.5, 0.5], [end, 0.5, 0.5], POLE)
}

fn ray(origin: [f64; 3], end: [f64; 3], class: ClassId) -> PointCloud<ClassId> {
    PointCloud::from_one_origin(point(origin), vec![point(end)], vec![class])
}

/// Background clouds, seen so many ns after the keyframe.
fn scene(clouds: Vec<(i64, PointCloud<ClassId>)>) -> AggregatedScene<ClassId> {
    let sweep = |(after, cloud)| BackgroundSweep::new(Timestamp(NOW + after), cloud);
    let background = clouds.into_iter().map(sweep).collect();
    AggregatedScene::new(background, vec![])
}

fn cast(instant: &Instant, spec: &GridSpec, settings: &RaySettings) -> RayCounts {
    let flat: ClassSet = [ROAD].into_iter().collect();
    let casting = Casting::new(Crossings::HowMany, 2);
    count(instant, spec, &RayRules { settings, flat: &flat }, &casting)
}

fn cast_one(cloud: PointCloud<ClassId>, spec: &GridSpec, settings: &RaySettings) -> RayCounts {
    let scene = scene(vec![(0, cloud)]);
    cast(&Instant { time: Timestamp(NOW), ..Instant::still(&scene) }, spec, settings)
}

fn crossings(cloud: PointCloud<ClassId>, spec: &GridSpec, settings: &RaySettings) -> Vec<u32> {
    cast_one(cloud, spec, settings).crossings.into_values()
}

#[test]
fn section_8_a_ray_hits_its_end_and_crosses_what_lies_before_it() {
    let counts = cast_one(along_x(0.5, 4.5), &row(6, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0, 0, 0, 0, 1, 0]);
    assert_eq!(counts.crossings.values(), [1, 1, 1, 1, 0, 0]);
}

#[test]
fn section_8_origin_and_point_in_one_voxel_are_a_hit_and_no_crossing() {
    let counts = cast_one(along_x(2.1, 2.9), &row(4, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0, 0, 1, 0]);
    assert_eq!(counts.crossings.values(), [0; 4]);
}

#[test]
fn section_8_rays_run_straight_through_occupied_voxels() {
    let mut cloud = along_x(0.5, 2.5);
    cloud.push(point([4.5, 0.5, 0.5]), POLE, 0);
    let counts = cast_one(cloud, &row(5, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0, 0, 1, 0, 1]);
    assert_eq!(counts.crossings.values(), [2, 2, 1, 1, 0]);
}

#[test]
fn section_8_background_rays_run_from_their_own_origins() {
    let mut cloud = PointCloud::with_origins(vec![point([0.5; 3]), point([5.5, 0.5, 0.5])]);
    cloud.push(point([2.5, 0.5, 0.5]), POLE, 0);
    cloud.push(point([3.5, 0.5, 0.5]), POLE, 1);
    let counts = cast_one(cloud, &row(6, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0, 0, 1, 1, 0, 0]);
    assert_eq!(counts.crossings.values(), [1, 1, 0, 0, 1, 1]);
}

#[test]
fn section_8_a_diagonal_ray_steps_x_before_y_from_the_point() {
    let spec = GridSpec::new([0.0; 3], [2.0, 2.0, 1.0], [1.0; 3]).unwrap();
    let diagonal = ray([1.5, 1.5, 0.5], [0.5, 0.5, 0.5], POLE);
    assert_eq!(crossings(diagonal, &spec, &PLAIN), [0, 0, 1, 1], "(1, 0), then (1, 1)");
}

#[test]
fn section_8_an_end_outside_is_clipped_or_dropped() {
    let beyond = || along_x(0.5, 9.5);
    let clipped = cast_one(beyond(), &row(4, 1.0), &PLAIN);
    assert_eq!(clipped.crossings.values(), [1; 4]);
    assert_eq!(clipped.hits.values(), [0; 4]);
    let drop = RaySettings { outside: Outside::Drop, ..PLAIN };
    assert_eq!(crossings(beyond(), &row(4, 1.0), &drop), [0; 4]);
    assert_eq!(crossings(along_x(0.5, 3.5), &row(4, 1.0), &drop), [1, 1, 1, 0], "an end inside");
}

#[test]
fn fault_10_a_sensor_outside_the_grid_crosses_what_lies_inside() {
    let spec = row(5, 1.0);
    assert_eq!(crossings(along_x(-7.5, 3.5), &spec, &PLAIN), [1, 1, 1, 0, 0]);
    assert_eq!(crossings(along_x(12.5, 3.5), &spec, &PLAIN), [0, 0, 0, 0, 1]);
    assert_eq!(crossings(along_x(-7.5, 99.5), &spec, &PLAIN), [1; 5], "through and through");
    let past = ray([-7.5, 1.5, 0.5], [99.5, 1.5, 0.5], POLE);
    assert_eq!(crossings(past, &spec, &PLAIN), [0; 5], "past the grid");
    let drop = RaySettings { outside: Outside::Drop, ..PLAIN };
    assert_eq!(crossings(along_x(-7.5, 3.5), &spec, &drop), [1, 1, 1, 0, 0], "the end decides");
}

#[test]
fn section_8_no_crossing_counts_near_the_hit() {
    let near = RaySettings { ignore_near_hit_m: 2.0, ..PLAIN };
    assert_eq!(crossings(along_x(0.5, 5.5), &row(6, 1.0), &near), [1, 1, 1, 0, 0, 0]);
    assert_eq!(cast_one(along_x(0.5, 5.5), &row(6, 1.0), &near).hits.values()[5], 1);
    assert_eq!(crossings(along_x(0.5, 5.5), &row(4, 1.0), &near), [1, 1, 1, 0], "end outside");
}

#[test]
fn section_8_no_crossing_counts_near_the_origin() {
    let near = RaySettings { ignore_near_origin_m: 2.0, ..PLAIN };
    assert_eq!(crossings(along_x(0.5, 5.5), &row(6, 1.0), &near), [0, 0, 0, 1, 1, 0]);
    assert_eq!(crossings(along_x(-0.5, 5.5), &row(6, 1.0), &near), [0, 0, 1, 1, 1, 0], "outside");
}

#[test]
fn section_8_near_is_the_sum_over_the_axes() {
    let spec = GridSpec::new([0.0; 3], [1.0, 2.0, 3.0], [0.5, 1.0, 1.5]).unwrap();
    let near = |limit_m| RaySettings { ignore_near_hit_m: limit_m, ..PLAIN };
    let diagonal = || ray([0.75, 1.5, 2.25], [0.25, 0.5, 0.75], POLE);
    let sum = |limit_m| crossings(diagonal(), &spec, &near(limit_m)).iter().sum::<u32>();
    // The walk: (1, 0, 0) at 0.5 m, (1, 1, 0) at 1.5 m, (1, 1, 1) at 3 m.
    assert_eq!([0.0, 0.49, 0.5, 1.49, 1.5, 2.99, 3.0].map(sum), [3, 3, 2, 2, 1, 1, 0]);
}

#[test]
fn section_8_near_rules_hold_at_exact_multiples() {
    // In binary 3 * 0.4 is more than 1.2: the third voxel lies beyond.
    let spec = row(10, 0.4);
    let long = || ray([3.8, 0.2, 0.2], [0.2, 0.2, 0.2], POLE);
    let hit = RaySettings { ignore_near_hit_m: 1.2, ..PLAIN };
    assert_eq!(crossings(long(), &spec, &hit), [0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
    let origin = RaySettings { ignore_near_origin_m: 1.2, ..PLAIN };
    assert_eq!(crossings(long(), &spec, &origin), [0, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
}

#[test]
fn section_8_rays_that_end_on_flat_count_nothing_beside_the_ground() {
    let ends_on = |class| ray([0.25, 0.25, 2.75], [0.25, 0.25, 0.25], class);
    let rule = RaySettings { flat_ignore_dz_m: 1.0, ..PLAIN };
    let spec = column(6, 0.5);
    assert_eq!(crossings(ends_on(ROAD), &spec, &rule), [0, 0, 1, 1, 1, 1], "1.0 m is not below");
    assert_eq!(crossings(ends_on(POLE), &spec, &rule), [0, 1, 1, 1, 1, 1]);
    assert_eq!(crossings(ends_on(ROAD), &spec, &PLAIN), [0, 1, 1, 1, 1, 1]);
}

#[test]
fn section_8_the_flat_rule_holds_at_exact_multiples() {
    // In binary 6 * 0.15 is less than 0.9: the sixth voxel lies within.
    let rule = RaySettings { flat_ignore_dz_m: 0.9, ..PLAIN };
    let ray = ray([0.075, 0.075, 1.125], [0.075, 0.075, 0.075], ROAD);
    assert_eq!(crossings(ray, &column(8, 0.15), &rule), [0, 0, 0, 0, 0, 0, 1, 1]);
}

#[test]
fn section_8_the_flat_rule_looks_below_too_and_along_the_ground() {
    let rule = RaySettings { flat_ignore_dz_m: 1.0, ..PLAIN };
    let from_below = ray([0.25, 0.25, 0.25], [0.25, 0.25, 2.75], ROAD);
    assert_eq!(crossings(from_below, &column(6, 0.5), &rule), [1, 1, 1, 1, 0, 0]);
    let grazing = ray([0.5, 0.5, 0.5], [5.5, 0.5, 0.5], ROAD);
    assert_eq!(crossings(grazing, &row(6, 1.0), &rule), [0; 6]);
}

/// A car of 2 m in a row of 1 m voxels, seen in [5.5, 7.5] by a lidar at x = 9.5 that hit it at
/// 5.6: box coordinate -0.9. The ray enters the box at 7.5.
struct Car {
    object: ObjectSweep,
    /// Where its centre stands at the keyframe.
    now: Option<f64>,
}

const SEEN_AT: f64 = 6.5;

fn car(now: Option<f64>) -> Car {
    car_seen_from(9.5, now)
}

fn car_seen_from(lidar: f64, now: Option<f64>) -> Car {
    let cloud = ray([lidar - SEEN_AT, 0.0, 0.0], [-0.9, 0.0, 0.0], CAR);
    let (track, time) = (TrackId(1), Timestamp(NOW));
    Car { object: ObjectSweep { track, time: Some(time), boxed: car_box(SEEN_AT), cloud }, now }
}

fn car_box(x: f64) -> Box3 {
    Box3 { world_from_box: stands_at(x), size_m: Vector3::new(2.0, 0.8, 0.8) }
}

fn stands_at(x: f64) -> Pose {
    Pose::translation(x, 0.5, 0.5)
}

fn grown(boxed: &Box3) -> GrownBox {
    GrownBox::new(&boxed.size_m, &BoxGrowth { scale: 1.0, margin_m: 0.0 })
}

fn standing(x: f64) -> StandingBox {
    let (boxed, grid_from_box) = (car_box(x), stands_at(x));
    StandingBox { track: TrackId(1), grown: grown(&boxed), boxed, grid_from_box }
}

impl Car {
    /// The car alone in the world, the reference lidar at x = 9.5.
    fn alone(&self) -> Instant<'_> {
        let boxed = &self.object.boxed;
        let placed = PlacedObject {
            object: &self.object,
            grid_from_seen_box: boxed.world_from_box,
            seen: grown(boxed),
            grid_from_box: self.now.map(stands_at),
        };
        Instant {
            time: Timestamp(NOW),
            grid_from_world: Pose::identity(),
            reference_lidar: point([9.5, 0.5, 0.5]),
            background: vec![],
            objects: vec![placed],
            standing: self.now.map(standing).into_iter().collect(),
        }
    }

    fn counts(&self, settings: &RaySettings) -> RayCounts {
        cast(&self.alone(), &row(10, 1.0), settings)
    }
}

const HIT_AT_1: [u32; 10] = [0, 1, 0, 0, 0, 0, 0, 0, 0, 0];

#[test]
fn section_8_own_world_parts_stay_where_they_were_seen_and_object_parts_move() {
    let moved = car(Some(2.5)).counts(&PLAIN);
    assert_eq!(moved.hits.values(), HIT_AT_1);
    assert_eq!(moved.crossings.values(), [0, 0, 1, 1, 0, 0, 0, 0, 1, 1]);
}

#[test]
fn section_8_own_both_parts_of_a_standing_car_are_the_whole_ray() {
    let stayed = car(Some(SEEN_AT)).counts(&PLAIN);
    assert_eq!(stayed.hits.values(), [0, 0, 0, 0, 0, 1, 0, 0, 0, 0]);
    assert_eq!(stayed.crossings.values(), [0, 0, 0, 0, 0, 0, 1, 1, 1, 1]);
}

#[test]
fn section_8_own_an_entry_voxel_counts_for_the_object_part_alone() {
    let absent = car(None).counts(&PLAIN);
    assert_eq!(absent.crossings.values()[7], 0, "the world part leaves the entry's voxel out");
    let stayed = car(Some(SEEN_AT)).counts(&PLAIN);
    assert_eq!(stayed.crossings.values()[7], 1, "for the object part it is the origin's");
}

#[test]
fn section_8_own_an_origin_inside_the_box_has_no_world_part() {
    let seen = |lidar, now| car_seen_from(lidar, now).counts(&PLAIN).crossings.into_values();
    assert_eq!(seen(7.4, None), [0; 10]);
    assert_eq!(seen(7.5, None), [0; 10], "the face is inside");
    assert_eq!(seen(7.4, Some(2.5)), [0, 0, 1, 1, 0, 0, 0, 0, 0, 0], "to the origin itself");
    assert_eq!(seen(8.5, None), [0, 0, 0, 0, 0, 0, 0, 0, 1, 0]);
}

#[test]
fn section_8_own_near_rules_of_both_parts_use_the_true_ends() {
    let car = car(Some(2.5));
    let crossings = |settings| car.counts(&settings).crossings.into_values();
    // The point was seen in voxel 5 and stands in 1 now.
    let near_hit = RaySettings { ignore_near_hit_m: 3.0, ..PLAIN };
    assert_eq!(crossings(near_hit), [0, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
    // The origin was in voxel 9; moved along with the box it would be in 5.
    let near_origin = RaySettings { ignore_near_origin_m: 2.0, ..PLAIN };
    assert_eq!(crossings(near_origin), [0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn section_8_own_drop_judges_a_world_part_by_the_point_as_it_stood_then() {
    let drop = RaySettings { outside: Outside::Drop, ..PLAIN };
    let now_outside = car(Some(-5.5)).counts(&drop);
    assert_eq!(now_outside.hits.values(), [0; 10]);
    assert_eq!(now_outside.crossings.values(), [0, 0, 0, 0, 0, 0, 0, 0, 1, 1]);
    let seen_outside = |settings| {
        let from_below = car_seen_from(-9.5, Some(2.5));
        cast(&from_below.alone(), &row(5, 1.0), settings)
    };
    assert_eq!(seen_outside(&PLAIN).crossings.values(), [1; 5], "a world part through the grid");
    assert_eq!(seen_outside(&drop).crossings.values(), [0; 5]);
    assert_eq!(seen_outside(&drop).hits.values(), [0, 1, 0, 0, 0], "the point now");
}

#[test]
fn section_8_current_is_one_ray_from_the_reference_lidar() {
    let current = RaySettings { object_rays: ObjectRays::Current, ..PLAIN };
    let moved = car(Some(2.5)).counts(&current);
    assert_eq!(moved.hits.values(), HIT_AT_1);
    assert_eq!(moved.crossings.values(), [0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
    let near = RaySettings { ignore_near_hit_m: 1.0, ignore_near_origin_m: 2.0, ..current };
    let near = car(Some(2.5)).counts(&near);
    assert_eq!(near.crossings.values(), [0, 0, 0, 1, 1, 1, 1, 0, 0, 0]);
}

#[test]
fn section_8_hits_are_hits_alone() {
    let hits = RaySettings { object_rays: ObjectRays::Hits, ..PLAIN };
    let moved = car(Some(2.5)).counts(&hits);
    assert_eq!(moved.hits.values(), HIT_AT_1);
    assert_eq!(moved.crossings.values(), [0; 10]);
}

#[test]
fn section_8_absent_tracks_give_their_world_parts_under_own_and_else_nothing() {
    let rays = [ObjectRays::Own, ObjectRays::Current, ObjectRays::Hits];
    let [own, current, hits] =
        rays.map(|object_rays| car(None).counts(&RaySettings { object_rays, ..PLAIN }));
    assert_eq!(own.crossings.values(), [0, 0, 0, 0, 0, 0, 0, 0, 1, 1]);
    assert_eq!(own.hits.values(), [0; 10]);
    for nothing in [current, hits] {
        assert_eq!(nothing.hits.values(), [0; 10]);
        assert_eq!(nothing.crossings.values(), [0; 10]);
    }
}

/// A background ray over the whole row to a point in voxel 2, seen so many ns after the keyframe,
/// while a car stands in [3.5, 5.5].
fn beside_a_car(after: i64, object_rays: ObjectRays) -> RayCounts {
    let scene = scene(vec![(after, along_x(9.5, 2.5))]);
    let standing = vec![standing(4.5)];
    let instant = Instant { time: Timestamp(NOW), standing, ..Instant::still(&scene) };
    cast(&instant, &row(10, 1.0), &RaySettings { object_rays, ..PLAIN })
}

const WHOLE: [u32; 10] = [0, 0, 0, 1, 1, 1, 1, 1, 1, 1];
/// The centres of voxels 3 and 5 lie on the box's faces, which are closed.
const FORGOTTEN: [u32; 10] = [0, 0, 0, 0, 0, 0, 1, 1, 1, 1];

#[test]
fn section_8_the_same_time_is_closed_and_counts_in_boxes_too() {
    for (after, expected) in [
        (0, WHOLE),
        (50_000_000, WHOLE),
        (-50_000_000, WHOLE),
        (50_000_001, FORGOTTEN),
        (-50_000_001, FORGOTTEN),
    ] {
        let counts = beside_a_car(after, ObjectRays::Own);
        assert_eq!(counts.crossings.values(), expected, "{after} ns");
        assert_eq!(counts.hits.values()[2], 1, "{after} ns: hits stay");
    }
}

#[test]
fn section_8_air_of_another_time_is_forgotten_to_the_ends_of_a_long_box() {
    let scene = scene(vec![(9_000_000_000, along_x(20.5, -5.5))]);
    let boxed = Box3 { size_m: Vector3::new(10.0, 0.8, 0.8), ..car_box(6.5) };
    let bus = StandingBox { grown: grown(&boxed), boxed, ..standing(6.5) };
    let instant = Instant { time: Timestamp(NOW), standing: vec![bus], ..Instant::still(&scene) };
    let counts = cast(&instant, &row(14, 1.0), &PLAIN);
    assert_eq!(counts.crossings.values(), [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1]);
}

#[test]
fn section_8_the_same_time_is_a_rule_of_own_rays() {
    for object_rays in [ObjectRays::Current, ObjectRays::Hits] {
        assert_eq!(beside_a_car(9_000_000_000, object_rays).crossings.values(), WHOLE);
    }
}

#[test]
fn section_8_air_of_another_time_keeps_its_hits_in_boxes() {
    let scene = scene(vec![(9_000_000_000, along_x(9.5, 4.5))]);
    let instant =
        Instant { time: Timestamp(NOW), standing: vec![standing(4.5)], ..Instant::still(&scene) };
    let counts = cast(&instant, &row(10, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0, 0, 0, 0, 1, 0, 0, 0, 0, 0]);
    assert_eq!(counts.crossings.values(), FORGOTTEN);
}

#[test]
fn section_8_sweeps_of_both_times_forget_only_the_other() {
    let scene = scene(vec![(0, along_x(9.5, 2.5)), (9_000_000_000, along_x(9.5, 2.5))]);
    let instant =
        Instant { time: Timestamp(NOW), standing: vec![standing(4.5)], ..Instant::still(&scene) };
    let counts = cast(&instant, &row(10, 1.0), &PLAIN);
    assert_eq!(counts.crossings.values(), [0, 0, 0, 1, 1, 1, 2, 2, 2, 2]);
}

#[test]
fn section_8_world_parts_of_another_time_are_forgotten_and_object_parts_never() {
    let crossings = |now, others, after| {
        let mut car = car(now);
        car.object.time = Some(Timestamp(NOW + after));
        let mut instant = car.alone();
        instant.standing.extend(others);
        cast(&instant, &row(10, 1.0), &PLAIN).crossings.into_values()
    };
    let late = 9_000_000_000;
    let in_own_box = crossings(Some(2.5), None, late);
    assert_eq!(in_own_box, [0, 0, 1, 1, 0, 0, 0, 0, 1, 1], "the object part in its own box");
    let in_another = crossings(None, Some(standing(9.5)), late);
    assert_eq!(in_another, [0; 10], "the world part in [8.5, 10.5]");
    let same_time = crossings(None, Some(standing(9.5)), 50_000_000);
    assert_eq!(same_time, [0, 0, 0, 0, 0, 0, 0, 0, 1, 1]);
    let absent = crossings(None, None, late);
    assert_eq!(absent, [0, 0, 0, 0, 0, 0, 0, 0, 1, 1], "no box stands where it was seen");
}

#[test]
fn section_6_background_moves_from_world_to_grid_with_its_origins() {
    let scene = scene(vec![(0, along_x(100.5, 104.5))]);
    let grid_from_world = Pose::translation(-100.0, 0.0, 0.0);
    let instant = Instant { time: Timestamp(NOW), grid_from_world, ..Instant::still(&scene) };
    let counts = cast(&instant, &row(6, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0, 0, 0, 0, 1, 0]);
    assert_eq!(counts.crossings.values(), [1, 1, 1, 1, 0, 0]);
}

#[test]
fn an_empty_instant_counts_nothing() {
    let scene = scene(vec![(0, PointCloud::with_origins(vec![]))]);
    let counts = cast(&Instant::still(&scene), &row(3, 1.0), &PLAIN);
    assert_eq!(counts.hits.values(), [0; 3]);
    assert_eq!(counts.crossings.values(), [0; 3]);
}
