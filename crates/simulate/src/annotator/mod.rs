//! What becomes of a drive on its way into a log: labels, boxes and poses, with their faults.

mod boxes;
mod meshes;
mod poses;
mod sightings;

use occlabel_core::Fault;
use serde::Deserialize;

use crate::check::{need, within};
use crate::mover::Mover;

pub(crate) use boxes::Boxes;
pub use meshes::DrawnMesh;
pub use poses::LoggedPoses;
pub(crate) use sightings::Sightings;

/// The `[annotator]` of a world, checked. By default it is perfect.
///
/// Shares are chances: each thing draws its own from a hash of the seed and its number, so that one
/// fault switched on moves no other.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Annotator {
    /// Which sweeps have point labels.
    pub point_labels: LabelledSweeps,
    /// Share of labelled points that have another class.
    pub mislabelled_points: f64,
    /// Share of keyframes, the first excepted, that the log lacks, with all their annotations.
    pub missing_keyframes: f64,
    /// Share of a keyframe's boxes that it lacks.
    pub missing_boxes: f64,
    /// A mover with fewer returns in a keyframe's reference sweep has no box there.
    pub min_points: u32,
    /// Movers that never have a box; their points keep their own label.
    pub unlabelled_movers: Unboxed,
    /// When a mover stands where its box says.
    pub box_time: BoxTime,
    /// Deviation of a box's centre along each of its axes, metres.
    pub jitter_m: f64,
    /// Deviation of a box's heading, radians.
    pub jitter_yaw_rad: f64,
    /// Deviation of each of a box's edges, metres; none shrinks below half its true length.
    pub jitter_size_m: f64,
    /// How far a mesh stands from where its mover is, any way, metres.
    pub mesh_jitter_m: f64,
    /// By how much a mesh is turned about its box's centre, about any axis, radians.
    pub mesh_jitter_rad: f64,
    /// How far the ego's logged place drifts from the true one, as a share of the way driven; see
    /// [`LoggedPoses::world_from_ego`].
    pub pose_drift: f64,
    /// How far each sensor's logged mounting stands from its true one, metres.
    pub calibration_m: f64,
    /// By how much each sensor's logged mounting is turned from its true one, radians.
    pub calibration_rad: f64,
}

/// Which sweeps have point labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LabelledSweeps {
    /// The keyframes' reference sweeps.
    #[default]
    Keyframes,
    /// All.
    All,
    /// None.
    None,
}

/// Movers without boxes.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a share, or a list of movers' names")]
pub enum Unboxed {
    /// This share of them.
    Share(f64),
    /// Those of these names.
    Named(Vec<String>),
}

/// When a mover stands where its box at a keyframe says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoxTime {
    /// At the mean time of its returns in the keyframe's reference sweep; without a return at the
    /// sweep's time.
    #[default]
    MeanReturn,
    /// At the sweep's time.
    Sweep,
}

impl Default for Unboxed {
    fn default() -> Self {
        Self::Named(Vec::new())
    }
}

impl Annotator {
    /// Refuses shares above 1, deviations that are negative or absurd, and unknown movers.
    pub(crate) fn check(&self, movers: &[Mover]) -> Result<(), Fault> {
        within("mislabelled_points", self.mislabelled_points, 0.0, 1.0)?;
        within("missing_keyframes", self.missing_keyframes, 0.0, 1.0)?;
        within("missing_boxes", self.missing_boxes, 0.0, 1.0)?;
        within("jitter_m", self.jitter_m, 0.0, 1e3)?;
        within("jitter_yaw_rad", self.jitter_yaw_rad, 0.0, 1e3)?;
        within("jitter_size_m", self.jitter_size_m, 0.0, 1e3)?;
        within("mesh_jitter_m", self.mesh_jitter_m, 0.0, 1e3)?;
        within("mesh_jitter_rad", self.mesh_jitter_rad, 0.0, 1e3)?;
        within("pose_drift", self.pose_drift, 0.0, 1.0)?;
        within("calibration_m", self.calibration_m, 0.0, 1e3)?;
        within("calibration_rad", self.calibration_rad, 0.0, 1e3)?;
        self.unlabelled_movers.check(movers)
    }
}

impl Unboxed {
    fn check(&self, movers: &[Mover]) -> Result<(), Fault> {
        let key = "unlabelled_movers";
        match self {
            Self::Share(share) => within(key, *share, 0.0, 1.0),
            Self::Named(names) => names.iter().try_for_each(|name| {
                let known = movers.iter().any(|mover| mover.name == *name);
                need(key, known, "names of movers", format!("`{name}`"))
            }),
        }
    }
}
