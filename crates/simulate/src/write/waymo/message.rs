//! v1's messages: field numbers are those of the format's public dataset.proto and label.proto.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use occlabel_core::Pose;

use crate::write::wire::Wire;

use super::frame::{BoxLabel, Frame, Image};
use super::range_image::{LABEL, PIXEL, POSE, RangeImage};
use super::rig::{Rig, RigLidar};
use super::rig_camera::RigCamera;

/// Numbers of a pixel that say where cameras see it: 0 for no camera.
const PROJECTION: usize = 6;

/// What all frames share.
pub(super) fn context(name: &str, rig: &Rig) -> Wire {
    Wire::default()
        .text(1, name)
        .messages(2, rig.cameras.iter().map(camera_calibration))
        .messages(3, rig.lidars.iter().map(laser_calibration))
}

/// One frame of a context.
pub(super) fn frame(context: &Wire, rig: &Rig, frame: &Frame) -> Wire {
    let images = frame.images.iter().map(|image| camera_image(&rig.cameras[image.camera], image));
    Wire::default()
        .message(1, context)
        .integer(2, (frame.time.0 / 1000) as u64)
        .message(3, &transform(&frame.world_from_ego))
        .messages(4, images)
        .messages(5, frame.lidars.iter().map(laser))
        .messages(6, frame.boxes.iter().map(label))
}

/// The 16 numbers of a pose's matrix, rows first.
pub(super) fn matrix_numbers(pose: &Pose) -> Vec<f64> {
    pose.to_homogeneous().transpose().as_slice().to_vec()
}

/// When a camera is triggered, and when it is read out, seconds: its pose is that of the middle.
pub(super) fn shutter_times(camera: &RigCamera, image: &Image) -> [f64; 2] {
    let half_s = camera.shutter.1 / 2.0;
    [image.time_s - half_s, image.time_s + half_s]
}

fn transform(pose: &Pose) -> Wire {
    Wire::default().doubles(1, &matrix_numbers(pose))
}

fn camera_calibration(camera: &RigCamera) -> Wire {
    Wire::default()
        .integer(1, camera.number)
        .doubles(2, &camera.intrinsic)
        .message(3, &transform(&camera.ego_from_format))
        .integer(4, camera.size[0].into())
        .integer(5, camera.size[1].into())
        .integer(6, camera.shutter.0)
}

fn laser_calibration(lidar: &RigLidar) -> Wire {
    let [min_rad, max_rad] = lidar.span_rad();
    Wire::default()
        .integer(1, lidar.number)
        .doubles(2, &lidar.inclinations_rad)
        .double(3, min_rad)
        .double(4, max_rad)
        .message(5, &transform(&lidar.ego_from_format))
}

fn camera_image(camera: &RigCamera, image: &Image) -> Wire {
    let [trigger_s, done_s] = shutter_times(camera, image);
    Wire::default()
        .integer(1, camera.number)
        .message(3, &transform(&image.world_from_ego))
        .double(5, image.time_s)
        .double(6, 0.0)
        .double(7, trigger_s)
        .double(8, done_s)
}

fn laser(image: &RangeImage) -> Wire {
    let first = range_image(image, &image.pixels, image.poses.as_deref(), image.labels.as_deref());
    let no_labels = image.labels.as_ref().map(|labels| vec![0; labels.len()]);
    let second = range_image(image, &image.second_pixels(), None, no_labels.as_deref());
    Wire::default().integer(1, image.lidar).message(2, &first).message(3, &second)
}

fn range_image(
    image: &RangeImage,
    pixels: &[f32],
    poses: Option<&[f32]>,
    labels: Option<&[i32]>,
) -> Wire {
    let floats = |values: &[f32], depth| matrix(Wire::default().floats(1, values), image, depth);
    let integers =
        |values: &[i32], depth| matrix(Wire::default().integers(1, values), image, depth);
    let unseen = vec![0; pixels.len() / PIXEL * PROJECTION];
    let seen =
        Wire::default().data(2, &floats(pixels, PIXEL)).data(3, &integers(&unseen, PROJECTION));
    let placed = poses.map_or(seen.clone(), |poses| seen.data(4, &floats(poses, POSE)));
    labels.map_or(placed.clone(), |labels| placed.data(6, &integers(labels, LABEL)))
}

/// Packed values with their shape, behind zlib.
fn matrix(values: Wire, image: &RangeImage, depth: usize) -> Vec<u8> {
    let [rows, columns] = image.size;
    let shape = Wire::default().integers(1, &[rows, columns, depth].map(|side| side as i32));
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder
        .write_all(values.message(2, &shape).bytes())
        .and_then(|()| encoder.finish())
        .expect("memory takes what is written")
}

fn label(label: &BoxLabel) -> Wire {
    let (center_m, size_m) = (&label.center_m, &label.size_m);
    let [length_m, width_m, height_m] = [size_m.x, size_m.y, size_m.z];
    let numbers =
        [center_m.x, center_m.y, center_m.z, width_m, length_m, height_m, label.heading_rad];
    let upright = numbers
        .iter()
        .zip(1..)
        .fold(Wire::default(), |wire, (&number, field)| wire.double(field, number));
    Wire::default().message(1, &upright).integer(3, label.kind).text(4, label.track)
}
