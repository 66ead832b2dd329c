//! Labels as they are shown: the same whatever dialect they were read from.

use occlabel_core::{GridSpec, Palette, Pose, Timestamp, VoxelGrid};

/// In `semantics`: the file has no label there.
pub const NO_LABEL: u8 = 255;

/// What the keyframes of a scene share.
#[derive(Clone, Debug)]
pub struct ShownScene {
    /// Its name; empty if the files do not tell.
    pub name: String,
    /// The grid's frame: `ego` or `lidar`.
    pub frame: String,
    /// Names and colours of the classes, by their index in `semantics`.
    pub palette: Palette,
    /// In `semantics` where nothing stands.
    pub free: u8,
    /// Channel names: bit i of `camera_bits` is the i-th.
    pub cameras: Vec<String>,
    /// The tracks that `instances` may name.
    pub tracks: Vec<ShownTrack>,
}

impl ShownScene {
    /// Whether a value of `semantics` is a class, so that something stands there.
    pub fn is_occupied(&self, value: u8) -> bool {
        value != self.free && value != NO_LABEL
    }
}

/// A track of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShownTrack {
    /// Its number in `instances`, from 1.
    pub index: u16,
    /// The log's own id of it.
    pub id: String,
    /// The log's own category of it.
    pub category: String,
}

/// One keyframe: grids of one shape, of which only the classes are always there.
#[derive(Clone, Debug)]
pub struct ShownKeyframe {
    /// The keyframe's name.
    pub token: String,
    /// When it was, if the labels' manifest tells.
    pub time: Option<Timestamp>,
    /// Where its grid stands, if the labels' manifest tells.
    pub world_from_grid: Option<Pose>,
    /// Where the ego's forward points in the grid frame, from x towards y: 0 in the ego's own frame; if
    /// anybody tells.
    pub heading_rad: Option<f64>,
    /// The grid.
    pub spec: GridSpec,
    /// The index of the class where occupied, [`ShownScene::free`] where nothing stands, or
    /// [`NO_LABEL`].
    pub semantics: VoxelGrid<u8>,
    /// Not 0 where the lidars observed.
    pub mask_lidar: Option<VoxelGrid<u8>>,
    /// Not 0 where some camera sees it.
    pub mask_camera: Option<VoxelGrid<u8>>,
    /// Track by its index, 0 where there is none.
    pub instances: Option<VoxelGrid<u16>>,
    /// Velocity in the grid frame, metres per second; not a number where it is not known.
    pub flow: Option<VoxelGrid<[f32; 3]>>,
    /// What the labels rest on.
    pub evidence: Option<ShownEvidence>,
}

/// What the labels of a keyframe rest on (labels.md section 11).
#[derive(Clone, Debug)]
pub struct ShownEvidence {
    /// Points in the voxel, saturating.
    pub hits: VoxelGrid<u16>,
    /// Rays through the voxel, saturating.
    pub crossings: VoxelGrid<u16>,
    /// One bit a camera of the scene.
    pub camera_bits: VoxelGrid<u16>,
}
