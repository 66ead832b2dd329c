//! Poses as the log has them.

use nalgebra::{Translation3, Vector3};
use occlabel_core::{Pose, Timestamp};

use crate::World;
use crate::noise::{Chance, Kind};
use crate::rotation::{about_axis, yaw_pitch_roll};

/// The way driven is summed in steps of this, seconds.
const STEP_S: f64 = 0.01;
/// After so long a way the heading has drifted, in radians, by the share that the place drifts.
const HEADING_WAY_M: f64 = 100.0;

/// Poses as the log has them: the true ones, with the annotator's drift and miscalibration.
#[derive(Clone, Debug)]
pub struct LoggedPoses {
    /// Mounting of each lidar.
    pub ego_from_lidar: Vec<Pose>,
    /// Mounting of each camera.
    pub ego_from_camera: Vec<Pose>,
    drift: Option<Drift>,
}

/// How the ego's logged pose leaves the true one.
#[derive(Clone, Debug)]
struct Drift {
    share: f64,
    /// Unit vector in world.
    direction: Vector3<f64>,
    /// 1 to the left, -1 to the right.
    turn: f64,
    /// The way driven until each step, metres.
    way_m: Vec<f64>,
}

impl LoggedPoses {
    pub(crate) fn new(world: &World) -> Self {
        let lidars = world.lidars.iter().map(|lidar| &lidar.ego_from_lidar);
        let cameras = world.cameras.iter().map(|camera| &camera.ego_from_camera);
        Self {
            ego_from_lidar: mountings(world, Kind::Lidar, lidars),
            ego_from_camera: mountings(world, Kind::Camera, cameras),
            drift: (world.annotator.pose_drift > 0.0).then(|| Drift::new(world)),
        }
    }

    /// The ego's logged pose.
    ///
    /// With drift e and a way s driven since time zero, its place is off by `e s` in one direction
    /// of the world, drawn once a drive, and its heading by `e s / 100 m` radians to one side.
    pub fn world_from_ego(&self, world: &World, time: Timestamp) -> Pose {
        let time_s = time.seconds_since(Timestamp(0));
        let world_from_ego = world.world_from_ego(time_s);
        let Some(drift) = &self.drift else { return world_from_ego };
        let off_m = drift.share * drift.way_m(time_s);
        let turned_rad = drift.turn * off_m / HEADING_WAY_M;
        Translation3::from(drift.direction * off_m)
            * world_from_ego
            * yaw_pitch_roll(turned_rad, 0.0, 0.0)
    }

    /// A lidar's logged pose.
    pub fn world_from_lidar(&self, world: &World, lidar: usize, time: Timestamp) -> Pose {
        self.world_from_ego(world, time) * self.ego_from_lidar[lidar]
    }

    /// Where the log has what a lidar truly sees at a time: true world to logged world.
    pub(crate) fn logged_from_true(&self, world: &World, lidar: usize, time: Timestamp) -> Pose {
        let exact = &world.lidars[lidar];
        if self.drift.is_none() && self.ego_from_lidar[lidar] == exact.ego_from_lidar {
            return Pose::identity();
        }
        self.world_from_lidar(world, lidar, time) * exact.world_from_lidar(world, time).inverse()
    }
}

impl Drift {
    fn new(world: &World) -> Self {
        let chance = Chance::of(world.seed, Kind::Drift, 0, 0);
        Self {
            share: world.annotator.pose_drift,
            direction: chance.direction(0),
            turn: if chance.uniform(0) < 0.5 { 1.0 } else { -1.0 },
            way_m: way_m(world),
        }
    }

    /// The way driven until a time, metres.
    fn way_m(&self, time_s: f64) -> f64 {
        let last = self.way_m.len() - 1;
        let steps = (time_s / STEP_S).clamp(0.0, last as f64);
        let at = (steps as usize).min(last.saturating_sub(1));
        let (before_m, after_m) = (self.way_m[at], self.way_m[(at + 1).min(last)]);
        before_m + (after_m - before_m) * (steps - at as f64)
    }
}

/// The way driven until each step of the drive, metres.
fn way_m(world: &World) -> Vec<f64> {
    let place = |step: usize| world.world_from_ego(step as f64 * STEP_S).translation.vector;
    let (mut last, mut driven_m) = (place(0), 0.0);
    let mut reach = |step: usize| {
        let next = place(step);
        driven_m += (next - std::mem::replace(&mut last, next)).norm();
        driven_m
    };
    (0..=(world.duration_s / STEP_S).ceil() as usize).map(&mut reach).collect()
}

/// Each sensor's mounting, so far moved and so much turned about its own origin as the annotator's
/// calibration is wrong.
fn mountings<'a>(
    world: &World,
    kind: Kind,
    ego_from_sensor: impl Iterator<Item = &'a Pose>,
) -> Vec<Pose> {
    let (off_m, off_rad) = (world.annotator.calibration_m, world.annotator.calibration_rad);
    let logged = |(at, pose): (usize, &Pose)| {
        let chance = Chance::of(world.seed, kind, at, 0);
        let turned = about_axis(&chance.direction(1), off_rad);
        Translation3::from(chance.direction(0) * off_m) * pose * turned
    };
    ego_from_sensor.enumerate().map(logged).collect()
}
