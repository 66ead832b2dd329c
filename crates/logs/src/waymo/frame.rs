//! The `Frame` message of v1: one revolution of all lidars, and all that goes with it.
//!
//! Field numbers are those of the format's public dataset.proto and label.proto.

use std::io::{Read, Seek};

use nalgebra::Vector3;
use occlabel_core::{Fault, Timestamp};

use super::calibration::{Context, read_context};
use super::segment::{BoxLabel, Frame, Image, Lidar, LidarCalibration, Place, camera_name};
use crate::transform::{A_POSE, pose_from_matrix};
use crate::wire::{Defect, Fields, Span, Value, first_of, text};

/// Fields of `Frame`.
const CONTEXT: u32 = 1;
const TIME: u32 = 2;
const POSE: u32 = 3;
const IMAGES: u32 = 4;
const LASERS: u32 = 5;
const LABELS: u32 = 6;

/// Whose frame it is and of what time, microseconds: found without reading on.
pub(super) fn read_head<S: Read + Seek>(
    source: &mut S,
    record: Span,
    file: &str,
) -> Result<(String, i64), Fault> {
    let place = frame_place(file, record, "head of a frame");
    let broken = |defect| broken(&place, 0, defect);
    let head = first_of(source, record, [CONTEXT, TIME]).map_err(broken)?;
    let [Some(Value::Bytes(context)), Some(Value::Varint(micros))] = head else {
        return Err(place.fault("frame-message", "a frame with context and time", "none"));
    };
    let [name] = first_of(source, context, [1]).map_err(broken)?;
    match name {
        Some(Value::Bytes(name)) => Ok((text(source, name).map_err(broken)?, micros as i64)),
        _ => Err(place.fault("frame-message", "a context with a name", "none")),
    }
}

/// A frame without its range images, and its context.
///
/// # Errors
/// If it is no such message, or its pose or its lidars' mountings cannot be used.
pub(super) fn read_frame<S: Read + Seek>(
    source: &mut S,
    record: Span,
    (file, micros): (&str, i64),
) -> Result<(Frame, Context), Fault> {
    let place = frame_place(file, record, &format!("frame {micros}"));
    let broken = |defect| broken(&place, 0, defect);
    let fields = Fields::read(source, record).map_err(broken)?;
    let context = read_context(source, fields.bytes(CONTEXT), &place)?;
    let pose = transform(source, fields.bytes(POSE)).map_err(broken)?;
    let world_from_ego = pose_from_matrix(&pose)
        .map_err(|found| place.fault("frame-pose", format!("a frame's pose of {A_POSE}"), found))?;
    let lidars = lidars(source, &fields).map_err(broken)?;
    let images = fields.all(IMAGES).map(|span| image(source, span, &place));
    let images = images.filter_map(Result::transpose).collect::<Result<_, _>>().map_err(broken)?;
    let boxes = fields.all(LABELS).map(|span| box_label(source, span, &place));
    let boxes = boxes.collect::<Result<_, _>>().map_err(broken)?;
    let time = Timestamp::from_micros(micros);
    Ok((Frame { place, time, world_from_ego, lidars, images, boxes }, context))
}

/// The lidars' calibrations of the frame that fills a record in memory.
///
/// # Errors
/// If it is no such message, or a mounting cannot be used.
pub(super) fn read_lidars<S: Read + Seek>(
    source: &mut S,
    fields: &Fields,
    place: &Place,
) -> Result<Vec<LidarCalibration>, Fault> {
    Ok(read_context(source, fields.bytes(CONTEXT), place)?.lidars)
}

/// The message of one lidar, if the frame has it.
pub(super) fn laser<S: Read + Seek>(
    source: &mut S,
    frame: &Fields,
    lidar: Lidar,
) -> Result<Option<Fields>, Defect> {
    for span in frame.all(LASERS) {
        let laser = Fields::read(source, span)?;
        if laser.integer(1).and_then(Lidar::of_number) == Some(lidar) {
            return Ok(Some(laser));
        }
    }
    Ok(None)
}

/// Where a frame stands.
pub(super) fn frame_place(file: &str, record: Span, what: &str) -> Place {
    Place { file: file.into(), record: what.into(), offset: Some(record.start) }
}

/// The fault of a defect at a byte of a source that begins at byte `start` of the file.
pub(super) fn broken(place: &Place, start: u64, defect: Defect) -> Fault {
    place.fault("frame-message", defect.expected, defect.found).offset(start + defect.at)
}

/// The 16 numbers of a `Transform`; none if it is absent.
pub(super) fn transform<S: Read + Seek>(
    source: &mut S,
    span: Option<Span>,
) -> Result<Vec<f64>, Defect> {
    let Some(span) = span else { return Ok(Vec::new()) };
    Fields::read(source, span)?.doubles(source, 1)
}

/// The lidars that have a range image, each with whether it is labelled.
fn lidars<S: Read + Seek>(source: &mut S, frame: &Fields) -> Result<Vec<(Lidar, bool)>, Defect> {
    let mut lidars = Vec::new();
    for span in frame.all(LASERS) {
        let laser = Fields::read(source, span)?;
        let lidar = laser.integer(1).and_then(Lidar::of_number);
        let (Some(lidar), Some(first)) = (lidar, laser.bytes(2)) else { continue };
        let first = Fields::read(source, first)?;
        let is_there = |number| first.bytes(number).is_some_and(|span: Span| span.len() > 0);
        if is_there(2) {
            lidars.push((lidar, is_there(6)));
        }
    }
    Ok(lidars)
}

/// An image of a camera that has a name.
fn image<S: Read + Seek>(
    source: &mut S,
    span: Span,
    frame: &Place,
) -> Result<Option<Image>, Defect> {
    let image = Fields::read(source, span)?;
    let Some(camera) = image.integer(1).and_then(camera_name) else { return Ok(None) };
    let world_from_ego = transform(source, image.bytes(3))?;
    let seconds = |number| image.double(number).unwrap_or(f64::NAN);
    let readout_s = seconds(8) - seconds(7) - seconds(6);
    let (place, time_s) = (frame.clone(), seconds(5));
    let jpeg = image.bytes(2).filter(|jpeg| jpeg.len() > 0);
    Ok(Some(Image { place, camera, world_from_ego, time_s, readout_s, jpeg }))
}

fn box_label<S: Read + Seek>(
    source: &mut S,
    span: Span,
    frame: &Place,
) -> Result<BoxLabel, Defect> {
    let label = Fields::read(source, span)?;
    let track = label.bytes(4).map(|id| text(source, id)).transpose()?.unwrap_or_default();
    let upright = match label.bytes(1) {
        Some(span) => Fields::read(source, span)?,
        None => Fields::default(),
    };
    let number = |field| upright.double(field).unwrap_or(f64::NAN);
    Ok(BoxLabel {
        place: Place { offset: Some(span.start), ..frame.clone() },
        track,
        kind: label.integer(3).unwrap_or(0),
        center_m: Vector3::new(number(1), number(2), number(3)),
        size_m: Vector3::new(number(5), number(4), number(6)),
        heading_rad: number(7),
    })
}
