//! `count` against a slow oracle: labels.md section 8 in plain loops, one ray after the other.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeMap;

use nalgebra::{Point3, UnitQuaternion, Vector3};
use occlabel_core::{
    BackgroundSweep, Box3, BoxGrowth, ClassId, ClassSet, GridSpec, GrownBox, Instant, LatticePoint,
    Level, ObjectSweep, PlacedObject, PointCloud, Pose, RayCounts, RigidMap, StandingBox,
    Timestamp, TrackId, traverse,
};
use occlabel_raycast::{
    Casting, Crossings, ObjectRays, Outside, RayRules, RaySettings, RaySource, count,
};
use proptest::prelude::*;

const ROAD: ClassId = ClassId(11);
const POLE: ClassId = ClassId(15);
const NOW: i64 = 1_532_402_927_647_951_000;
const SAME_TIME_NS: i64 = 50_000_000;

#[test]
fn section_8_counts_are_what_the_rules_say_ray_by_ray() {
    let tally = RefCell::new(Tally::default());
    proptest!(cases(3_000), |(case in case())| {
        let oracle = Oracle::of(&case);
        let counts = case.count(case.shards);
        prop_assert_eq!(case.dense(&oracle.hits), counts.hits.values(), "hits");
        prop_assert_eq!(case.dense(&oracle.crossings), counts.crossings.values(), "crossings");
        for level in Level::all() {
            let casting = Casting { level, ..Casting::new(Crossings::HowMany, case.shards) };
            prop_assert_eq!(&case.count_by(&casting), &counts, "{:?}", level);
            let marks = case.count_by(&Casting { crossings: Crossings::Whether, ..casting });
            prop_assert_eq!(&marks.hits, &counts.hits, "{:?}", level);
            let are_any = |counts: &RayCounts| counts.crossings.map(|&n| n > 0);
            prop_assert_eq!(are_any(&marks), are_any(&counts), "{:?}", level);
        }
        tally.borrow_mut().add(&oracle.tally);
    });
    tally.borrow().assert_at_least(&[
        ("background ray", 10_000),
        ("origin outside the grid", 3_000),
        ("origin inside the grid", 3_000),
        ("hit", 5_000),
        ("crossing", 10_000),
        ("end outside, clipped", 3_000),
        ("end outside, dropped", 3_000),
        ("no crossing near the hit", 3_000),
        ("no crossing near the origin", 3_000),
        ("no crossing beside the ground", 3_000),
        ("object part", 2_500),
        ("world part of a standing track", 1_000),
        ("world part of an absent track", 700),
        ("crossing of an object part", 700),
        ("crossing of a world part", 700),
        ("no world part", 500),
        ("current ray", 1_200),
        ("hit alone", 1_200),
        ("absent, nothing", 1_000),
        ("crossing at the limit of the same time", 500),
        ("forgotten in a box", 1_000),
        ("forgotten in a box, world part", 50),
    ]);
}

#[test]
fn section_12_neither_order_nor_shards_change_the_counts() {
    let (crossings, points) = (RefCell::new(0_u64), RefCell::new(0));
    let sweep = prop::collection::vec(ray(), 1_000);
    let sweeps = prop::collection::vec((time(), sweep), 6..9);
    proptest!(cases(8), |(mut case in case(), sweeps in sweeps)| {
        // One sweep of more points than one thread takes at a time.
        let many = sweeps.iter().flat_map(|(_, rays)| rays.clone()).collect();
        case.background = sweeps.into_iter().map(|(time, rays)| Background { time, rays }).collect();
        case.background.push(Background { time: NOW, rays: many });
        *points.borrow_mut() += case.background.iter().map(|sweep| sweep.rays.len()).sum::<usize>();
        let counts = case.count(1);
        *crossings.borrow_mut() += counts.crossings.values().iter().map(|&n| u64::from(n)).sum::<u64>();
        let oracle = Oracle::of(&case);
        prop_assert_eq!(case.dense(&oracle.hits), counts.hits.values(), "hits");
        prop_assert_eq!(case.dense(&oracle.crossings), counts.crossings.values(), "crossings");
        for shards in 2..9 {
            prop_assert_eq!(&case.count(shards), &counts, "{} shards", shards);
        }
        case.background.reverse();
        case.tracks.reverse();
        prop_assert_eq!(&case.count(3), &counts, "in another order");
    });
    assert!(*points.borrow() >= 8 * 12_000, "{} points", points.borrow());
    assert!(*crossings.borrow() > 8_000, "{} crossings", crossings.borrow());
}

/// Failures are not written down: there is no source tree to keep them beside.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// How often each thing happened.
#[derive(Clone, Debug, Default)]
struct Tally(BTreeMap<&'static str, u64>);

impl Tally {
    fn note(&mut self, what: &'static str) {
        *self.0.entry(what).or_default() += 1;
    }

    fn add(&mut self, other: &Self) {
        other.0.iter().for_each(|(what, n)| *self.0.entry(what).or_default() += n);
    }

    fn assert_at_least(&self, least: &[(&'static str, u64)]) {
        println!("{self:#?}");
        for (what, n) in least {
            let found = self.0.get(what).copied().unwrap_or(0);
            assert!(found >= *n, "{what}: {found}, expected at least {n}");
        }
    }
}

/// One point with its ray.
#[derive(Clone, Debug)]
struct Ray {
    point: Point3<f64>,
    origin: Point3<f64>,
    class: ClassId,
}

/// A background sweep, grid frame: `Case::background_sweep` moves it to world.
#[derive(Clone, Debug)]
struct Background {
    time: i64,
    rays: Vec<Ray>,
}

/// The points of a track in one sweep, box coordinates.
#[derive(Clone, Debug)]
struct Sighting {
    time: i64,
    grid_from_seen_box: Pose,
    size_m: Vector3<f64>,
    rays: Vec<Ray>,
}

/// A track: where it stands at the keyframe, with its size then, and how sweeps saw it.
#[derive(Clone, Debug)]
struct Track {
    stands: Option<(Pose, Vector3<f64>)>,
    sightings: Vec<Sighting>,
}

#[derive(Clone, Debug)]
struct Case {
    min_m: [f64; 3],
    size_m: [f64; 3],
    shape: [i64; 3],
    settings: RaySettings,
    growth: BoxGrowth,
    grid_from_world: Pose,
    reference_lidar: Point3<f64>,
    background: Vec<Background>,
    tracks: Vec<Track>,
    shards: usize,
}

/// The counts as section 8 tells them.
struct Oracle<'a> {
    case: &'a Case,
    hits: BTreeMap<[i64; 3], u32>,
    crossings: BTreeMap<[i64; 3], u32>,
    tally: Tally,
}

/// A way to walk, grid frame.
struct Way {
    /// The point, or the entry into its box.
    from: Point3<f64>,
    /// The origin, or the entry into its box.
    to: Point3<f64>,
    true_point: Point3<f64>,
    true_origin: Point3<f64>,
    class: ClassId,
    /// When its air was seen; `None` where the rule of the same time does not apply.
    air_time: Option<i64>,
    part: Part,
}

#[derive(Clone, Copy, PartialEq)]
enum Part {
    Whole,
    World,
    Object,
}

impl Part {
    fn crossing(self) -> &'static str {
        match self {
            Part::Whole => "crossing of a whole ray",
            Part::World => "crossing of a world part",
            Part::Object => "crossing of an object part",
        }
    }
}

impl<'a> Oracle<'a> {
    fn of(case: &'a Case) -> Self {
        let (hits, crossings, tally) = (BTreeMap::new(), BTreeMap::new(), Tally::default());
        let mut oracle = Self { case, hits, crossings, tally };
        for sweep in &case.background {
            sweep.rays.iter().for_each(|ray| oracle.background_ray(ray, sweep.time));
        }
        for track in &case.tracks {
            for sighting in &track.sightings {
                for ray in &sighting.rays {
                    oracle.track_ray(ray, sighting, track.stands.map(|(pose, _)| pose));
                }
            }
        }
        oracle
    }

    fn background_ray(&mut self, ray: &Ray, time: i64) {
        self.tally.note("background ray");
        let point = self.case.to_world_and_back(ray.point);
        let origin = self.case.to_world_and_back(ray.origin);
        let is_inside = self.case.is_in_grid(self.case.voxel(&origin));
        self.tally.note(if is_inside {
            "origin inside the grid"
        } else {
            "origin outside the grid"
        });
        let way = whole(point, origin, ray.class);
        self.hit(&point);
        self.cross(&Way { air_time: Some(time), ..way });
    }

    fn track_ray(&mut self, ray: &Ray, sighting: &Sighting, now: Option<Pose>) {
        match (self.case.settings.object_rays, now) {
            (ObjectRays::Own, _) => {
                let entry = self.case.entry(sighting.size_m, &ray.origin, &ray.point);
                self.object_part(ray, entry, now);
                self.world_part(ray, entry, sighting, now.is_some());
            }
            (_, None) => self.tally.note("absent, nothing"),
            (ObjectRays::Current, Some(grid_from_box)) => {
                self.tally.note("current ray");
                let point = place(&grid_from_box, ray.point);
                self.hit(&point);
                self.cross(&whole(point, self.case.reference_lidar, ray.class));
            }
            (ObjectRays::Hits, Some(grid_from_box)) => {
                self.tally.note("hit alone");
                self.hit(&place(&grid_from_box, ray.point));
            }
        }
    }

    /// From entry to point, for standing tracks, placed by the keyframe's box.
    fn object_part(&mut self, ray: &Ray, entry: Point3<f64>, now: Option<Pose>) {
        let Some(grid_from_box) = now else { return };
        self.tally.note("object part");
        let [point, origin] = [ray.point, ray.origin].map(|p| place(&grid_from_box, p));
        self.hit(&point);
        let (to, part) = (place(&grid_from_box, entry), Part::Object);
        self.cross(&Way { to, part, ..whole(point, origin, ray.class) });
    }

    /// From origin to entry, for every track point, where it was seen. No hit.
    fn world_part(&mut self, ray: &Ray, entry: Point3<f64>, seen: &Sighting, stands: bool) {
        if self.case.is_in_box(seen.size_m, &ray.origin) {
            return self.tally.note("no world part");
        }
        self.tally.note(if stands {
            "world part of a standing track"
        } else {
            "world part of an absent track"
        });
        let [point, origin, from] =
            [ray.point, ray.origin, entry].map(|p| place(&seen.grid_from_seen_box, p));
        let way = whole(point, origin, ray.class);
        self.cross(&Way { from, air_time: Some(seen.time), part: Part::World, ..way });
    }

    fn hit(&mut self, point: &Point3<f64>) {
        let voxel = self.case.voxel(point);
        if self.case.is_in_grid(voxel) {
            self.tally.note("hit");
            *self.hits.entry(voxel).or_default() += 1;
        }
    }

    fn cross(&mut self, way: &Way) {
        let case = self.case;
        if !case.is_in_grid(case.voxel(&way.true_point)) {
            match case.settings.outside {
                Outside::Clip => self.tally.note("end outside, clipped"),
                Outside::Drop => return self.tally.note("end outside, dropped"),
            }
        }
        for voxel in traverse(case.snap(&way.from), case.snap(&way.to)) {
            if case.is_in_grid(voxel.0) && !self.is_forbidden(voxel.0, way) {
                self.tally.note("crossing");
                self.tally.note(way.part.crossing());
                *self.crossings.entry(voxel.0).or_default() += 1;
            }
        }
    }

    fn is_forbidden(&mut self, voxel: [i64; 3], way: &Way) -> bool {
        let (case, settings) = (self.case, &self.case.settings);
        let (point, origin) = (case.voxel(&way.true_point), case.voxel(&way.true_origin));
        let near_hit = settings.ignore_near_hit_m;
        let near_origin = settings.ignore_near_origin_m;
        let dz = (voxel[2] - point[2]).abs() as f64 * case.size_m[2];
        let broken = [
            (
                near_hit > 0.0 && case.l1(voxel, point) <= near_hit + 1e-9,
                "no crossing near the hit",
            ),
            (
                near_origin > 0.0 && case.l1(voxel, origin) <= near_origin + 1e-9,
                "no crossing near the origin",
            ),
            (
                way.class == ROAD && dz < settings.flat_ignore_dz_m - 1e-9,
                "no crossing beside the ground",
            ),
            (self.is_forgotten(voxel, way), "forgotten in a box"),
        ];
        let rules = broken.iter().filter(|(is_broken, _)| *is_broken);
        rules.clone().for_each(|(_, rule)| self.tally.note(rule));
        rules.count() > 0
    }

    fn is_forgotten(&mut self, voxel: [i64; 3], way: &Way) -> bool {
        let case = self.case;
        let (ObjectRays::Own, Some(time)) = (case.settings.object_rays, way.air_time) else {
            return false;
        };
        let centre = case.centre(voxel);
        let is_in_a_box =
            case.tracks.iter().filter_map(|track| track.stands).any(|(grid_from_box, size_m)| {
                case.is_in_box(size_m, &(grid_from_box.inverse() * centre))
            });
        let apart_s = (time - NOW).abs() as f64 / 1e9;
        if is_in_a_box && apart_s == case.settings.same_time_s {
            self.tally.note("crossing at the limit of the same time");
        }
        let is_forgotten = is_in_a_box && apart_s > case.settings.same_time_s;
        if is_forgotten && way.part == Part::World {
            self.tally.note("forgotten in a box, world part");
        }
        is_forgotten
    }
}

/// Rounded as by the matrix, not the quaternion: points lie on faces on purpose.
fn place(grid_from_there: &Pose, p: Point3<f64>) -> Point3<f64> {
    RigidMap::from(grid_from_there).apply(&p)
}

fn whole(point: Point3<f64>, origin: Point3<f64>, class: ClassId) -> Way {
    let (true_point, true_origin) = (point, origin);
    let (air_time, part) = (None, Part::Whole);
    Way { from: point, to: origin, true_point, true_origin, class, air_time, part }
}

/// The words of sections 1, 4 and 8.
impl Case {
    /// q = 2 * floor(u * 1024) + 1, u = (p - min) / size.
    fn snap(&self, p: &Point3<f64>) -> LatticePoint {
        LatticePoint(std::array::from_fn(|axis| {
            let u = (p[axis] - self.min_m[axis]) / self.size_m[axis];
            2 * (u * 1024.0).floor() as i64 + 1
        }))
    }

    fn to_world_and_back(&self, p: Point3<f64>) -> Point3<f64> {
        place(&self.grid_from_world, self.to_world(p))
    }

    fn to_world(&self, p: Point3<f64>) -> Point3<f64> {
        self.grid_from_world.inverse() * p
    }

    fn voxel(&self, p: &Point3<f64>) -> [i64; 3] {
        self.snap(p).0.map(|q| q.div_euclid(2048))
    }

    fn is_in_grid(&self, voxel: [i64; 3]) -> bool {
        (0..3).all(|axis| 0 <= voxel[axis] && voxel[axis] < self.shape[axis])
    }

    fn centre(&self, voxel: [i64; 3]) -> Point3<f64> {
        Point3::from(std::array::from_fn::<f64, 3, _>(|axis| {
            self.min_m[axis] + (voxel[axis] as f64 + 0.5) * self.size_m[axis]
        }))
    }

    fn l1(&self, a: [i64; 3], b: [i64; 3]) -> f64 {
        (0..3).map(|axis| (a[axis] - b[axis]).abs() as f64 * self.size_m[axis]).sum()
    }

    /// s/2 + m on every face, s = size * scale; but the bottom at -size_z / 2.
    fn faces(&self, size_m: Vector3<f64>) -> (Point3<f64>, Point3<f64>) {
        let upper = size_m.map(|size| size * self.growth.scale / 2.0 + self.growth.margin_m);
        (Point3::new(-upper.x, -upper.y, -size_m.z / 2.0), Point3::from(upper))
    }

    fn is_in_box(&self, size_m: Vector3<f64>, p: &Point3<f64>) -> bool {
        let (lower, upper) = self.faces(size_m);
        (0..3).all(|axis| lower[axis] <= p[axis] && p[axis] <= upper[axis])
    }

    /// Where the ray enters the box: at the origin, if that is inside, else on the near face that it
    /// meets last.
    fn entry(
        &self,
        size_m: Vector3<f64>,
        origin: &Point3<f64>,
        point: &Point3<f64>,
    ) -> Point3<f64> {
        if self.is_in_box(size_m, origin) {
            return *origin;
        }
        let (lower, upper) = self.faces(size_m);
        let way = point - origin;
        let mut latest = 0.0_f64;
        for axis in 0..3 {
            if way[axis] > 0.0 {
                latest = latest.max((lower[axis] - origin[axis]) / way[axis]);
            } else if way[axis] < 0.0 {
                latest = latest.max((upper[axis] - origin[axis]) / way[axis]);
            }
        }
        origin + way * latest.min(1.0)
    }

    fn dense(&self, counts: &BTreeMap<[i64; 3], u32>) -> Vec<u32> {
        let spec = self.spec();
        spec.voxels().map(|voxel| counts.get(&voxel.0).copied().unwrap_or(0)).collect()
    }
}

/// The same case in the words of the crates.
impl Case {
    fn count(&self, shards: usize) -> RayCounts {
        self.count_by(&Casting::new(Crossings::HowMany, shards))
    }

    fn count_by(&self, casting: &Casting) -> RayCounts {
        let flat: ClassSet = [ROAD].into_iter().collect();
        let rules = RayRules { settings: &self.settings, flat: &flat };
        let background: Vec<_> =
            self.background.iter().map(|sweep| self.background_sweep(sweep)).collect();
        let objects: Vec<_> = self.tracks.iter().map(|track| self.object_sweeps(track)).collect();
        let placed = self.tracks.iter().zip(&objects);
        let instant = Instant {
            time: Timestamp(NOW),
            grid_from_world: self.grid_from_world,
            reference_lidar: self.reference_lidar,
            background: background.iter().map(Cow::Borrowed).collect(),
            objects: placed.flat_map(|(track, sweeps)| self.placed(track, sweeps)).collect(),
            standing: self.tracks.iter().filter_map(|track| self.standing(track)).collect(),
        };
        count(&instant, &self.spec(), &rules, casting)
    }

    fn spec(&self) -> GridSpec {
        let max = |axis| self.min_m[axis] + self.shape[axis] as f64 * self.size_m[axis];
        GridSpec::new(self.min_m, std::array::from_fn(max), self.size_m).unwrap()
    }

    fn background_sweep(&self, sweep: &Background) -> BackgroundSweep<ClassId> {
        let rays = sweep.rays.iter().map(|ray| Ray {
            point: self.to_world(ray.point),
            origin: self.to_world(ray.origin),
            class: ray.class,
        });
        let cloud = cloud(&rays.collect::<Vec<_>>());
        BackgroundSweep::new(Timestamp(sweep.time), cloud)
    }

    fn boxed(&self, grid_from_box: &Pose, size_m: Vector3<f64>) -> Box3 {
        Box3 { world_from_box: self.grid_from_world.inverse() * grid_from_box, size_m }
    }

    fn object_sweeps(&self, track: &Track) -> Vec<ObjectSweep> {
        let sightings = track.sightings.iter();
        sightings
            .map(|seen| ObjectSweep {
                track: TrackId(1),
                time: Some(Timestamp(seen.time)),
                boxed: self.boxed(&seen.grid_from_seen_box, seen.size_m),
                cloud: cloud(&seen.rays),
            })
            .collect()
    }

    fn placed<'a>(&self, track: &Track, sweeps: &'a [ObjectSweep]) -> Vec<PlacedObject<'a>> {
        let sightings = track.sightings.iter().zip(sweeps);
        sightings
            .map(|(seen, object)| PlacedObject {
                object,
                grid_from_seen_box: seen.grid_from_seen_box,
                seen: GrownBox::new(&seen.size_m, &self.growth),
                grid_from_box: track.stands.map(|(pose, _)| pose),
            })
            .collect()
    }

    fn standing(&self, track: &Track) -> Option<StandingBox> {
        let (grid_from_box, size_m) = track.stands?;
        let boxed = self.boxed(&grid_from_box, size_m);
        let grown = GrownBox::new(&size_m, &self.growth);
        Some(StandingBox { track: TrackId(1), boxed, grown, grid_from_box })
    }
}

/// Points that share an origin share its place in the list.
fn cloud(rays: &[Ray]) -> PointCloud<ClassId> {
    let mut cloud = PointCloud::with_origins(Vec::new());
    for ray in rays {
        let known = cloud.origins.iter().position(|origin| *origin == ray.origin);
        let at = known.unwrap_or_else(|| {
            cloud.origins.push(ray.origin);
            cloud.origins.len() - 1
        });
        cloud.push(ray.point, ray.class, at as u32);
    }
    cloud
}

/// Metres: often on faces, edges, corners and centres of voxels.
fn coordinate(reach_m: i32) -> impl Strategy<Value = f64> {
    let on_faces = (-4 * reach_m..=4 * reach_m).prop_map(|i| f64::from(i) * 0.25);
    let reach_m = f64::from(reach_m);
    prop_oneof![2 => on_faces, 3 => -reach_m..reach_m]
}

/// In the grid or around it, grid frame.
fn spot() -> impl Strategy<Value = Point3<f64>> {
    let within = |reach_m| [coordinate(reach_m), coordinate(reach_m), coordinate(reach_m)];
    prop_oneof![2 => within(1), 1 => within(4)].prop_map(Point3::from)
}

/// Turned by yaw and a little pitch, or not at all.
fn pose() -> impl Strategy<Value = Pose> {
    let turn = prop_oneof![
        2 => Just((0.0, 0.0)),
        3 => (-3.2..3.2_f64, -0.1..0.1_f64),
    ];
    (spot(), turn).prop_map(|(spot, (yaw, pitch))| {
        Pose::from_parts(spot.into(), UnitQuaternion::from_euler_angles(0.0, pitch, yaw))
    })
}

/// Of the keyframe, at the limit of the same time, a nanosecond beyond, and far off.
fn time() -> impl Strategy<Value = i64> {
    let apart = [0, SAME_TIME_NS, SAME_TIME_NS + 1, 500_000_000];
    (prop::sample::select(apart.to_vec()), prop::bool::ANY)
        .prop_map(|(apart, is_later)| if is_later { NOW + apart } else { NOW - apart })
}

fn class() -> impl Strategy<Value = ClassId> {
    prop_oneof![Just(ROAD), Just(POLE)]
}

fn ray() -> impl Strategy<Value = Ray> {
    (spot(), spot(), class()).prop_map(|(point, origin, class)| Ray { point, origin, class })
}

/// Sweeps of one origin or of several.
fn background() -> impl Strategy<Value = Background> {
    let rays = prop::collection::vec(ray(), 0..10);
    (time(), rays, prop::bool::ANY).prop_map(|(time, mut rays, is_from_one)| {
        if let (true, Some(origin)) = (is_from_one, rays.first().map(|ray| ray.origin)) {
            rays.iter_mut().for_each(|ray| ray.origin = origin);
        }
        Background { time, rays }
    })
}

/// Longer than wide or high, most of them.
fn box_size() -> impl Strategy<Value = Vector3<f64>> {
    let side = |longest_m: i32| {
        let whole = (1..=2 * longest_m).prop_map(|i| f64::from(i) * 0.5);
        prop_oneof![whole, 0.2..f64::from(longest_m)]
    };
    (side(6), side(2), side(2)).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

/// Shares of the grown box along each axis, its faces among them.
fn shares() -> impl Strategy<Value = [f64; 3]> {
    let share = || prop_oneof![1 => Just(0.0), 1 => Just(1.0), 8 => 0.0..1.0_f64];
    [share(), share(), share()]
}

fn in_box(size_m: &Vector3<f64>, growth: &BoxGrowth, shares: [f64; 3]) -> Point3<f64> {
    let half = size_m * (growth.scale / 2.0) + Vector3::repeat(growth.margin_m);
    let lower = Point3::new(-half.x, -half.y, -size_m.z / 2.0);
    let at =
        |axis: usize| (lower[axis] + (half[axis] - lower[axis]) * shares[axis]).min(half[axis]);
    Point3::new(at(0), at(1), at(2))
}

fn sighting(growth: BoxGrowth) -> impl Strategy<Value = Sighting> {
    let origin = prop_oneof![4 => spot().prop_map(|p| (None, p * 2.0)),
        1 => shares().prop_map(|shares| (Some(shares), Point3::origin()))];
    let rays = prop::collection::vec((shares(), origin, class()), 0..7);
    (time(), pose(), box_size(), rays).prop_map(move |(time, grid_from_seen_box, size_m, rays)| {
        let rays = rays.into_iter().map(|(point, (inside, far), class)| Ray {
            point: in_box(&size_m, &growth, point),
            origin: inside.map_or(far, |shares| in_box(&size_m, &growth, shares)),
            class,
        });
        Sighting { time, grid_from_seen_box, size_m, rays: rays.collect() }
    })
}

fn track(growth: BoxGrowth) -> impl Strategy<Value = Track> {
    let stands = prop::option::weighted(0.7, (pose(), box_size()));
    (stands, prop::collection::vec(sighting(growth), 0..3))
        .prop_map(|(stands, sightings)| Track { stands, sightings })
}

fn settings() -> impl Strategy<Value = RaySettings> {
    let limit = || prop_oneof![2 => Just(0.0), 1 => Just(0.5), 1 => Just(0.8), 1 => Just(1.2)];
    let outside = prop_oneof![Just(Outside::Clip), Just(Outside::Drop)];
    let object_rays = prop_oneof![
        2 => Just(ObjectRays::Own),
        1 => Just(ObjectRays::Current),
        1 => Just(ObjectRays::Hits),
    ];
    (outside, limit(), limit(), limit(), object_rays).prop_map(
        |(outside, ignore_near_hit_m, ignore_near_origin_m, flat_ignore_dz_m, object_rays)| {
            let same_time_s = SAME_TIME_NS as f64 / 1e9;
            RaySettings {
                source: RaySource::Lidar,
                outside,
                ignore_near_hit_m,
                ignore_near_origin_m,
                flat_ignore_dz_m,
                object_rays,
                same_time_s,
            }
        },
    )
}

prop_compose! {
    fn case()(growth in prop::sample::select(vec![(1.0, 0.0), (1.0, 0.1), (1.1, 0.05)]))
        (growth in Just(BoxGrowth { scale: growth.0, margin_m: growth.1 }),
        tracks in prop::collection::vec(track(BoxGrowth { scale: growth.0, margin_m: growth.1 }), 0..4),
        background in prop::collection::vec(background(), 0..5),
        size_m in prop::sample::select(vec![[0.5; 3], [0.4; 3], [0.25, 0.5, 0.75]]),
        min_m in prop::sample::select(vec![[-1.5, -1.0, -0.5], [-1.0, -1.3, -0.7]]),
        shape in [3_i64..9, 3_i64..9, 2_i64..7],
        settings in settings(),
        grid_from_world in pose(),
        reference_lidar in spot(),
        shards in 1_usize..5) -> Case {
        Case { min_m, size_m, shape, settings, growth, grid_from_world, reference_lidar, background,
            tracks, shards }
    }
}
