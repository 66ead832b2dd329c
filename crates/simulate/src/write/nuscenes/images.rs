//! The exposures of a scene, and their pictures.

use std::collections::BTreeMap;

use image::ExtendedColorType;
use occlabel_core::{Exposure, Fault, Timestamp};

use crate::write::exposures::exposures;
use crate::write::files::Output;
use crate::write::masks::write_mask;
use crate::write::png::png;
use crate::write::written::Images;
use crate::{ClassImage, Drive, render};

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
        let mut captures = Vec::new();
        for exposure in exposures(drive, camera, images) {
            let capture = capture(drive, &exposure, &keys);
            if images != Images::None {
                write_pictures(&render(drive, &exposure), &capture.file, output)?;
                count += 1;
            }
            captures.push(capture);
        }
        push_captures(tables, &scene.name, &captures)?;
    }
    Ok(count)
}

/// The picture, and beside it what class each pixel is of.
fn write_pictures(image: &ClassImage, file: &str, output: &Output) -> Result<(), Fault> {
    let size = [image.width, image.height];
    let below = file.split_once('/').map_or(file, |(_, below)| below);
    output.write(file, &png(&image.rgb, size, ExtendedColorType::Rgb8))?;
    write_mask(image, &format!("masks/{}", below.trim_end_matches(".png")), output)
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
    let world_from_ego = drive.poses().world_from_ego(drive.world(), exposure.time);
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
