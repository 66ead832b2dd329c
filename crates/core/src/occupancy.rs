//! What is known of each voxel, from evidence to labels.

use crate::{ClassId, TrackId, VoxelGrid};

/// The class and instance of a voxel that holds points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelVote {
    /// The class that won.
    pub class: ClassId,
    /// The track with most points of that class, if any of them is a track's.
    pub instance: Option<TrackId>,
}

/// How often each voxel was hit and crossed by rays.
#[derive(Clone, Debug, PartialEq)]
pub struct RayCounts {
    /// Points in the voxel.
    pub hits: VoxelGrid<u32>,
    /// Rays through the voxel to a point behind it.
    pub crossings: VoxelGrid<u32>,
}

/// The verdict on a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum VoxelState {
    /// Nothing is known.
    Unobserved = 0,
    /// Nothing is there.
    Free = 1,
    /// Something is there.
    Occupied = 2,
}

/// The label arrays of one keyframe, named as in the files (labels.md section 11).
#[derive(Clone, Debug)]
pub struct OccupancyLabels {
    /// The class where occupied, the taxonomy's `free` elsewhere.
    pub semantics: VoxelGrid<u8>,
    /// 1 where not unobserved.
    pub mask_lidar: VoxelGrid<u8>,
    /// 1 where some camera sees it and it is not unobserved.
    pub mask_camera: VoxelGrid<u8>,
    /// The verdict on each voxel.
    pub states: VoxelGrid<VoxelState>,
    /// What the labels rest on, if it was asked for.
    pub evidence: Option<Evidence>,
}

impl OccupancyLabels {
    /// What the labels rest on.
    ///
    /// # Panics
    /// If it was not asked for.
    pub fn evidence(&self) -> &Evidence {
        self.evidence.as_ref().expect("labels made with their evidence")
    }
}

/// The evidence arrays of one keyframe (labels.md section 11).
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Points in the voxel, saturating.
    pub hits: VoxelGrid<u16>,
    /// Rays through the voxel, saturating.
    pub crossings: VoxelGrid<u16>,
    /// 0 unobserved, 1 free, 2 occupied.
    pub state: VoxelGrid<u8>,
    /// Track id where occupied, else 0.
    pub instances: VoxelGrid<u16>,
    /// Velocity in the grid frame, metres per second.
    pub flow: VoxelGrid<[f32; 3]>,
    /// One bit per camera of the scene.
    pub camera_bits: VoxelGrid<u16>,
}
