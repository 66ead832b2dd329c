//! The exposures of a scene, and their pictures.

use std::collections::BTreeMap;

use occlabel_core::{Exposure, Fault, Timestamp};

use crate::Drive;
use crate::write::exposures::exposures;
use crate::write::files::Output;
use crate::write::written::Images;

use super::captures::{Capture, capture_file, push_captures};
use super::scene::{sample_at, sample_token};
use super::tables::Tables;

/// Adds the rows of exposures and writes their pictures; gives the number of these.
pub(super) fn write_images(
    drive: &Drive,
    images: Images,
    tables: &mut Tables,
    output: &Output,
) -> Result<usize, Fault> {
    let scene = drive.scene();
    let mut count = 0;
    for camera in 0..scene.cameras.len() {
        let keys = key_exposures(drive, camera);
        let exposures = exposures(drive, camera, images);
        let captures: Vec<_> =
            exposures.iter().map(|exposure| capture(drive, exposure, &keys)).collect();
        push_captures(tables, &scene.name, &captures)?;
        if images != Images::None {
            // Pictures are drawn by `render`.
            let _ = output;
            count += captures.len();
        }
    }
    Ok(count)
}

/// By time: the token of the first keyframe that an exposure serves.
fn key_exposures(drive: &Drive, camera: usize) -> BTreeMap<Timestamp, String> {
    let scene = drive.scene();
    let mut keys = BTreeMap::new();
    for keyframe in &scene.keyframes {
        for exposure in keyframe.exposures.iter().filter(|exposure| exposure.camera == camera) {
            let token = || sample_token(&scene.name, keyframe);
            keys.entry(exposure.time).or_insert_with(token);
        }
    }
    keys
}

fn capture(drive: &Drive, exposure: &Exposure, keys: &BTreeMap<Timestamp, String>) -> Capture {
    let scene = drive.scene();
    let named = &scene.cameras[exposure.camera];
    let key = keys.get(&exposure.time);
    let sample = key.cloned().unwrap_or_else(|| sample_at(drive, exposure.time));
    let world_from_ego =
        exposure.world_from_camera * drive.ego_from_camera(exposure.camera).inverse();
    Capture {
        channel: named.name.clone(),
        time: exposure.time,
        file: capture_file(&scene.name, &named.name, exposure.time, key.is_some(), "png"),
        sample: (sample, key.is_some()),
        world_from_ego,
        fileformat: "png",
        size: [named.camera.width, named.camera.height],
    }
}
