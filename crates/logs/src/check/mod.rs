//! What can be wrong with a log although every file of it can be read.
//!
//! Checks are pure: of a scene's headers ([`check_poses`], cheap), and of what was gathered from its
//! sweeps, one by one ([`SweepSurvey`], [`SceneSurvey`]). Reading is the caller's. docs/check.md names
//! every rule.

mod box_points;
mod gaps;
mod ground;
mod heading;
mod jumps;
mod level;
mod neighbours;
mod own_body;
mod plane;
mod rotation;
mod severity;
mod survey;
mod thickness;
mod unknown;

use occlabel_core::{Fault, Scene, SweepHeader};

pub use severity::{Finding, Severity};
pub use survey::{SceneSurvey, SweepSurvey};
pub use unknown::UnknownSum;

/// What is odd about the poses and times of a scene, found out without reading a sweep: each can be
/// lived with, but labels are worse for it. Knowing how thick the ground comes out of the sweeps,
/// metres, tells more.
pub fn check_poses(scene: &Scene, ground_thickness_m: Option<f64>) -> Vec<Fault> {
    // Points of no time have no pose.
    let posed = scene.sweeps.iter().filter(|sweep| !sweep.points_of.is_timeless());
    let sweeps: Vec<SweepHeader> = posed.cloned().collect();
    let mut faults = rotation::rotation_steps(&sweeps);
    faults.extend(rotation::tilted(&sweeps));
    faults.extend(heading::heading(&sweeps));
    faults.extend(jumps::pose_jumps(&sweeps));
    faults.extend(gaps::sweep_gaps(&sweeps));
    faults.extend(level::level_world(&sweeps, ground_thickness_m));
    faults
}

#[cfg(test)]
mod test_drive;
