//! What is exactly known of a voxel of a simulated drive at a keyframe.

use crate::{ClassId, ClassSet, TrackId};

/// The truth about one voxel, whatever any label says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VoxelTruth {
    /// Share of its volume that is solid; above 0 wherever any solid reaches into the voxel.
    pub solid: f32,
    /// Whether a surface between solid and air passes through it.
    pub surface: bool,
    /// Distance of its centre to the nearest such surface, in voxels (of the shortest edge); 4 if
    /// it is farther.
    pub surface_distance: f32,
    /// Distance of its nearest point to the nearest solid, in voxels (of the shortest edge): 0 where
    /// a solid reaches into it; none if that is farther than one voxel, or was not measured.
    pub clearance: Option<f32>,
    /// The class that most of its surface to the air has (of its volume, if it is full); none if
    /// it is empty, or of a part that has no class.
    pub class: Option<ClassId>,
    /// The class that most of its `ends` are of, the lowest on ties: what labels.md section 7 would
    /// make of points that all carry their true class. None without ends.
    pub hit_class: Option<ClassId>,
    /// All classes whose surface to the air passes through it.
    pub classes: ClassSet,
    /// The mover that it belongs to, if its class is that of one.
    pub instance: Option<TrackId>,
    /// Rigid velocity of that mover at its centre in the grid frame, metres per second; NaN if the
    /// mover's next annotation is missing; 0 without a mover.
    pub flow: [f32; 3],
    /// Whether it is empty now, but some mover's solid passed through it at the time of another
    /// sweep.
    pub swept: bool,
    /// How many noise-free rays of the logged pattern end in it.
    pub ends: u32,
    /// How many rays of a four times denser pattern end in it.
    pub dense_ends: u32,
    /// Whether a noise-free ray of the logged pattern passes through it to an end behind it.
    pub crossed: bool,
    /// One bit per camera that has a true line of sight to its centre, or into it on that line.
    pub sight: u16,
    /// How many rays through pixels of the keyframe's cameras end in it; 0 if none were cast.
    pub camera_ends: u32,
}
