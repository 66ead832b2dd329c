//! One ray into the counts.

use std::ops::ControlFlow;

use occlabel_core::{GridSpec, LatticePoint, RayCounts, VoxelGrid, VoxelIndex, walk};

use crate::{Outside, RayRules, RaySettings};

/// Slack of the metric rules against rounding, metres.
const EPSILON_M: f64 = 1e-9;

/// A ray to cast: walked from `end` towards `origin`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Where the walk starts: the point, or the entry into its box.
    pub(crate) end: LatticePoint,
    /// Where the walk ends: the lidar, or the entry into the box.
    pub(crate) origin: LatticePoint,
    /// Whether the walk starts at the point itself and so hits its voxel.
    pub(crate) hits: bool,
    /// The voxel of the true point.
    pub(crate) point_voxel: VoxelIndex,
    /// The voxel of the true origin.
    pub(crate) origin_voxel: VoxelIndex,
    /// Whether the point is of a flat class.
    pub(crate) is_flat: bool,
}

impl Ray {
    /// A whole ray, from a point to its lidar.
    pub(crate) fn whole(point: LatticePoint, origin: LatticePoint, is_flat: bool) -> Self {
        let (point_voxel, origin_voxel) = (point.voxel(), origin.voxel());
        Self { end: point, origin, hits: true, point_voxel, origin_voxel, is_flat }
    }
}

/// Counts of the rays cast so far.
pub(crate) struct Caster<'a> {
    spec: &'a GridSpec,
    settings: &'a RaySettings,
    counts: RayCounts,
}

impl<'a> Caster<'a> {
    pub(crate) fn new(spec: &'a GridSpec, rules: &RayRules<'a>) -> Self {
        let counts =
            RayCounts { hits: VoxelGrid::filled(spec, 0), crossings: VoxelGrid::filled(spec, 0) };
        Self { spec, settings: rules.settings, counts }
    }

    pub(crate) fn into_counts(self) -> RayCounts {
        self.counts
    }

    /// Counts the hit of a point alone.
    #[inline]
    pub(crate) fn hit(&mut self, voxel: VoxelIndex) {
        if let Some(flat) = self.spec.flat(voxel) {
            self.counts.hits.values_mut()[flat] += 1;
        }
    }

    /// Counts a ray's hit and crossings.
    #[inline]
    pub(crate) fn cast(&mut self, ray: &Ray) {
        if ray.hits {
            self.hit(ray.point_voxel);
        }
        let ends_outside = self.spec.flat(ray.point_voxel).is_none();
        if ends_outside && self.settings.outside == Outside::Drop {
            return;
        }
        let crossings = self.counts.crossings.values_mut();
        if !has_near_rules(self.settings, ray) {
            return walk(self.spec, ray.end, ray.origin, |flat, _| {
                crossings[flat] += 1;
                ControlFlow::Continue(())
            });
        }
        let near = NearRules { spec: self.spec, settings: self.settings, ray };
        walk(self.spec, ray.end, ray.origin, |flat, voxel| {
            crossings[flat] += u32::from(!near.forbid(voxel));
            ControlFlow::Continue(())
        });
    }
}

fn has_near_rules(settings: &RaySettings, ray: &Ray) -> bool {
    settings.ignore_near_hit_m > 0.0
        || settings.ignore_near_origin_m > 0.0
        || (ray.is_flat && settings.flat_ignore_dz_m > 0.0)
}

/// Where along a ray no crossing counts.
struct NearRules<'a> {
    spec: &'a GridSpec,
    settings: &'a RaySettings,
    ray: &'a Ray,
}

impl NearRules<'_> {
    #[inline]
    fn forbid(&self, voxel: [i64; 3]) -> bool {
        let (settings, ray) = (self.settings, self.ray);
        self.is_within(settings.ignore_near_hit_m, voxel, ray.point_voxel)
            || self.is_within(settings.ignore_near_origin_m, voxel, ray.origin_voxel)
            || (ray.is_flat && self.is_beside_ground(voxel))
    }

    fn is_within(&self, limit_m: f64, voxel: [i64; 3], other: VoxelIndex) -> bool {
        let size = self.spec.size_m();
        let l1: f64 = (0..3).map(|a| (voxel[a] - other.0[a]).abs() as f64 * size[a]).sum();
        limit_m > 0.0 && l1 <= limit_m + EPSILON_M
    }

    fn is_beside_ground(&self, voxel: [i64; 3]) -> bool {
        let dz = (voxel[2] - self.ray.point_voxel.0[2]).abs() as f64 * self.spec.size_m().z;
        dz < self.settings.flat_ignore_dz_m - EPSILON_M
    }
}
