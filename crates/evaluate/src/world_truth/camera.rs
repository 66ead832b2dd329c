//! What the cameras would see if every voxel were labelled right.

use occlabel_core::{VoxelGrid, VoxelTruth};
use occlabel_occlusion::{CameraRays, Lenses, Matter, OcclusionSettings, visible};

use super::judge::KnownWorld;
use super::scale::Scale;

/// Labels.md section 10 on exact occupancy, by rays through all pixels, whatever rays the labels took:
/// the voxels that some camera sees, unobserved ones included. None without cameras or settings.
pub(super) fn exact_camera_mask(known: &KnownWorld, scale: &Scale) -> Option<Vec<bool>> {
    let settings = known.occlusion.filter(|_| !known.eyes.is_empty())?;
    let settings = OcclusionSettings { rays: CameraRays::Pixels, pixel_stride: 1, ..*settings };
    let matter = known.truth.map(|truth| matter_of(truth, scale));
    let bits: VoxelGrid<u16> =
        visible(known.eyes, &Lenses::default(), &scale.spec, &matter, &settings);
    Some(bits.values().iter().map(|&bits| bits != 0).collect())
}

fn matter_of(truth: &VoxelTruth, scale: &Scale) -> Matter {
    match truth.class {
        _ if truth.solid <= 0.0 => Matter::Air,
        Some(class) if scale.flat.contains(class) => Matter::Ground,
        _ => Matter::Solid,
    }
}
