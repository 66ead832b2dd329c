//! When the sensors of a world work, and which sweeps are keyframes.

use occlabel_core::{Exposure, Fault, Timestamp, nearest_exposure, reference_lidar};

use crate::World;
use crate::annotator::LoggedPoses;
use crate::check::need;
use crate::lidar::Lidar;
use crate::noise::{Chance, Kind};

/// Which lidar took a sweep, and the how many-th of its sweeps it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct SweepKey {
    pub(crate) time: Timestamp,
    pub(crate) lidar: usize,
    pub(crate) number: usize,
}

/// Every sweep of the drive, ordered by (time, lidar).
pub(crate) fn sweep_keys(world: &World) -> Vec<SweepKey> {
    let of_lidar = |(lidar, sensor): (usize, &Lidar)| {
        let ticks = sensor.clock.ticks(world.duration_s).enumerate();
        ticks.map(move |(number, time)| SweepKey { time, lidar, number })
    };
    let mut keys: Vec<_> = world.lidars.iter().enumerate().flat_map(of_lidar).collect();
    keys.sort();
    keys
}

/// The reference sweeps of the keyframes that are logged: every so many-th sweep of the reference
/// lidar, but for what the annotator misses.
///
/// # Errors
/// If `keyframe_hz` is no whole part of the reference lidar's rate.
pub(crate) fn keyframe_keys(world: &World, sweeps: &[SweepKey]) -> Result<Vec<SweepKey>, Fault> {
    let names: Vec<String> = world.lidars.iter().map(|lidar| lidar.name.clone()).collect();
    let reference = reference_lidar(&names).map_or(0, |name| world.lidar_number(name));
    let rate_hz = world.lidars[reference].clock.rate_hz();
    let stride = (rate_hz / world.keyframe_hz).round();
    let whole = stride >= 1.0 && (stride * world.keyframe_hz / rate_hz - 1.0).abs() < 1e-6;
    let expected = format!("a whole part of the reference lidar's {rate_hz} Hz");
    need("keyframe_hz", whole, &expected, world.keyframe_hz)?;
    let is_key = |key: &&SweepKey| {
        key.lidar == reference
            && key.number.is_multiple_of(stride as usize)
            && is_logged(world, key)
    };
    Ok(sweeps.iter().filter(is_key).copied().collect())
}

/// The first keyframe always is: a log without any is none.
fn is_logged(world: &World, key: &SweepKey) -> bool {
    let chance = Chance::of(world.seed, Kind::Keyframe, key.number, 0);
    key.number == 0 || chance.uniform(0) >= world.annotator.missing_keyframes
}

/// When each camera is exposed.
pub(crate) fn exposure_times(world: &World) -> Vec<Vec<Timestamp>> {
    world.cameras.iter().map(|camera| camera.clock.ticks(world.duration_s).collect()).collect()
}

/// A camera's exposure at a time, as the log has it.
pub(crate) fn exposure(
    world: &World,
    poses: &LoggedPoses,
    camera: usize,
    time: Timestamp,
) -> Exposure {
    let world_from_camera = poses.world_from_ego(world, time) * poses.ego_from_camera[camera];
    Exposure { camera, time, world_from_camera, image: None }
}

/// Of each camera the time nearest to another, the earlier on ties, if it is near enough.
pub(crate) fn nearest_exposures(
    times: &[Vec<Timestamp>],
    time: Timestamp,
) -> impl Iterator<Item = (usize, Timestamp)> {
    times.iter().enumerate().filter_map(move |(camera, times)| {
        nearest_exposure(times, |known| *known, time).map(|nearest| (camera, *nearest))
    })
}
