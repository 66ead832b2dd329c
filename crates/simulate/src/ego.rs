//! The recording vehicle.

use nalgebra::Translation3;
use occlabel_core::{Fault, Pose};
use serde::Deserialize;

use crate::check::{inside, metres, need};
use crate::ground::Ground;
use crate::rotation::yaw_pitch_roll;
use crate::swing::Swing;
use crate::trajectory::Trajectory;

/// How far its feet stand from its origin, ahead and aside, metres.
const FEET_M: [f64; 2] = [1.3, 0.8];

/// The `[ego]` of a world, checked.
///
/// The ego frame stands on the terrain, x forward, y left, z up; roll, pitch and heave move it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ego {
    /// Where it goes.
    pub trajectory: Trajectory,
    /// About x, to the right, radians.
    #[serde(default)]
    pub roll_rad: Swing,
    /// About y, nose down, radians.
    #[serde(default)]
    pub pitch_rad: Swing,
    /// Up and down, metres.
    #[serde(default)]
    pub heave_m: Swing,
    /// Its own body as its sensors see it; none if it is left out.
    pub body: Option<EgoBody>,
}

/// The ego's own body: a box in its frame.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EgoBody {
    /// Lower corner.
    pub min_m: [f64; 3],
    /// Upper corner.
    pub max_m: [f64; 3],
    /// Its raw point label.
    pub class: String,
}

impl Ego {
    /// The ego's pose at a time.
    pub fn world_from_ego(&self, time_s: f64, ground: &Ground) -> Pose {
        let footing = ground.stand(&self.trajectory.at(time_s), FEET_M);
        let lean = yaw_pitch_roll(0.0, self.pitch_rad.at(time_s), self.roll_rad.at(time_s));
        footing * Translation3::new(0.0, 0.0, self.heave_m.at(time_s)) * lean
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        inside("trajectory", self.trajectory.check())?;
        inside("roll_rad", self.roll_rad.check())?;
        inside("pitch_rad", self.pitch_rad.check())?;
        inside("heave_m", self.heave_m.check())?;
        self.body.as_ref().map_or(Ok(()), |body| inside("body", body.check()))
    }
}

impl EgoBody {
    fn check(&self) -> Result<(), Fault> {
        metres("min_m", &self.min_m)?;
        metres("max_m", &self.max_m)?;
        let has_volume = (0..3).all(|axis| self.max_m[axis] - self.min_m[axis] > 1e-6);
        need("max_m", has_volume, "above min_m on every axis", format!("{:?}", self.max_m))
    }
}
