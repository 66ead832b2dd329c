//! What was found over keyframes.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use occlabel_dialects::KeyframeKey;
use occlabel_evaluate::compare::{Comparer, Difference};
use serde::Serialize;

/// The difference of some keyframes, and those that differ most.
#[derive(Default)]
pub(crate) struct Found {
    pub(crate) difference: Difference,
    /// Arrays that only one of the sets has.
    pub(crate) lacking: BTreeSet<String>,
    /// The most different first.
    pub(crate) worst: Vec<DifferingKeyframe>,
}

/// A keyframe that differs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DifferingKeyframe {
    pub(crate) scene: String,
    pub(crate) keyframe: String,
    /// The share of its voxels that differ.
    pub(crate) differing_share: f64,
    pub(crate) differing: u64,
    /// Mean IoU of its classes.
    pub(crate) miou: Option<f64>,
}

impl Found {
    /// Of one keyframe.
    pub(crate) fn of(
        key: &KeyframeKey,
        difference: Difference,
        lacking: BTreeSet<String>,
        comparer: &Comparer,
    ) -> Self {
        let keyframe = DifferingKeyframe {
            scene: key.scene.clone(),
            keyframe: key.token.clone(),
            differing_share: difference.differing_share().unwrap_or(0.0),
            differing: difference.differing,
            miou: difference.miou(comparer),
        };
        let worst = if keyframe.differing > 0 { vec![keyframe] } else { Vec::new() };
        Self { difference, lacking, worst }
    }

    /// With what was found in others; so many of the worst are kept, and always one.
    pub(crate) fn and(mut self, other: Self, worst: usize) -> Self {
        self.difference += &other.difference;
        self.lacking.extend(other.lacking);
        self.worst.extend(other.worst);
        self.worst.sort_by(DifferingKeyframe::order);
        self.worst.truncate(worst.max(1));
        self
    }
}

impl DifferingKeyframe {
    /// Most different first, then by name.
    fn order(&self, other: &Self) -> Ordering {
        let name = |of: &Self| (of.scene.clone(), of.keyframe.clone());
        let more = other.differing_share.total_cmp(&self.differing_share);
        more.then_with(|| name(self).cmp(&name(other)))
    }
}
