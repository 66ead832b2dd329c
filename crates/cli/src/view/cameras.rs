//! The cameras of a log at a keyframe.

use image::RgbImage;
use occlabel_core::{Exposure, Fault, Keyframe, Pose};
use occlabel_view::CameraView;

use crate::decoded_image::decode_image;
use crate::exit::Stop;
use crate::logged_scene::LoggedScene;

/// A camera, where it stood in the keyframe's grid, and what it saw.
pub(crate) struct Shot<'a> {
    log: &'a LoggedScene,
    exposure: &'a Exposure,
    grid_from_camera: Pose,
    image: Option<RgbImage>,
}

impl Shot<'_> {
    pub(crate) fn view(&self) -> CameraView<'_> {
        let named = &self.log.scene.cameras[self.exposure.camera];
        CameraView {
            name: &named.name,
            camera: &named.camera,
            grid_from_camera: self.grid_from_camera,
            image: self.image.as_ref(),
        }
    }
}

/// The exposures of a keyframe by one camera, or by all: those ahead from left to right, then those
/// behind from left to right.
///
/// # Errors
/// If the log does not have the keyframe, it has no such camera or none, or an image cannot be read.
pub(crate) fn shots<'a>(
    log: &'a LoggedScene,
    token: &str,
    camera: Option<&str>,
) -> Result<Vec<Shot<'a>>, Stop> {
    let keyframe = log.keyframe(token).map_err(Stop::usage)?;
    let name = |exposure: &Exposure| log.scene.cameras[exposure.camera].name.as_str();
    let wanted = |exposure: &&Exposure| camera.is_none_or(|camera| camera == name(exposure));
    let grid_from_world = log.world_from_grid(keyframe).inverse();
    let placed = keyframe.exposures.iter().filter(wanted);
    let mut placed: Vec<_> =
        placed.map(|exposure| (exposure, grid_from_world * exposure.world_from_camera)).collect();
    if placed.is_empty() {
        return Err(Stop::usage(no_camera(log, keyframe, camera)));
    }
    placed.sort_by(|(_, a), (_, b)| rank(a).partial_cmp(&rank(b)).expect("finite poses"));
    let shot = |(exposure, grid_from_camera)| {
        Ok(Shot { log, exposure, grid_from_camera, image: read(log, exposure)? })
    };
    placed.into_iter().map(shot).collect()
}

/// Behind or not, and how far from the left.
fn rank(grid_from_camera: &Pose) -> (bool, f64) {
    let ahead = grid_from_camera.rotation * nalgebra::Vector3::z();
    let is_behind = ahead.x < -1e-6;
    (is_behind, -ahead.y)
}

fn read(log: &LoggedScene, exposure: &Exposure) -> Result<Option<RgbImage>, Stop> {
    let Some(bytes) = log.source.read_image(&log.scene, exposure)? else { return Ok(None) };
    let place = exposure.image.as_deref().unwrap_or(&log.scene.name);
    Ok(Some(decode_image(&bytes, place)?.into_rgb8()))
}

fn no_camera(log: &LoggedScene, keyframe: &Keyframe, camera: Option<&str>) -> Fault {
    let name = |exposure: &Exposure| log.scene.cameras[exposure.camera].name.as_str();
    let names: Vec<_> = keyframe.exposures.iter().map(name).collect();
    let place = format!("keyframe {} of the log", keyframe.token);
    match camera {
        Some(camera) if !names.is_empty() => {
            Fault::new("camera", place, names.join(", "), format!("`{camera}`"))
        }
        _ => Fault::new("camera", place, "a camera", "none at this keyframe"),
    }
}
