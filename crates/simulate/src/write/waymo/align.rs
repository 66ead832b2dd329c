//! How a lidar's frame is turned so that the columns of its range image meet its rays.
//!
//! Column j of W lies at (2 (W - j - 0.5) / W - 1) pi - yaw in the lidar's frame, yaw that of the
//! frame's x axis in the vehicle. So columns are fixed to the vehicle, however an upright lidar's frame
//! is turned, and rays run between them. A frame that hangs, z down, turns the other way round: then
//! columns move past the rays by twice its turn. Any lidar may be said to hang.
//!
//! ```text
//!   azimuth of ray s in the turned frame      a(s) - turn
//!   yaw of the turned frame                   about yaw(0) - turn
//!   wanted for some whole j                   pi - (j + 0.5) 2 pi / W = a(s) - turn + yaw(turn)
//! ```

use std::f64::consts::{PI, TAU};

use nalgebra::{UnitQuaternion, Vector3};
use occlabel_core::Pose;

use crate::Pattern;
use crate::rotation::yaw_pitch_roll;

/// A lidar that stands nearer to level than this, as the cosine of its tilt, has no columns.
pub(super) const LEAST_COSINE: f64 = 0.05;
/// Halvings of a column's width: what is left is below the spacing of doubles.
const HALVINGS: usize = 64;

/// A frame at the lidar's place that hangs and whose columns meet the rays: `lidar_from_format`.
pub(super) fn lidar_from_format(ego_from_lidar: &Pose, pattern: &Pattern) -> UnitQuaternion<f64> {
    let stands = (ego_from_lidar.rotation * Vector3::z()).z > 0.0;
    let hung = yaw_pitch_roll(0.0, 0.0, if stands { PI } else { 0.0 });
    let ego_from_hung = ego_from_lidar.rotation * hung;
    let step_rad = TAU / pattern.shots() as f64;
    let azimuth = azimuth_rad(&(hung.inverse() * pattern.direction(0, 0, 0)));
    let yaw = yaw_rad(&ego_from_hung);
    let column = column(azimuth + yaw, pattern.shots());
    let missing_rad = (column.ceil() - column) * step_rad;
    // How far columns have moved past the rays. A frame turned by half a turn has its x axis behind.
    let gained_rad = |turn_rad: f64| {
        let turned = yaw_rad(&(ego_from_hung * yaw_pitch_roll(turn_rad, 0.0, 0.0)));
        let (sin, cos) = libm::sincos(yaw - turned);
        turn_rad + libm::atan2(sin, cos)
    };
    let (mut low_rad, mut high_rad) = (0.0, missing_rad.min(PI));
    for _ in 0..HALVINGS {
        let middle_rad = (low_rad + high_rad) / 2.0;
        let is_enough = gained_rad(middle_rad) >= missing_rad;
        *(if is_enough { &mut high_rad } else { &mut low_rad }) = middle_rad;
    }
    hung * yaw_pitch_roll(high_rad, 0.0, 0.0)
}

/// The column, no whole number, that lies at an azimuth in the vehicle's frame.
pub(super) fn column(azimuth_rad: f64, width: usize) -> f64 {
    (PI - azimuth_rad) / TAU * width as f64 - 0.5
}

/// About z, from x.
pub(super) fn azimuth_rad(direction: &Vector3<f64>) -> f64 {
    libm::atan2(direction.y, direction.x)
}

/// Where the x axis of a turned frame points, seen from above.
pub(super) fn yaw_rad(rotation: &UnitQuaternion<f64>) -> f64 {
    azimuth_rad(&(rotation * Vector3::x()))
}
