//! Counting points where no lidar measured them (labels.md section 8).

use occlabel_core::{ClassId, GridSpec, Instant, PointCloud, Pose, RayCounts, RigidMap, VoxelGrid};

/// How many points each voxel holds; no ray is cast, so nothing is crossed.
///
/// Points of tracks that are absent count nowhere.
pub fn count_hits(instant: &Instant, spec: &GridSpec) -> RayCounts {
    let mut hits = VoxelGrid::filled(spec, 0);
    for sweep in &instant.background {
        count(&sweep.cloud, &instant.grid_from_world, spec, hits.values_mut());
    }
    for placed in &instant.objects {
        if let Some(grid_from_box) = &placed.grid_from_box {
            count(&placed.object.cloud, grid_from_box, spec, hits.values_mut());
        }
    }
    RayCounts { hits, crossings: VoxelGrid::filled(spec, 0) }
}

fn count(cloud: &PointCloud<ClassId>, grid_from_cloud: &Pose, spec: &GridSpec, hits: &mut [u32]) {
    let place = RigidMap::from(grid_from_cloud);
    for position in &cloud.positions {
        if let Some(flat) = spec.flat_of(&place.apply(position)) {
            hits[flat] += 1;
        }
    }
}
