//! Small random scenes.
//!
//! Points and origins stand on the lattice of rays: odd multiples of 1/2048 voxel from the grid's
//! corner. So they are snapped to where they are, a hundred micrometres from the next doubt, and no
//! rounding of a pose can move them. Boxes and cameras stand anywhere.

use nalgebra::{Point3, Vector3};
use occlabel_core::{Box3, BoxTrack, ClassId, PointCloud, PointLabel, Pose};
use proptest::collection::vec;
use proptest::prelude::*;

use super::{
    CAR, Drive, MANMADE, OTHERS, PEDESTRIAN, ROAD, TERRAIN, VEGETATION, at, camera, header,
    looking_ahead, track, upright,
};

/// One lattice unit of a voxel of 0.5 m, metres: a power of two.
const UNIT_M: f64 = 0.5 / 2048.0;

/// How large and how lively a random scene is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Points lie within so many metres of the grid's middle; half as many in z.
    pub(crate) reach_m: f64,
    /// Tracks move at most so fast along x and y, m/s, and turn so fast, rad/s.
    pub(crate) speed: f64,
    /// Fewest and most points of a sweep.
    pub(crate) points: (usize, usize),
}

/// A scene with points inside and outside the grid.
pub(crate) const LIVELY: Size = Size { reach_m: 4.6, speed: 2.0, points: (20, 120) };

/// A scene whose points stay 1 m away from the grid's sides, wherever their tracks carry them.
pub(crate) const INSIDE: Size = Size { reach_m: 2.0, speed: 1.0, points: (20, 120) };

/// A scene of several pieces of work a sweep.
pub(crate) const HEAVY: Size = Size { reach_m: 7.0, speed: 2.0, points: (4_200, 5_000) };

/// Drives of 2 to 6 sweeps, 10 a second, with up to 3 tracks and 2 cameras, and a keyframe at one of
/// the sweeps.
pub(crate) fn drives(size: Size) -> impl Strategy<Value = Drive> {
    let sweeps = vec(sweep(size), 2..=6);
    let tracks = vec(moving_box(size.speed), 0..=3);
    let eyes = vec((place(1.0), -3.1..3.1), 2);
    (sweeps, tracks, eyes, any::<prop::sample::Index>()).prop_map(|(sweeps, tracks, eyes, at)| {
        let keyframe = at.index(sweeps.len());
        assemble(sweeps, &tracks, &eyes, keyframe)
    })
}

#[derive(Clone, Debug)]
struct RandomSweep {
    /// Where the ego is, even lattice units from its place at the keyframe.
    ego: [i32; 3],
    origins: [Point3<f64>; 2],
    points: Vec<(Point3<f64>, PointLabel, bool)>,
}

fn sweep(size: Size) -> impl Strategy<Value = RandomSweep> {
    let point = (lattice_point(size.reach_m), label(), any::<bool>());
    let points = vec(point, size.points.0..=size.points.1);
    let origin = || lattice_point(3.0);
    ([-2000..2000, -2000..2000, -100..100_i32], [origin(), origin()], points)
        .prop_map(|(ego, origins, points)| RandomSweep { ego, origins, points })
}

/// An odd lattice point near the middle of the grid.
fn lattice_point(reach_m: f64) -> impl Strategy<Value = Point3<f64>> {
    let steps = (reach_m / UNIT_M / 2.0) as i32;
    [-steps..steps, -steps..steps, -steps / 2..steps / 2]
        .prop_map(|steps| Point3::from(steps.map(|step| f64::from(2 * step + 1) * UNIT_M)))
}

fn label() -> impl Strategy<Value = PointLabel> {
    let classes = vec![OTHERS, CAR, PEDESTRIAN, ROAD, TERRAIN, MANMADE, VEGETATION];
    prop_oneof![
        8 => prop::sample::select(classes).prop_map(PointLabel::Class),
        4 => Just(PointLabel::Unlabelled),
        1 => Just(PointLabel::Ignored),
    ]
}

#[derive(Clone, Debug)]
struct MovingBox {
    class: ClassId,
    centre: [f64; 3],
    size_m: [f64; 3],
    yaw_rad: f64,
    velocity: [f64; 2],
    yaw_rate: f64,
    /// First annotation and how many, 0.1 s and 0.2 s apart.
    annotated: (i32, i32),
}

fn moving_box(speed: f64) -> impl Strategy<Value = MovingBox> {
    let size = [2.0..4.0, 1.5..3.0, 1.2..2.6];
    let motion = ([-speed..speed, -speed..speed], -speed / 2.0..speed / 2.0);
    let class = prop::sample::select(vec![CAR, CAR, PEDESTRIAN, OTHERS]);
    (class, place(1.5), size, -3.1..3.1, motion, (-1..4, 1..5)).prop_map(
        |(class, centre, size_m, yaw_rad, (velocity, yaw_rate), annotated)| MovingBox {
            class,
            centre,
            size_m,
            yaw_rad,
            velocity,
            yaw_rate,
            annotated,
        },
    )
}

fn place(reach_m: f64) -> impl Strategy<Value = [f64; 3]> {
    [-reach_m..reach_m, -reach_m..reach_m, -0.4..0.4]
}

/// Where the ego is at the keyframe, world frame. Multiples of the lattice, so sums are exact.
const KEYFRAME_EGO: [f64; 3] = [640.0, -320.5, 12.25];

/// Where the lidar is on the ego: on the lattice too, because rays of `current` start there.
const LIDAR: [f64; 3] = [0.25 + UNIT_M, -0.125 + UNIT_M, 1.5 + UNIT_M];

fn assemble(
    sweeps: Vec<RandomSweep>,
    boxes: &[MovingBox],
    eyes: &[([f64; 3], f64)],
    keyframe: usize,
) -> Drive {
    let mut drive = Drive::default();
    let middle = Vector3::from(KEYFRAME_EGO);
    for (i, sweep) in sweeps.into_iter().enumerate() {
        let away = sweep.ego.map(|step| f64::from(2 * step) * UNIT_M);
        let away = if i == keyframe { Vector3::zeros() } else { away.into() };
        let world_from_ego = Pose::from_parts((middle + away).into(), Default::default());
        let to_lidar = |p: &Point3<f64>| p - away - Vector3::from(LIDAR);
        let mut cloud = PointCloud::with_origins(sweep.origins.iter().map(to_lidar).collect());
        for (p, label, is_second) in &sweep.points {
            cloud.push(to_lidar(p), *label, u32::from(*is_second));
        }
        drive.add_sweep(header(0.1 * i as f64, world_from_ego, upright(LIDAR, 0.0)), cloud);
    }
    let world_from_map = upright(KEYFRAME_EGO, 0.0);
    drive.scene.tracks = (1..).zip(boxes).map(|(id, b)| b.track(id, &world_from_map)).collect();
    drive.scene.cameras = ["BACK", "FRONT"].map(|name| camera(name, 24, 0.8)).to_vec();
    let eye =
        |(place, yaw): &([f64; 3], f64)| world_from_map * looking_ahead(&upright(*place, *yaw));
    drive.add_keyframe(keyframe, &eyes.iter().map(eye).collect::<Vec<_>>());
    drive
}

impl MovingBox {
    fn track(&self, id: u16, world_from_map: &Pose) -> BoxTrack {
        let (first, count) = self.annotated;
        let times = (0..count).map(|n| 0.1 * f64::from(first) + 0.2 * f64::from(n));
        track(id, self.class, times.map(|time| (at(time), self.at(time, world_from_map))).collect())
    }

    fn at(&self, time: f64, world_from_map: &Pose) -> Box3 {
        let [x, y, z] = self.centre;
        let place = [x + self.velocity[0] * time, y + self.velocity[1] * time, z];
        let map_from_box = upright(place, self.yaw_rad + self.yaw_rate * time);
        Box3 { world_from_box: world_from_map * map_from_box, size_m: self.size_m.into() }
    }
}

/// Settings of every stage that the presets use, and some that they do not.
pub(crate) fn settings() -> impl Strategy<Value = Vec<String>> {
    let choices: &[(&str, &[&str])] = &[
        ("raycast.object_rays", &["own", "own", "current", "hits"]),
        ("raycast.outside", &["clip", "drop"]),
        ("raycast.ignore_near_hit_m", &["0.0", "1.0"]),
        ("raycast.ignore_near_origin_m", &["0.0", "1.0"]),
        ("raycast.flat_ignore_dz_m", &["0.0", "1.0"]),
        ("raycast.same_time_s", &["0.05", "0.15"]),
        ("voxelize.vote", &["majority", "movers-first"]),
        ("states.conflict", &["occupied-wins", "ratio"]),
        ("states.min_hit_ratio", &["0.1", "0.4"]),
        ("states.free_min_crossings", &["1", "2"]),
        ("relabel.drop_ghosts", &["none", "movers"]),
        ("relabel.unknown_class", &["taxonomy", "drop"]),
        ("occlusion.rays", &["all-centers", "occupied-centers", "pixels"]),
        ("occlusion.occluders", &["all", "non-flat"]),
        ("aggregate.window_s", &["1000.0", "0.2"]),
    ];
    let setting = |(key, values): &(&'static str, &'static [&'static str])| {
        let key = *key;
        prop::sample::select(*values).prop_map(move |value| format!("{key}={value}")).boxed()
    };
    choices.iter().map(setting).collect::<Vec<_>>()
}
