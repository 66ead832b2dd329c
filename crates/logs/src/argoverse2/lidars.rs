//! The two lidars of the roof, one upside down below the other, and which points are whose.

use nalgebra::Point3;
use occlabel_core::{Fault, Pose};

use super::poses::Mountings;

/// Beams of a lidar: lasers 0 to 31 are of one, 32 to 63 of the other.
const BEAMS: usize = 32;

/// Both lidars' mountings.
#[derive(Debug)]
pub(super) struct Lidars {
    pub(super) ego_from_up: Pose,
    pub(super) ego_from_down: Pose,
}

impl Lidars {
    /// Finds them among the mountings of all sensors.
    ///
    /// # Errors
    /// If one is not there.
    pub(super) fn of(mountings: &Mountings) -> Result<Self, Fault> {
        let pose = |name| mountings.pose(name);
        Ok(Self { ego_from_up: pose("up_lidar")?, ego_from_down: pose("down_lidar")? })
    }

    /// Whether lasers 0 to 31 are `up_lidar`'s, as the format does not say: a beam's elevation is
    /// nearly the same all around in its own lidar only. Points in the ego frame.
    pub(super) fn first_is_up(&self, points: &[Point3<f64>], lasers: &[i64]) -> bool {
        let spread = |first: &Pose, second: &Pose| {
            let lidars = [first.inverse(), second.inverse()];
            let mut sums = [[0.0; 3]; 2 * BEAMS];
            for (point, &laser) in points.iter().zip(lasers) {
                let local = lidars[usize::from(laser >= BEAMS as i64)] * point;
                let slope = local.z / (local.x * local.x + local.y * local.y).sqrt().max(1.0);
                let sum = &mut sums[laser as usize];
                *sum = [sum[0] + 1.0, sum[1] + slope, sum[2] + slope * slope];
            }
            let of_beam = |[n, s, ss]: &[f64; 3]| ss - s * s / n.max(1.0);
            sums.iter().map(of_beam).sum::<f64>()
        };
        let (up, down) = (&self.ego_from_up, &self.ego_from_down);
        spread(up, down) <= spread(down, up)
    }
}

/// Whether all lasers are some lidar's.
pub(super) fn are_lasers(lasers: &[i64]) -> bool {
    lasers.iter().all(|laser| (0..2 * BEAMS as i64).contains(laser))
}

/// Whether a laser is of the first half.
pub(super) fn is_first(laser: i64) -> bool {
    laser < BEAMS as i64
}
