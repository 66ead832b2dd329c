//! Rotations from angles, the same on every machine.
//!
//! They call `libm`'s sine. nalgebra's own makers of rotations do so by its feature `libm-force` alone.

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use occlabel_core::{Fault, Pose};
use serde::Deserialize;

use crate::check::{angles, metres};

/// A pose as a world file says it: a place, then turns about z, the new y, the newest x.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PoseFile {
    /// Where the frame's origin stands, metres.
    pub position_m: [f64; 3],
    /// About z, to the left.
    pub yaw_rad: f64,
    /// About y, nose down.
    pub pitch_rad: f64,
    /// About x, to the right.
    pub roll_rad: f64,
}

impl TryFrom<PoseFile> for Pose {
    type Error = Fault;

    fn try_from(file: PoseFile) -> Result<Self, Fault> {
        metres("position_m", &file.position_m)?;
        angles("yaw_rad", &[file.yaw_rad])?;
        angles("pitch_rad", &[file.pitch_rad])?;
        angles("roll_rad", &[file.roll_rad])?;
        let rotation = yaw_pitch_roll(file.yaw_rad, file.pitch_rad, file.roll_rad);
        Ok(Pose::from_parts(Translation3::from(file.position_m), rotation))
    }
}

/// Turns about z, then about the new y, then about the newest x; radians.
pub(crate) fn yaw_pitch_roll(yaw: f64, pitch: f64, roll: f64) -> UnitQuaternion<f64> {
    about(2, yaw) * about(1, pitch) * about(0, roll)
}

/// The turns about x, y and z that [`yaw_pitch_roll`] takes the other way round.
pub(crate) fn roll_pitch_yaw(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let axes = rotation.to_rotation_matrix();
    let level = libm::hypot(axes[(0, 0)], axes[(1, 0)]);
    [
        libm::atan2(axes[(2, 1)], axes[(2, 2)]),
        libm::atan2(-axes[(2, 0)], level),
        libm::atan2(axes[(1, 0)], axes[(0, 0)]),
    ]
}

/// A turn about a unit vector, radians.
pub(crate) fn about_axis(axis: &Vector3<f64>, angle_rad: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = libm::sincos(angle_rad / 2.0);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, axis * sin))
}

fn about(axis: usize, angle_rad: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = libm::sincos(angle_rad / 2.0);
    let mut axial = Vector3::zeros();
    axial[axis] = sin;
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, axial))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_make_the_rotation_that_they_are_taken_from() {
        for [yaw, pitch, roll] in [[0.0; 3], [0.3, -0.2, 0.1], [-3.0, 1.5, 2.9], [2.0, -1.5, -1.0]]
        {
            let [x, y, z] = roll_pitch_yaw(&yaw_pitch_roll(yaw, pitch, roll));
            assert!((x - roll).abs() + (y - pitch).abs() + (z - yaw).abs() < 1e-12, "{x} {y} {z}");
        }
    }
}
