//! People, whose bodies are labelled whole where their surface is known.

use std::collections::BTreeMap;

use occlabel_core::{ClassId, ClassSet, VoxelTruth};

use super::judge::{JudgedLabels, KnownWorld};
use super::scale::Scale;

/// Whether somebody reaches into a voxel, whatever else does: a body comes before what it stands on.
pub(super) fn is_of_people(truth: &VoxelTruth, deformable: &ClassSet) -> bool {
    let is_own = truth.class.is_some_and(|class| deformable.contains(class));
    is_own || !truth.classes.intersection(deformable).is_empty()
}

/// Sums over the voxels of one person.
#[derive(Default)]
struct Gait {
    /// The ring and the class of its first voxel.
    first: Option<(usize, ClassId)>,
    labelled: [f64; 2],
    exact: [f64; 2],
    voxels: f64,
}

/// Of each person, by track: where they are, what they are, and how far their labelled velocity is from
/// the true one. Both are means in x and y over the voxels that are theirs, labelled as of people, and have
/// both velocities (PV).
pub(super) fn speed_errors(
    labels: &JudgedLabels,
    known: &KnownWorld,
    scale: &Scale,
) -> Vec<(usize, ClassId, f64)> {
    let Some(flow) = labels.flow else { return Vec::new() };
    let mut gaits: BTreeMap<u16, Gait> = BTreeMap::new();
    let voxels = known.truth.values().iter().zip(labels.semantics.values()).zip(flow.values());
    for (flat, ((truth, semantics), labelled)) in voxels.enumerate() {
        let Some((track, class)) = truth.instance.zip(truth.class) else { continue };
        let is_theirs = [class, ClassId(*semantics)].iter().all(|c| scale.deformable.contains(*c));
        let is_known = labelled.iter().chain(&truth.flow).all(|v| v.is_finite());
        if is_theirs && *semantics != scale.free && is_known {
            let gait = gaits.entry(track.0).or_default();
            gait.first.get_or_insert_with(|| (scale.ring_of(flat), class));
            gait.add(labelled, &truth.flow);
        }
    }
    gaits.values().filter_map(Gait::error).collect()
}

impl Gait {
    fn add(&mut self, labelled: &[f32; 3], exact: &[f32; 3]) {
        for axis in 0..2 {
            self.labelled[axis] += f64::from(labelled[axis]);
            self.exact[axis] += f64::from(exact[axis]);
        }
        self.voxels += 1.0;
    }

    fn error(&self) -> Option<(usize, ClassId, f64)> {
        let (ring, class) = self.first?;
        let off = |axis: usize| (self.labelled[axis] - self.exact[axis]) / self.voxels;
        Some((ring, class, libm::hypot(off(0), off(1))))
    }
}
