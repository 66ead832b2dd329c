//! The verdict where cameras alone look (labels.md section 9).

use occlabel_core::{VoxelGrid, VoxelState};

/// What is known of each voxel when all that is known of the air is what cameras saw: occupied and free
/// voxels that some camera sees stay or become so, all others are unobserved.
///
/// `states` are occupied or not, by hits alone; `camera_bits` are those that the occupied ones leave.
///
/// # Panics
/// If the grids differ in shape.
pub fn seen(states: &VoxelGrid<VoxelState>, camera_bits: &VoxelGrid<u16>) -> VoxelGrid<VoxelState> {
    states.zip_map(camera_bits, |state, bits| match (state, bits) {
        (_, 0) => VoxelState::Unobserved,
        (VoxelState::Occupied, _) => VoxelState::Occupied,
        (VoxelState::Free | VoxelState::Unobserved, _) => VoxelState::Free,
    })
}
