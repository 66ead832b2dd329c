//! Angles and heights that swing: legs, a body on its springs, a walking robot.

use std::f64::consts::TAU;

use occlabel_core::Fault;
use serde::Deserialize;

use crate::check::{angles, within};

/// A quantity that swings about a mean as a sine; radians or metres, as its key says.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Swing {
    /// What it swings about.
    pub mean: f64,
    /// How far it swings to either side.
    pub amplitude: f64,
    /// How long one swing takes.
    pub period_s: f64,
    /// Where in its swing it is at time zero.
    pub phase_rad: f64,
}

impl Default for Swing {
    fn default() -> Self {
        Self { mean: 0.0, amplitude: 0.0, period_s: 1.0, phase_rad: 0.0 }
    }
}

impl Swing {
    /// The value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        self.mean + self.amplitude * libm::sin(TAU * time_s / self.period_s + self.phase_rad)
    }

    pub(crate) fn check(&self) -> Result<(), Fault> {
        angles("mean", &[self.mean])?;
        angles("amplitude", &[self.amplitude])?;
        angles("phase_rad", &[self.phase_rad])?;
        within("period_s", self.period_s, 1e-3, 1e6)
    }
}
