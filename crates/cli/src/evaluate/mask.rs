//! Where truth is asked.

use occlabel_core::{Fault, VoxelGrid};
use occlabel_dialects::KeyframeLabels;

use crate::args::MaskArg;

/// The mask that is asked for, or the first that the truth has.
pub(crate) fn choose(asked: Option<MaskArg>, truth: &KeyframeLabels) -> MaskArg {
    asked.unwrap_or(match (&truth.mask_camera, &truth.mask_lidar) {
        (Some(_), _) => MaskArg::Camera,
        (None, Some(_)) => MaskArg::Lidar,
        (None, None) => MaskArg::None,
    })
}

/// Its name in files and reports.
pub(crate) fn name(mask: MaskArg) -> &'static str {
    match mask {
        MaskArg::Camera => "mask_camera",
        MaskArg::Lidar => "mask_lidar",
        MaskArg::None => "none",
    }
}

/// The mask of a keyframe.
///
/// # Errors
/// If the truth does not have it.
pub(crate) fn of(truth: &KeyframeLabels, mask: MaskArg) -> Result<Option<&VoxelGrid<u8>>, Fault> {
    let found = match mask {
        MaskArg::Camera => truth.mask_camera.as_ref(),
        MaskArg::Lidar => truth.mask_lidar.as_ref(),
        MaskArg::None => return Ok(None),
    };
    let absent = || {
        let fault = Fault::new("evaluate-mask", "truth", format!("a {}", name(mask)), "none");
        fault.hint("ask everywhere with --mask none")
    };
    found.ok_or_else(absent).map(Some)
}
