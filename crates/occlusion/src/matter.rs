//! What a voxel is to a camera.

use occlabel_core::{ClassSet, VoxelGrid, VoxelState, VoxelVote};

/// What a voxel is to a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matter {
    /// Not occupied, observed or not: never blocks.
    Air,
    /// Occupied by a flat class.
    Ground,
    /// Occupied by anything else.
    Solid,
}

/// What each voxel is to a camera, from its final state and class.
///
/// # Panics
/// If the grids differ in shape.
pub fn matter(
    states: &VoxelGrid<VoxelState>,
    votes: &VoxelGrid<Option<VoxelVote>>,
    flat: &ClassSet,
) -> VoxelGrid<Matter> {
    states.zip_map(votes, |state, vote| match (state, vote) {
        (VoxelState::Occupied, Some(vote)) if flat.contains(vote.class) => Matter::Ground,
        (VoxelState::Occupied, _) => Matter::Solid,
        _ => Matter::Air,
    })
}
