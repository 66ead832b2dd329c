//! What the cameras would see if every voxel were labelled right.

use occlabel_core::{VoxelGrid, VoxelTruth};
use occlabel_occlusion::{CameraRays, Lenses, Matter, OcclusionSettings, visible};

use super::judge::KnownWorld;
use super::scale::Scale;

/// What cameras see of the exact world by labels.md section 10: voxels that some camera sees, unobserved
/// ones included.
pub(super) struct ExactView {
    /// By rays through all pixels, whatever rays the labels took.
    pub(super) by_pixels: Vec<bool>,
    /// By the rays that the labels took.
    pub(super) by_rule: Vec<bool>,
}

/// The views of a keyframe's cameras. None without cameras or settings.
pub(super) fn exact_view(known: &KnownWorld, scale: &Scale) -> Option<ExactView> {
    let settings = known.occlusion.filter(|_| !known.eyes.is_empty())?;
    let pixels = OcclusionSettings { rays: CameraRays::Pixels, pixel_stride: 1, ..*settings };
    let all = known.truth.map(|truth| matter_of(truth, scale));
    // Rays go to what is occupied, and nobody labels what is inside of things.
    let surface = known.truth.map(|truth| match truth.surface {
        true => matter_of(truth, scale),
        false => Matter::Air,
    });
    let seen = |matter: &VoxelGrid<Matter>, settings: &OcclusionSettings| {
        let bits: VoxelGrid<u16> =
            visible(known.eyes, &Lenses::default(), &scale.spec, matter, settings);
        bits.values().iter().map(|&bits| bits != 0).collect()
    };
    Some(ExactView { by_pixels: seen(&all, &pixels), by_rule: seen(&surface, settings) })
}

fn matter_of(truth: &VoxelTruth, scale: &Scale) -> Matter {
    match truth.class {
        _ if truth.solid <= 0.0 => Matter::Air,
        Some(class) if scale.flat.contains(class) => Matter::Ground,
        _ => Matter::Solid,
    }
}
