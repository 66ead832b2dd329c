//! Foxglove's messages; field numbers as in `schemas`.

use nalgebra::Vector3;
use occlabel_core::camera::{CameraModel, Ocam};
use occlabel_core::{Box3, BoxTrack, NamedCamera, Pose, SweepHeader, Timestamp};

use crate::write::points::LoggedPoint;
use crate::write::raw_names::RawNames;

use super::WORLD;
use crate::write::wire::Wire;

/// `parent_from_child` at a time.
pub(super) fn transform(
    time: Timestamp,
    parent: &str,
    child: &str,
    parent_from_child: &Pose,
) -> Wire {
    let [x, y, z, w] = parent_from_child.rotation.coords.into();
    Wire::default()
        .message(1, &timestamp(time))
        .text(2, parent)
        .text(3, child)
        .message(4, &vector(&parent_from_child.translation.vector))
        .message(5, &numbers(&[x, y, z, w]))
}

/// A sweep's points in the frame of its lidar.
pub(super) fn point_cloud(header: &SweepHeader, points: &[LoggedPoint], names: &RawNames) -> Wire {
    let rolling = points.iter().any(|point| point.time != header.time);
    let mut layout = Layout::default();
    ["x", "y", "z"].into_iter().for_each(|name| layout.add(name, FLOAT32, 4));
    layout.add("ring", UINT16, 2);
    if header.labelled {
        layout.add("label", UINT8, 1);
    }
    if rolling {
        layout.add("offset_ns", INT32, 4);
    }
    let bytes = points.iter().flat_map(|point| {
        let mut bytes: Vec<u8> = point.position_m.iter().flat_map(|m| m.to_le_bytes()).collect();
        bytes.extend(point.ring.to_le_bytes());
        bytes.extend(header.labelled.then(|| names.number(point.label)));
        let offset_ns = (point.time.0 - header.time.0) as i32;
        bytes.extend(rolling.then_some(offset_ns.to_le_bytes()).into_iter().flatten());
        bytes
    });
    Wire::default()
        .message(1, &timestamp(header.time))
        .text(2, &header.lidar)
        .message(3, &pose(&Pose::identity()))
        .fixed32(4, layout.stride)
        .messages(5, layout.fields.into_iter())
        .data(6, &bytes.collect::<Vec<u8>>())
}

const UINT8: u64 = 1;
const UINT16: u64 = 3;
const INT32: u64 = 6;
const FLOAT32: u64 = 7;

/// How a point's numbers follow each other.
#[derive(Default)]
struct Layout {
    fields: Vec<Wire>,
    stride: u32,
}

impl Layout {
    fn add(&mut self, name: &str, kind: u64, bytes: u32) {
        let field = Wire::default().text(1, name).fixed32(2, self.stride).integer(3, kind);
        self.fields.push(field);
        self.stride += bytes;
    }
}

/// A camera's optics.
pub(super) fn calibration(time: Timestamp, named: &NamedCamera) -> Wire {
    let camera = &named.camera;
    let (model, distortion) = distortion(&camera.model);
    let matrix = camera.model.intrinsics().map_or([[0.0; 3]; 3], |lens| lens.matrix());
    let projection: Vec<f64> = matrix.iter().flat_map(|&[a, b, c]| [a, b, c, 0.0]).collect();
    Wire::default()
        .message(1, &timestamp(time))
        .fixed32(2, camera.width)
        .fixed32(3, camera.height)
        .text(4, model)
        .doubles(5, &distortion)
        .doubles(6, matrix.as_flattened())
        .doubles(7, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
        .doubles(8, &projection)
        .text(9, &named.name)
}

fn distortion(model: &CameraModel) -> (&'static str, Vec<f64>) {
    let coefficients = model.coefficients();
    match model {
        CameraModel::Pinhole(_) => ("", coefficients),
        CameraModel::BrownConrady(_) if coefficients.len() == 5 => ("plumb_bob", coefficients),
        CameraModel::BrownConrady(_) => ("rational_polynomial", coefficients),
        CameraModel::KannalaBrandt(_) => ("kannala_brandt", coefficients),
        CameraModel::Mei(_) => ("mei", coefficients),
        CameraModel::Ocam(ocam) => ("ocam", ocam_numbers(ocam)),
    }
}

fn ocam_numbers(ocam: &Ocam) -> Vec<f64> {
    let fixed = ocam.centre().into_iter().chain(ocam.affine()).chain([ocam.max_angle_rad()]);
    fixed.chain(ocam.polynomial().iter().copied()).collect()
}

/// A PNG of a camera.
pub(super) fn image(time: Timestamp, camera: &str, png: &[u8]) -> Wire {
    let stamped = Wire::default().message(1, &timestamp(time));
    stamped.data(2, png).text(3, "png").text(4, camera)
}

/// All boxes that stand at a time, in place of all that stood before.
pub(super) fn scene_update(time: Timestamp, boxes: &[(&BoxTrack, &Box3)]) -> Wire {
    const ALL: u64 = 1;
    let deletion = Wire::default().message(1, &timestamp(time)).integer(2, ALL);
    let entities = boxes.iter().map(|(track, boxed)| entity(time, track, boxed));
    Wire::default().message(1, &deletion).messages(2, entities)
}

fn entity(time: Timestamp, track: &BoxTrack, boxed: &Box3) -> Wire {
    const COLOUR: [f64; 4] = [1.0, 0.62, 0.0, 0.4];
    let category = Wire::default().text(1, "category").text(2, &track.category);
    let cube = Wire::default()
        .message(1, &pose(&boxed.world_from_box))
        .message(2, &vector(&boxed.size_m))
        .message(3, &numbers(&COLOUR));
    Wire::default()
        .message(1, &timestamp(time))
        .text(2, WORLD)
        .text(3, &track.source_id)
        .message(6, &category)
        .message(8, &cube)
}

fn timestamp(time: Timestamp) -> Wire {
    let (seconds, nanos) = (time.0.div_euclid(1_000_000_000), time.0.rem_euclid(1_000_000_000));
    Wire::default().integer(1, seconds as u64).integer(2, nanos as u64)
}

fn pose(pose: &Pose) -> Wire {
    let [x, y, z, w] = pose.rotation.coords.into();
    Wire::default()
        .message(1, &vector(&pose.translation.vector))
        .message(2, &numbers(&[x, y, z, w]))
}

fn vector(vector: &Vector3<f64>) -> Wire {
    numbers(vector.as_slice())
}

/// Numbers as the fields 1, 2, 3, …
fn numbers(numbers: &[f64]) -> Wire {
    numbers.iter().zip(1..).fold(Wire::default(), |wire, (&value, field)| wire.double(field, value))
}
