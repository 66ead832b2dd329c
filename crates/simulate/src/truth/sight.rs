//! Straight lines from cameras to voxels.

use nalgebra::{Point3, Vector3};
use occlabel_core::{Camera, Exposure, GridSpec, RigidMap, VoxelTruth};
use rayon::prelude::*;

use crate::truth::TruthAt;
use crate::truth::placed::TOUCH_M;
use crate::{Drive, Instant, Ray};

/// A camera as it was exposed, and the world around it.
struct Eye<'a> {
    instant: &'a Instant<'a>,
    spec: &'a GridSpec,
    camera: &'a Camera,
    camera_from_grid: RigidMap,
    world_from_grid: RigidMap,
    grid_eye: Point3<f64>,
    depth_max_m: f64,
}

/// Sets each camera's bit in the voxels that it sees: the centre is in view (labels.md section 10),
/// and no solid stands before the voxel on the way to it. Parallel over voxels.
pub(super) fn fill_sight(
    drive: &Drive,
    instant: &Instant,
    at: &TruthAt,
    depth_max_m: f64,
    truth: &mut [VoxelTruth],
) {
    for exposure in &at.keyframe.exposures {
        let eye = Eye::new(drive, instant, at, exposure, depth_max_m);
        truth.par_iter_mut().enumerate().for_each(|(flat, voxel)| {
            voxel.sight |= u16::from(eye.sees(flat)) << exposure.camera;
        });
    }
}

impl<'a> Eye<'a> {
    fn new(
        drive: &'a Drive,
        instant: &'a Instant,
        at: &'a TruthAt,
        exposure: &Exposure,
        depth_max_m: f64,
    ) -> Self {
        let world = drive.world();
        let camera = &world.cameras[exposure.camera];
        let grid_from_camera = at.world_from_grid.inverse() * drive.world_from_camera(exposure);
        Self {
            instant,
            spec: at.spec,
            camera: &camera.named.camera,
            camera_from_grid: RigidMap::from(&grid_from_camera.inverse()),
            world_from_grid: RigidMap::from(&at.world_from_grid),
            grid_eye: grid_from_camera * Point3::origin(),
            depth_max_m,
        }
    }

    fn sees(&self, flat: usize) -> bool {
        let centre = self.spec.centre(self.spec.voxel_at(flat));
        let way = centre - self.grid_eye;
        let distance_m = way.norm();
        let in_view = || self.camera.pixel_of(&self.camera_from_grid.apply(&centre)).is_some();
        distance_m <= self.depth_max_m && in_view() && self.is_open(&way, distance_m)
    }

    /// Whether the way to a voxel's centre meets nothing before it enters the voxel.
    fn is_open(&self, way: &Vector3<f64>, distance_m: f64) -> bool {
        let inside = (self.spec.size_m() / 2.0).component_div(&way.abs()).min();
        if inside >= 1.0 {
            return true;
        }
        let from = self.world_from_grid.apply(&self.grid_eye);
        let to = self.world_from_grid.apply(&(self.grid_eye + way));
        let ray = Ray { origin: from, direction: (to - from) / distance_m };
        // A face that is the voxel's own does not stand before it.
        let entry_m = distance_m * (1.0 - inside) - TOUCH_M;
        entry_m <= 0.0 || self.instant.cast(&ray, entry_m).is_none()
    }
}
