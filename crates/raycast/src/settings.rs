//! The `[raycast]` table.

use occlabel_core::ClassSet;
use serde::{Deserialize, Serialize};

/// Which crossings count (labels.md section 8).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RaySettings {
    /// Whose rays tell free from unobserved.
    pub source: RaySource,
    /// What a ray that ends outside the grid tells.
    pub outside: Outside,
    /// No crossing counts this near to the hit voxel, metres of L1 distance; 0: no rule.
    pub ignore_near_hit_m: f64,
    /// No crossing counts this near to the origin's voxel, metres of L1 distance; 0: no rule.
    pub ignore_near_origin_m: f64,
    /// Rays that end on a flat class count no crossing less than this above or below, metres.
    pub flat_ignore_dz_m: f64,
    /// Which rays the points of tracks have.
    pub object_rays: ObjectRays,
    /// A sweep at most this far from the keyframe saw the same air, seconds.
    pub same_time_s: f64,
}

/// Whose rays tell free from unobserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RaySource {
    /// Those that measured the points.
    Lidar,
    /// Those of the keyframe's cameras (GS-Occ3D): points are hits alone.
    Camera,
}

/// What a ray that ends outside the grid tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outside {
    /// Its crossings inside count.
    Clip,
    /// Nothing (Occ3D).
    Drop,
}

/// Which rays the points of tracks have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ObjectRays {
    /// The ray that saw the point: in the world up to its box, then along with the box.
    Own,
    /// One from the keyframe's reference lidar (Occ3D code).
    Current,
    /// None: the hit only.
    Hits,
}

/// Settings and the classes they speak of.
#[derive(Clone, Copy, Debug)]
pub struct RayRules<'a> {
    /// The settings.
    pub settings: &'a RaySettings,
    /// The ground's classes.
    pub flat: &'a ClassSet,
}
