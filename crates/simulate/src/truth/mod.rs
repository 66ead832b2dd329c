//! What is exactly true of a grid's voxels at a keyframe.
//!
//! The world of a keyframe is that of [`Drive::instant`] without the ego's own body, whatever any
//! annotator or log says of it: poses, boxes and classes come from the world itself.
//!
//! - **Solid.** A voxel is solid above 0 if and only if some solid reaches into it by more than some
//!   micrometres: by parry's distance between two convex solids, or by a plane's own, not by samples.
//!   The share is exact where the solid is one plane within the voxel or a part of it; else the voxel
//!   is halved down to 1/16 of its edges, and only leaves on an edge or a curve, or where several
//!   surfaces meet, are estimated, each by the planes nearest to its centre. The error is at most
//!   those leaves' share of the volume: about 1/256 for an edge across the voxel; a curve's planes
//!   are nearly it, so that its error is far less.
//! - **Surface** is what borders on air. Where one solid lies against another, within a tenth of a
//!   millimetre, there is none. A voxel's distance to the surface is that to the nearest place of
//!   each solid that no other solid covers (and to the surfaces found within the voxel itself): a
//!   solid whose nearest place is covered is not asked for its second nearest.
//! - **Class** is that of the parts with most area in the voxel.
//! - **Flow** is by the time that truly passes between a mover's two stances.
//! - **Swept** is judged at the times of the other sweeps, as exactly as what is solid now; between
//!   them nobody looked.
//! - **Rays** are those of [`TrueRays`], moved as labels.md section 8 moves them, with the true boxes.

mod camera_ends;
mod cut;
mod dense;
mod divide;
mod flow;
mod ground_patch;
mod marks;
mod matter;
mod placed;
mod rays;
mod sight;
mod swept;
mod tally;

use occlabel_core::{GridSpec, Keyframe, Pose, VoxelGrid, VoxelTruth};

use crate::truth::placed::Placed;
use crate::{Drive, Instant};

pub use dense::dense_ends;
pub use rays::TrueRays;

/// Two times are one if they are not farther apart, seconds.
const SAME_TIME_S: f64 = 1e-3;
/// Air that is thinner than this between two solids is none, metres.
const SKIN_M: f64 = 1e-4;
/// Shares of a cell that differ by less are the same.
const ROUNDING: f64 = 1e-6;

/// Which rays count, and how far cameras see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthSettings {
    /// Rays of sweeps that are farther from the keyframe do not count, seconds.
    pub window_s: f64,
    /// The same for rays that end on movers whose parts swing.
    pub deformable_window_s: f64,
    /// What is farther from a camera is not in view, metres; `None` leaves sight and the ends of pixels' rays
    /// out.
    pub sight_depth_m: Option<f64>,
}

/// A keyframe of a drive, and where its grid truly stands.
#[derive(Clone, Copy, Debug)]
pub struct TruthAt<'a> {
    /// The keyframe.
    pub keyframe: &'a Keyframe,
    /// The grid.
    pub spec: &'a GridSpec,
    /// Where the grid's frame stands in the true world.
    pub world_from_grid: Pose,
}

/// Everything that is true of a keyframe's voxels. Parallel; the same on any number of threads.
///
/// `dense_ends`, from [`dense_ends`](dense_ends()), are 0 if left out.
pub fn keyframe_truth(
    drive: &Drive,
    rays: &TrueRays,
    at: &TruthAt,
    settings: &TruthSettings,
    dense_ends: Option<&VoxelGrid<u32>>,
) -> VoxelGrid<VoxelTruth> {
    let instant =
        Instant::without_ego(drive.world(), |mover| drive.mover_time_s(at.keyframe, mover));
    let mut truth = VoxelGrid::filled(at.spec, VoxelTruth::default());
    let voxels = truth.values_mut();
    matter::fill_matter(drive, &solids(drive, &instant, at), at.spec, voxels);
    flow::fill_flow(drive, at, voxels);
    swept::fill_swept(drive, at, voxels);
    if let Some(depth_max_m) = settings.sight_depth_m {
        sight::fill_sight(drive, &instant, at, depth_max_m, voxels);
        camera_ends::fill_camera_ends(drive, &instant, at, depth_max_m, voxels);
    }
    let marks = marks::mark_rays(drive, rays, at, settings);
    for (flat, voxel) in voxels.iter_mut().enumerate() {
        voxel.ends = marks.ends.values()[flat];
        voxel.crossed = marks.crossed.values()[flat];
        voxel.hit_class = marks.hit_class.values()[flat];
        voxel.dense_ends = dense_ends.map_or(0, |ends| ends.values()[flat]);
    }
    truth
}

/// Every solid about the grid: what stands, what moves, the ground.
fn solids<'a>(drive: &'a Drive, instant: &'a Instant, at: &TruthAt) -> Vec<Placed<'a>> {
    let grid_from_world = at.world_from_grid.inverse();
    let reach_m = at.spec.size_m().norm() * matter::FARTHEST_VOXELS;
    let ground = Placed::ground(&drive.world().ground, at.spec, &at.world_from_grid, reach_m);
    let bodies = instant.bodies().map(|body| Placed::body(body, &grid_from_world));
    bodies.chain([ground]).collect()
}
