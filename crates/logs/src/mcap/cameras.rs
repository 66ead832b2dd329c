//! The cameras of a recording, and when they were exposed.

use std::collections::BTreeMap;
use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits};
use occlabel_core::camera::{
    BodyMask, BrownConrady, CameraError, CameraModel, Intrinsics, KannalaBrandt, Mei, Ocam, Pinhole,
};
use occlabel_core::{Camera, Exposure, Fault, Loss, McapSettings, NamedCamera, Timestamp};

use super::layout::FrameRoles;
use super::messages::Optics;
use super::pictures::name;
use super::recording::Recording;
use crate::notes::Notes;

/// The cameras in byte order of their names, and their exposures in order of time. One whose optics
/// are none, or change, is refused.
pub(super) fn cameras(
    recording: &Recording,
    settings: &McapSettings,
    roles: &FrameRoles,
    notes: &mut Notes,
) -> (Vec<NamedCamera>, Vec<Vec<Exposure>>) {
    let mut named: BTreeMap<&str, Vec<&Optics>> = BTreeMap::new();
    for (topic, optics) in &recording.optics {
        named.entry(name(settings, topic, optics)).or_default().push(optics);
    }
    if named.is_empty() {
        let expected = "calibrations of a camera";
        notes.warn(Fault::new("camera-absent", &recording.file, expected, "none"));
    }
    let (mut cameras, mut exposures) = (Vec::new(), Vec::new());
    for (name, optics) in named {
        let camera = camera(recording, &optics).map_err(|found| {
            let expected = format!("one calibration of camera `{name}`");
            Fault::new("camera-model", &recording.file, expected, found).record(name)
        });
        let Some(camera) = notes.accept(Loss::Camera, camera) else { continue };
        exposures.push(expose(recording, roles, &optics, (cameras.len(), name), notes));
        cameras.push(NamedCamera { name: name.to_owned(), camera });
    }
    (cameras, exposures)
}

fn camera(recording: &Recording, optics: &[&Optics]) -> Result<Camera, String> {
    let first = optics[0];
    let parts = |optics: &Optics| {
        let Optics { width, height, model, distortion, matrix, .. } = optics.clone();
        (width, height, model, distortion, matrix)
    };
    if optics.iter().any(|other| parts(other) != parts(first)) {
        return Err("several".into());
    }
    if first.width == 0 || first.height == 0 {
        return Err(format!("a size of {} x {}", first.width, first.height));
    }
    let model = model(first).map_err(|error| error.to_string())?;
    let mask = recording.masks.get(&first.header.frame);
    let body_mask = mask.map(|file| read_mask(file, first)).transpose()?;
    let (width, height) = (first.width, first.height);
    Ok(Camera { model, width, height, body_mask, rolling_shutter: None })
}

/// The model by its name; `mei` and `ocam` are ours.
pub(super) fn model(optics: &Optics) -> Result<CameraModel, CameraError> {
    let (numbers, distortion) = (&optics.matrix, &optics.distortion);
    if optics.model == "ocam" {
        return Ok(CameraModel::Ocam(ocam(distortion)?));
    }
    let (rows, _) = numbers.as_chunks::<3>();
    let matrix = <[[f64; 3]; 3]>::try_from(rows).map_err(|_| count("K", "9", numbers.len()))?;
    let lens = Intrinsics::from_matrix(&matrix)?;
    let is_straight = distortion.iter().all(|coefficient| *coefficient == 0.0);
    Ok(match optics.model.as_str() {
        "equidistant" | "kannala_brandt" | "fisheye" => {
            CameraModel::KannalaBrandt(KannalaBrandt::new(lens, distortion)?)
        }
        "mei" => CameraModel::Mei(Mei::new(lens, distortion)?),
        _ if is_straight => CameraModel::Pinhole(Pinhole::new(lens)),
        "plumb_bob" | "rational_polynomial" => {
            CameraModel::BrownConrady(BrownConrady::new(lens, distortion)?)
        }
        _ => return Err(count("distortion of an unknown model", "0", distortion.len())),
    })
}

fn ocam(numbers: &[f64]) -> Result<Ocam, CameraError> {
    let &[u, v, c, d, e, max_angle_rad, ref polynomial @ ..] = numbers else {
        return Err(count("ocam", "more than 6", numbers.len()));
    };
    Ocam::new(polynomial, [u, v], [c, d, e], max_angle_rad)
}

fn count(name: &'static str, expected: &'static str, found: usize) -> CameraError {
    CameraError::Count { name, expected, found }
}

/// An 8-bit PNG of the camera's size: what is not 0 is the vehicle's own body.
fn read_mask(file: &[u8], optics: &Optics) -> Result<BodyMask, String> {
    let mut reader = ImageReader::with_format(Cursor::new(file), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_image_width = Some(optics.width);
    limits.max_image_height = Some(optics.height);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| format!("a body mask: {error}"))?.into_luma8();
    let size = image.dimensions();
    if size != (optics.width, optics.height) {
        return Err(format!("a body mask of {} x {}", size.0, size.1));
    }
    let covered = image.into_raw().into_iter().map(|pixel| pixel != 0).collect();
    BodyMask::new(optics.width, optics.height, covered).map_err(|error| error.to_string())
}

/// A camera was exposed whenever its optics were told, or, if they were told once, at its images.
fn expose(
    recording: &Recording,
    roles: &FrameRoles,
    optics: &[&Optics],
    (camera, name): (usize, &str),
    notes: &mut Notes,
) -> Vec<Exposure> {
    let frame = &optics[0].header.frame;
    let told = optics.iter().map(|optics| optics.header.time);
    let images = recording.pictures.iter().filter(|picture| picture.frame == *frame);
    let mut times: Vec<Timestamp> = told.chain(images.map(|picture| picture.time)).collect();
    times.sort_unstable();
    times.dedup();
    let expose = |time| match recording.frames.pose(&roles.world, frame, time) {
        Ok(world_from_camera) => Some(Exposure { camera, time, world_from_camera, image: None }),
        Err(found) => {
            let expected = format!("a pose of frame `{frame}` in `{}`", roles.world);
            let fault = Fault::new("transform", &recording.file, expected, found);
            notes.warn(fault.record(format!("an image of {name}")));
            None
        }
    };
    times.into_iter().filter_map(expose).collect()
}
