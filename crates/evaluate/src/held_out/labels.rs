//! Labels as the judge reads them.

use occlabel_core::{ClassId, GridSpec, OccupancyLabels, StandingBox, VoxelGrid, VoxelState};

/// What labels say of a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is known.
    Unobserved,
    /// Nothing is there.
    Free,
    /// Something of this class is there.
    Occupied(ClassId),
}

impl Verdict {
    /// Whether something is there.
    #[inline]
    pub fn is_occupied(self) -> bool {
        matches!(self, Self::Occupied(_))
    }

    /// What the labels of a keyframe say of each voxel.
    pub fn of_labels(labels: &OccupancyLabels) -> VoxelGrid<Self> {
        labels.states.zip_map(&labels.semantics, |state, &class| match state {
            VoxelState::Occupied => Self::Occupied(ClassId(class)),
            VoxelState::Free => Self::Free,
            VoxelState::Unobserved => Self::Unobserved,
        })
    }
}

/// The labels of a keyframe.
#[derive(Clone, Copy, Debug)]
pub struct Labels<'a> {
    /// Where the voxels are.
    pub spec: &'a GridSpec,
    /// What is said of each.
    pub verdicts: &'a VoxelGrid<Verdict>,
    /// Voxels whose centre lies in the grown box of a track that stands at the keyframe, if any: what
    /// background rays of another time say of them says nothing about the keyframe.
    pub standing: Option<&'a VoxelGrid<bool>>,
}

impl Labels<'_> {
    /// Whether something is in the voxel at this place of the flat array.
    #[inline]
    pub(super) fn is_occupied(&self, flat: usize) -> bool {
        self.verdicts.values()[flat].is_occupied()
    }

    /// Whether a track stands there now.
    #[inline]
    pub(super) fn is_standing(&self, flat: usize) -> bool {
        self.standing.is_some_and(|standing| standing.values()[flat])
    }

    /// The voxels in which tracks stand.
    pub fn standing_voxels(spec: &GridSpec, boxes: &[StandingBox]) -> VoxelGrid<bool> {
        let mut standing = VoxelGrid::filled(spec, false);
        for boxed in boxes {
            let box_from_grid = boxed.grid_from_box.inverse();
            let centre = boxed.grid_from_box.translation.vector.into();
            for voxel in spec.voxels_near(&centre, boxed.grown.radius()) {
                let is_inside = boxed.grown.contains(&(box_from_grid * spec.centre(voxel)));
                if let (true, Some(flat)) = (is_inside, spec.flat(voxel)) {
                    standing.values_mut()[flat] = true;
                }
            }
        }
        standing
    }
}
