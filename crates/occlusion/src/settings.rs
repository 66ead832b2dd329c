//! What a user can set.

use serde::{Deserialize, Serialize};

/// The `[occlusion]` table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OcclusionSettings {
    /// Which rays are cast.
    pub rays: CameraRays,
    /// Which voxels end a ray.
    pub occluders: Occluders,
    /// Under `pixels`: every how many-th pixel of each row and column, at least 1.
    pub pixel_stride: usize,
    /// How far a camera sees, metres.
    pub depth_max_m: f64,
}

/// Which rays a camera casts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CameraRays {
    /// To the centre of each occupied voxel in view (Occ3D text, GS-Occ3D).
    OccupiedCenters,
    /// To the centre of each voxel in view.
    AllCenters,
    /// Through pixel centres (Occ3D Algorithm 3, with the text's stop).
    Pixels,
}

/// Which occupied voxels end a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Occluders {
    /// All of them.
    All,
    /// All but those of flat classes, which are seen wherever they are in view (published masks).
    NonFlat,
}
