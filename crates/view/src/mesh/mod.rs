//! Occupied voxels as meshes and points, for programs that show solids.

mod glb;
mod ply;
mod quads;

pub use glb::glb;
pub use ply::{ply_cubes, ply_points};

use occlabel_core::{GridSpec, VoxelIndex};

/// Where a corner of voxels is in the grid frame, metres.
fn corner_m(spec: &GridSpec, corner: [usize; 3]) -> [f64; 3] {
    spec.corner(VoxelIndex(corner.map(|i| i as i64))).coords.into()
}
