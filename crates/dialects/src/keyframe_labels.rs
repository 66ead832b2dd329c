//! The labels of one keyframe, the same whatever dialect they were read from.

use std::collections::BTreeMap;

use occlabel_core::{GridSpec, VoxelGrid};
use occlabel_labels::NumberArray;

/// In `semantics`: the file has no label there, and scores leave it out.
pub const IGNORED: u8 = 255;

/// The labels of one keyframe: `[x][y][z]`, index 0 at the grid's lower corner.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyframeLabels {
    /// The grid of every array.
    pub spec: GridSpec,
    /// The index of the class in the [`ClassTable`](crate::ClassTable) where occupied, the number of
    /// classes where free, or [`IGNORED`].
    pub semantics: VoxelGrid<u8>,
    /// 1 where the lidars observed; `None` if the dialect does not say.
    pub mask_lidar: Option<VoxelGrid<u8>>,
    /// 1 where some camera sees it; `None` if the dialect does not say.
    pub mask_camera: Option<VoxelGrid<u8>>,
    /// The number of the object, 0 where there is none.
    pub instances: Option<VoxelGrid<u16>>,
    /// Velocity in the grid frame, metres per second.
    pub flow: Option<VoxelGrid<[f32; 3]>>,
    /// Arrays that only some dialects know, by the names that they share. Those of voxels are
    /// `[x][y][z]` as all others, or `[x][y][z][component]`.
    pub extras: BTreeMap<String, NumberArray>,
}

impl KeyframeLabels {
    /// Labels of which only the classes are known.
    pub fn of_semantics(spec: GridSpec, semantics: VoxelGrid<u8>) -> Self {
        Self {
            spec,
            semantics,
            mask_lidar: None,
            mask_camera: None,
            instances: None,
            flow: None,
            extras: BTreeMap::new(),
        }
    }
}

/// What is read beside semantics and masks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The numbers of the objects.
    pub instances: bool,
    /// The velocities.
    pub flow: bool,
    /// The arrays that only some dialects know.
    pub extras: bool,
}

impl Wanted {
    /// All that there is.
    pub const ALL: Self = Self { instances: true, flow: true, extras: true };
}
