//! Bodies laid over what the points say (labels.md section 9a).

use occlabel_core::{Body, GridSpec, Instant, Pose, TrackId, VoxelGrid, VoxelState, VoxelVote};
use occlabel_meshes::solid_voxels;
use occlabel_voxelize::{VoteRules, voxelize};
use rayon::prelude::*;

/// The votes of all points but those of tracks whose bodies stand there.
pub(crate) fn votes_beside(
    bodies: &[Body],
    instant: &Instant,
    spec: &GridSpec,
    rules: &VoteRules,
) -> VoxelGrid<Option<VoxelVote>> {
    if bodies.is_empty() {
        return voxelize(instant, spec, rules);
    }
    let tracks: Vec<TrackId> = bodies.iter().map(|body| body.track).collect();
    voxelize(&instant.without(&tracks), spec, rules)
}

/// A body before what is static, that before free, that before unknown (MobileOcc); of two bodies in a
/// voxel the lower track. Parallel over bodies.
pub(crate) fn lay_over(
    bodies: &[Body],
    grid_from_world: &Pose,
    spec: &GridSpec,
    votes: &mut VoxelGrid<Option<VoxelVote>>,
    states: &mut VoxelGrid<VoxelState>,
) {
    let solid = |body: &Body| solid_voxels(&body.mesh, grid_from_world, spec);
    let solids: Vec<Vec<usize>> = bodies.par_iter().map(solid).collect();
    for (body, solid) in bodies.iter().zip(solids).rev() {
        for flat in solid {
            let instance = Some(body.track);
            votes.values_mut()[flat] = Some(VoxelVote { class: body.class, instance });
            states.values_mut()[flat] = VoxelState::Occupied;
        }
    }
}
