//! The labels of a keyframe, asked by held-out rays.

use super::kind::{Kind, kinds};
use super::pass::pass;
use super::{GroundRule, HeldOutRay, Labels, Tally, flat_twin};

/// How returns are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOutSettings {
    /// How ground is told from what stands on it.
    pub ground: GroundRule,
    /// How far from a return an occupied voxel may be, metres: max(3 sigma of the range noise, a
    /// quarter of a voxel).
    pub tolerance_m: f64,
}

/// What held-out rays found in labels, and what they would find in perfect ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HeldOutTally {
    /// In the labels.
    pub labels: Tally,
    /// In the perfect labels of a flat ground: the rays that end on ground alone.
    pub floor: Tally,
}

impl std::ops::AddAssign<&Self> for HeldOutTally {
    fn add_assign(&mut self, other: &Self) {
        self.labels += &other.labels;
        self.floor += &other.floor;
    }
}

/// Asks the labels of a keyframe.
pub fn ask(labels: &Labels, rays: &[HeldOutRay], settings: &HeldOutSettings) -> HeldOutTally {
    let kinds = kinds(labels, rays, &settings.ground);
    let grounded = rays.iter().zip(&kinds).filter(|(_, kind)| **kind == Kind::Ground);
    let twin = flat_twin(labels.spec, &grounded.map(|(ray, _)| ray).collect::<Vec<_>>());
    let floor = twin.map(|twin| {
        let perfect = Labels { spec: labels.spec, verdicts: &twin.verdicts, standing: None };
        let kinds = vec![Kind::Ground; twin.rays.len()];
        pass(&perfect, &twin.rays, &kinds, settings.tolerance_m)
    });
    HeldOutTally {
        labels: pass(labels, rays, &kinds, settings.tolerance_m),
        floor: floor.unwrap_or_default(),
    }
}
