//! A lidar, and what it measures in a world.

use nalgebra::Point3;
use occlabel_core::{Fault, Pose, Timestamp};
use rayon::prelude::*;
use serde::Deserialize;

use crate::check::{inside, lengths, within};
use crate::clock::Clock;
use crate::noise::Chance;
use crate::pattern::Pattern;
use crate::rotation::PoseFile;
use crate::{Hit, Instant, Ray, World};

/// A `[[lidar]]` of a world file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LidarFile {
    name: String,
    mounting: PoseFile,
    pattern: Pattern,
    rate_hz: f64,
    #[serde(default)]
    pub(crate) offset_s: f64,
    max_range_m: f64,
    #[serde(default)]
    range_noise_m: f64,
    #[serde(default)]
    dropout: f64,
    #[serde(default)]
    rolling: bool,
    #[serde(default = "yes")]
    deskew: bool,
}

fn yes() -> bool {
    true
}

/// A lidar of a world.
#[derive(Clone, Debug)]
pub struct Lidar {
    /// Its name.
    pub name: String,
    /// Its mounting; its own x axis is where its revolution begins.
    pub ego_from_lidar: Pose,
    /// Its rays.
    pub pattern: Pattern,
    /// When its sweeps begin.
    pub clock: Clock,
    /// What is farther gives no return, metres.
    pub max_range_m: f64,
    /// Deviation of the measured range, metres.
    pub range_noise_m: f64,
    /// Share of returns that are lost.
    pub dropout: f64,
    /// Whether each shot has its own time; if not, all are taken when the sweep begins.
    pub rolling: bool,
    /// Whether the recorder moves the points of a rolling sweep to where the lidar stood at the
    /// sweep's time; if not, they are logged as if all were measured there.
    pub deskew: bool,
}

/// One return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Number of its shot within the sweep.
    pub shot: usize,
    /// Number of its ray within the shot.
    pub ring: usize,
    /// When it was measured.
    pub time: Timestamp,
    /// Where it was measured, noise included, in the lidar's frame at that time, metres.
    pub position_m: Point3<f64>,
    /// What was hit; its distance is the true one.
    pub hit: Hit,
}

impl TryFrom<LidarFile> for Lidar {
    type Error = Fault;

    fn try_from(file: LidarFile) -> Result<Self, Fault> {
        let clock = Clock::new(file.rate_hz, file.offset_s)?;
        inside("pattern", file.pattern.check())?;
        lengths("max_range_m", &[file.max_range_m])?;
        within("range_noise_m", file.range_noise_m, 0.0, 1e3)?;
        within("dropout", file.dropout, 0.0, 1.0)?;
        Ok(Self {
            name: file.name,
            ego_from_lidar: inside("mounting", file.mounting.try_into())?,
            pattern: file.pattern,
            clock,
            max_range_m: file.max_range_m,
            range_noise_m: file.range_noise_m,
            dropout: file.dropout,
            rolling: file.rolling,
            deskew: file.deskew,
        })
    }
}

impl Lidar {
    /// When a shot of a sweep is fired.
    pub fn shot_time(&self, sweep: usize, shot: usize) -> Timestamp {
        let share = shot as f64 / self.pattern.shots() as f64;
        self.clock.tick(sweep, if self.rolling { share } else { 0.0 })
    }

    /// The lidar's pose in a world at a time.
    pub fn world_from_lidar(&self, world: &World, time: Timestamp) -> Pose {
        world.world_from_ego(time.seconds_since(Timestamp(0))) * self.ego_from_lidar
    }

    /// All true first hits of a sweep, shot by shot, without noise and dropout. Parallel over shots.
    pub fn true_sweep(&self, world: &World, sweep: usize) -> Vec<Return> {
        let frozen = (!self.rolling).then(|| world.at_time(self.shot_time(sweep, 0)));
        let fire = |shot| match &frozen {
            Some(instant) => self.fire(world, instant, sweep, shot),
            None => self.fire(world, &world.at_time(self.shot_time(sweep, shot)), sweep, shot),
        };
        let shots: Vec<_> = (0..self.pattern.shots()).into_par_iter().map(fire).collect();
        shots.concat()
    }

    /// The returns of a sweep as measured, shot by shot. Parallel over shots; the same on any
    /// number of threads.
    pub fn sweep(&self, world: &World, sweep: usize) -> Vec<Return> {
        let measure = |found: Return| self.measure(found, &self.chance(world, sweep, &found));
        self.true_sweep(world, sweep).into_iter().filter_map(measure).collect()
    }

    /// The chance of a ray of a sweep. Draws 0 to 2 are the sensor's own.
    pub(crate) fn chance(&self, world: &World, sweep: usize, found: &Return) -> Chance {
        let ray = found.shot * self.pattern.rings() + found.ring;
        Chance::new(world.seed, world.lidar_number(&self.name), sweep, ray)
    }

    fn fire(&self, world: &World, instant: &Instant, sweep: usize, shot: usize) -> Vec<Return> {
        let time = self.shot_time(sweep, shot);
        let world_from_lidar = self.world_from_lidar(world, time);
        let cast = |ring| {
            let direction = self.pattern.direction(sweep, shot, ring);
            let local = Ray { origin: Point3::origin(), direction };
            let hit = instant.cast(&local.moved(&world_from_lidar), self.max_range_m)?;
            let position_m = local.at(hit.distance_m);
            // A lidar inside a solid sees nothing.
            (hit.distance_m > 0.0).then_some(Return { shot, ring, time, position_m, hit })
        };
        (0..self.pattern.rings()).filter_map(cast).collect()
    }

    /// What the sensor makes of a true hit; none if it loses it.
    fn measure(&self, found: Return, chance: &Chance) -> Option<Return> {
        let measured_m = found.hit.distance_m + self.range_noise_m * chance.normal();
        let stretch = measured_m / found.hit.distance_m;
        let kept = chance.uniform(0) >= self.dropout && measured_m > 0.0;
        kept.then(|| Return { position_m: found.position_m * stretch, ..found })
    }
}
