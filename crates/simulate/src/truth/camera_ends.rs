//! Where the lines of sight of pixels end.

use nalgebra::Point3;
use occlabel_core::{Exposure, VoxelTruth};
use rayon::prelude::*;

use crate::truth::TruthAt;
use crate::{Drive, Instant, Ray};

/// A ray goes through every so many-th pixel of each row and column.
const PIXEL_STRIDE: usize = 2;

/// Counts for each voxel the rays of the keyframe's cameras that end in it. Parallel over rows.
pub(super) fn fill_camera_ends(
    drive: &Drive,
    instant: &Instant,
    at: &TruthAt,
    depth_max_m: f64,
    truth: &mut [VoxelTruth],
) {
    for exposure in &at.keyframe.exposures {
        for flat in ends(drive, instant, at, exposure, depth_max_m) {
            truth[flat].camera_ends += 1;
        }
    }
}

/// The places of the voxels in which an exposure's rays end.
fn ends(
    drive: &Drive,
    instant: &Instant,
    at: &TruthAt,
    exposure: &Exposure,
    depth_max_m: f64,
) -> Vec<usize> {
    let camera = &drive.world().cameras[exposure.camera].named.camera;
    let world_from_camera = drive.world_from_camera(exposure);
    let grid_from_world = at.world_from_grid.inverse();
    let end = |column: u32, row: u32| {
        let direction = *camera.ray_of(column, row)?;
        let ray = Ray { origin: Point3::origin(), direction }.moved(&world_from_camera);
        let hit = instant.cast(&ray, depth_max_m)?;
        at.spec.flat_of(&(grid_from_world * ray.at(hit.distance_m)))
    };
    let rows: Vec<u32> = (0..camera.height).step_by(PIXEL_STRIDE).collect();
    let columns = || (0..camera.width).step_by(PIXEL_STRIDE);
    let in_row = |row: &u32| columns().filter_map(|column| end(column, *row)).collect::<Vec<_>>();
    rows.par_iter().flat_map_iter(in_row).collect()
}
