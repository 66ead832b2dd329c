//! Grids small enough to be counted by hand.

use occlabel_core::{ClassId, ClassSet, GridSpec, TrackId, VoxelGrid, VoxelTruth};
use occlabel_evaluate::{Figures, JudgedLabels, KnownWorld, Quality, Scale, Tally, judge};

/// The id of voxels that are not occupied.
pub(crate) const FREE: u8 = 17;
/// Class ids.
pub(crate) const ROAD: u8 = 0;
pub(crate) const CAR: u8 = 1;
pub(crate) const WALL: u8 = 2;

/// A voxel's label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Label {
    pub(crate) semantics: u8,
    pub(crate) is_observed: bool,
    pub(crate) is_camera_seen: bool,
    pub(crate) flow: [f32; 3],
}

pub(crate) const fn occupied(class: u8) -> Label {
    Label { semantics: class, is_observed: true, is_camera_seen: false, flow: [0.0; 3] }
}

pub(crate) const fn moving(class: u8, flow: [f32; 3]) -> Label {
    Label { flow, ..occupied(class) }
}

pub(crate) const EMPTY: Label = occupied(FREE);
pub(crate) const UNOBSERVED: Label = Label { is_observed: false, ..EMPTY };

/// A voxel that a surface of a class passes, seen by enough rays.
pub(crate) fn surface(class: u8) -> VoxelTruth {
    VoxelTruth {
        solid: 0.5,
        surface: true,
        clearance: Some(0.0),
        class: Some(ClassId(class)),
        hit_class: Some(ClassId(class)),
        classes: [ClassId(class)].into_iter().collect(),
        ends: 5,
        ..VoxelTruth::default()
    }
}

/// A voxel of a mover.
pub(crate) fn mover(track: u16, flow: [f32; 3]) -> VoxelTruth {
    VoxelTruth { instance: Some(TrackId(track)), flow, ..surface(CAR) }
}

/// Air that a ray passes, one voxel from a surface.
pub(crate) fn air() -> VoxelTruth {
    VoxelTruth { crossed: true, surface_distance: 1.0, ..VoxelTruth::default() }
}

/// A row of voxels of 0.4 m along x, from the origin on.
pub(crate) fn row(voxels: usize) -> Scale {
    let length_m = 0.4 * voxels as f64;
    let spec = GridSpec::new([0.0; 3], [length_m, 0.4, 0.4], [0.4; 3]).unwrap();
    scale(spec)
}

pub(crate) fn scale(spec: GridSpec) -> Scale {
    Scale {
        spec,
        classes: ["road", "car", "wall"].map(String::from).to_vec(),
        free: FREE,
        flat: [ClassId(ROAD)].into_iter().collect::<ClassSet>(),
        deformable: [ClassId(CAR)].into_iter().collect::<ClassSet>(),
        ring_m: vec![10.0, 20.0],
        noise_sigma_m: 0.0,
    }
}

/// The arrays of some labels, with the flow array.
pub(crate) struct Arrays {
    pub(crate) semantics: VoxelGrid<u8>,
    pub(crate) mask_lidar: VoxelGrid<u8>,
    pub(crate) mask_camera: VoxelGrid<u8>,
    pub(crate) flow: VoxelGrid<[f32; 3]>,
}

impl Arrays {
    pub(crate) fn new(spec: &GridSpec, labels: &[Label]) -> Self {
        let bytes =
            |of: fn(&Label) -> u8| VoxelGrid::from_values(spec, labels.iter().map(of).collect());
        Self {
            semantics: bytes(|label| label.semantics),
            mask_lidar: bytes(|label| label.is_observed.into()),
            mask_camera: bytes(|label| label.is_camera_seen.into()),
            flow: VoxelGrid::from_values(spec, labels.iter().map(|label| label.flow).collect()),
        }
    }

    pub(crate) fn judged(&self) -> JudgedLabels<'_> {
        JudgedLabels {
            semantics: &self.semantics,
            mask_lidar: &self.mask_lidar,
            mask_camera: &self.mask_camera,
            flow: Some(&self.flow),
        }
    }
}

/// The tally of pairs of label and truth, in the flat order of the scale's grid.
pub(crate) fn tally(scene: &str, pairs: &[(Label, VoxelTruth)], scale: &Scale) -> Tally {
    let (labels, truth): (Vec<Label>, Vec<VoxelTruth>) = pairs.iter().copied().unzip();
    let truth = VoxelGrid::from_values(&scale.spec, truth);
    let arrays = Arrays::new(&scale.spec, &labels);
    let known = KnownWorld { scene, truth: &truth, eyes: &[], occlusion: None };
    judge(&arrays.judged(), &known, scale).unwrap()
}

/// The quality of a row of voxels along x.
pub(crate) fn judge_row(pairs: &[(Label, VoxelTruth)]) -> Quality {
    tally("row", pairs, &row(pairs.len())).quality()
}

/// A figure and its count.
pub(crate) fn figure(figures: &Figures, name: &str) -> (Option<f64>, u64) {
    let value = figures.get(name).unwrap_or_else(|| panic!("no figure `{name}`"));
    (value.value, value.count)
}

/// A figure over everything, and its count.
pub(crate) fn all(quality: &Quality, name: &str) -> (Option<f64>, u64) {
    figure(&quality.all, name)
}
