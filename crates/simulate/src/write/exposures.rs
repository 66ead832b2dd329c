//! Which exposures a log tells of.

use occlabel_core::Exposure;

use crate::Drive;

use super::written::Images;

/// The exposures of a camera that the log tells of, in order of time: those of keyframes, or all.
pub(crate) fn exposures(drive: &Drive, camera: usize, images: Images) -> Vec<Exposure> {
    if images == Images::All {
        return drive.exposures(camera);
    }
    let of_keyframes = drive.scene().keyframes.iter().flat_map(|keyframe| &keyframe.exposures);
    let mut exposures: Vec<Exposure> =
        of_keyframes.filter(|exposure| exposure.camera == camera).cloned().collect();
    exposures.dedup_by_key(|exposure| exposure.time);
    exposures
}
