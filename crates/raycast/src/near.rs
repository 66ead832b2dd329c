//! Where along a ray no crossing counts (labels.md section 8).

use occlabel_core::{GridSpec, VoxelIndex};

use crate::RaySettings;
use crate::walkers::Walks;
use crate::ways::{LANES, Lane};

/// Slack of the metric rules against rounding, metres.
const EPSILON_M: f64 = 1e-9;

/// The rules of a grid.
#[derive(Clone, Copy)]
pub(crate) struct NearRules<'a> {
    spec: &'a GridSpec,
    settings: &'a RaySettings,
}

/// The ray that the rules are asked about: the voxels of its true point and origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayEnds {
    pub(crate) point: VoxelIndex,
    pub(crate) origin: VoxelIndex,
    /// Whether the point is of a flat class.
    pub(crate) is_flat: bool,
}

/// The rules of a grid with cubic voxels in steps of a whole ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NearSteps {
    /// This many steps from the point and fewer count nothing.
    pub(crate) hit: i32,
    /// This many steps to the origin and fewer count nothing.
    pub(crate) origin: i32,
    /// Rays to the ground count from this many steps along z on.
    pub(crate) ground: i32,
}

impl<'a> NearRules<'a> {
    pub(crate) fn new(spec: &'a GridSpec, settings: &'a RaySettings) -> Self {
        Self { spec, settings }
    }

    /// Whether there is any.
    pub(crate) fn are_any(&self) -> bool {
        self.settings.ignore_near_hit_m > 0.0
            || self.settings.ignore_near_origin_m > 0.0
            || self.settings.flat_ignore_dz_m > 0.0
    }

    /// Whether a voxel's crossing does not count.
    #[inline]
    pub(crate) fn forbid(&self, voxel: [i64; 3], ray: &RayEnds) -> bool {
        self.is_within(self.settings.ignore_near_hit_m, voxel, ray.point)
            || self.is_within(self.settings.ignore_near_origin_m, voxel, ray.origin)
            || (ray.is_flat && self.is_beside_ground(voxel, ray.point))
    }

    fn is_within(&self, limit_m: f64, voxel: [i64; 3], other: VoxelIndex) -> bool {
        let size = self.spec.size_m();
        let l1: f64 = (0..3).map(|a| (voxel[a] - other.0[a]).abs() as f64 * size[a]).sum();
        limit_m > 0.0 && l1 <= limit_m + EPSILON_M
    }

    fn is_beside_ground(&self, voxel: [i64; 3], point: VoxelIndex) -> bool {
        let dz = (voxel[2] - point.0[2]).abs() as f64 * self.spec.size_m().z;
        dz < self.settings.flat_ignore_dz_m - EPSILON_M
    }

    /// The rules, if there are any, in steps, which are all as long in a grid of cubic voxels: a
    /// whole ray never turns back, so the L1 distance to its ends is the number of steps.
    pub(crate) fn in_steps(&self) -> Option<NearSteps> {
        let size = self.spec.size_m();
        let within = |limit_m: f64| ((limit_m + EPSILON_M) / size.x).floor();
        let near = |limit_m: f64| if limit_m > 0.0 { within(limit_m) } else { -1.0 };
        let ground = ((self.settings.flat_ignore_dz_m - EPSILON_M) / size.z).ceil().max(0.0);
        let is_cubic = size.x == size.y && size.y == size.z;
        (self.are_any() && is_cubic).then(|| NearSteps {
            hit: near(self.settings.ignore_near_hit_m) as i32,
            origin: near(self.settings.ignore_near_origin_m) as i32,
            ground: ground as i32,
        })
    }
}

impl NearSteps {
    /// Applies the rules to whole rays, which meet `total` faces; `flat` tells which end on
    /// the ground.
    #[inline(always)]
    pub(crate) fn apply(&self, walks: &mut Walks, total: &[Lane; 3], flat: &Lane) {
        for lane in 0..LANES {
            let met: i32 = walks.from[0][lane] + walks.from[1][lane] + walks.from[2][lane];
            let all = total[0][lane] + total[1][lane] + total[2][lane];
            let ground = self.ground & flat[lane];
            walks.past_hit[lane] = met - self.hit;
            walks.to_origin[lane] = all - met - self.origin;
            walks.off_ground[lane] = walks.from[2][lane] - ground;
        }
    }
}
