//! Logs in the layout of CODa: one lidar that triggers two cameras, terrain, boxes.
//!
//! ```text
//!   3d_comp/os1/<scene>/3d_comp_os1_<scene>_0.bin           f32 x, y, z, intensity; 3d_raw if not deskewed
//!   3d_semantic/os1/<scene>/3d_semantic_os1_<scene>_0.bin   u8 of labelled sweeps: terrain alone
//!   3d_bbox/os1/<scene>/3d_bbox_os1_<scene>_0.json          boxes of keyframes, in the lidar's frame
//!   2d_raw/cam0/<scene>/2d_raw_cam0_<scene>_0.png           taken as the sweep begins; masks/cam0/… classes
//!   poses/dense/<scene>.txt                                 the lidar in world, a line a frame
//!   timestamps/<scene>.txt                                  seconds of the drive, a line a frame
//!   calibrations/<scene>/calib_*.yaml                       lenses, and camera <- lidar
//! ```
//!
//! The format has two cameras of Brown's lens. The world's first two with such a lens, or with none, are
//! these, and are exposed when the lidar triggers them, whatever their own clocks say.

mod boxes;
mod calibrations;
mod ids;

use std::collections::BTreeMap;

use image::ExtendedColorType;
use occlabel_core::camera::CameraModel;
use occlabel_core::{Exposure, Fault, Keyframe, Pose, SweepHeader, Timestamp};

use super::files::Output;
use super::png::png;
use super::points::{LoggedPoint, logged_points, reference_sweeps};
use super::written::{Images, Written};
use crate::schedule::exposure;
use crate::{Drive, render};

/// The lidar's name.
const LIDAR: &str = "os1";
/// The format has so many cameras that the lidar triggers.
const CAMERAS: usize = 2;
/// The intensity of every return: materials have none here.
const INTENSITY: f32 = 0.5;

/// Writes the sweeps of a drive's reference lidar, and what its cameras see at them. To be finished with
/// the entry that is returned.
///
/// # Errors
/// If the drive has no keyframe, or a file cannot be written.
pub fn write_coda(
    drive: &Drive,
    images: Images,
    output: &Output,
) -> Result<(Written, &'static str), Fault> {
    let sweeps = reference_sweeps(drive)?;
    let keyframes: BTreeMap<usize, &Keyframe> =
        drive.scene().keyframes.iter().map(|keyframe| (keyframe.sweep, keyframe)).collect();
    let points = if drive.taken_by(sweeps[0]).0.deskew { "3d_comp" } else { "3d_raw" };
    let cameras = cameras(drive);
    let mut written = Written { scenes: 1, keyframes: keyframes.len(), ..Written::default() };
    for (number, &sweep) in sweeps.iter().enumerate() {
        let frame = Frame { drive, number, header: &drive.scene().sweeps[sweep] };
        let keyframe = keyframes.get(&sweep).copied();
        written += frame.write_points(points, sweep, output)?;
        written += frame.write_boxes(keyframe, output)?;
        if images == Images::All || (images == Images::Keyframes && keyframe.is_some()) {
            written += frame.write_images(&cameras, output)?;
        }
    }
    let headers: Vec<_> = sweeps.iter().map(|&sweep| &drive.scene().sweeps[sweep]).collect();
    write_texts(drive, &headers, output)?;
    calibrations::write(drive, &cameras, headers[0], output)?;
    Ok((written, points))
}

/// The world's cameras that the format has words for, by their numbers there.
fn cameras(drive: &Drive) -> Vec<usize> {
    let model = |camera: &usize| &drive.scene().cameras[*camera].camera.model;
    let is_brown = |camera: &usize| {
        matches!(model(camera), CameraModel::Pinhole(_) | CameraModel::BrownConrady(_))
    };
    (0..drive.scene().cameras.len()).filter(is_brown).take(CAMERAS).collect()
}

/// A sweep of the log, and what else is of its frame.
struct Frame<'a> {
    drive: &'a Drive,
    number: usize,
    header: &'a SweepHeader,
}

impl Frame<'_> {
    fn write_points(&self, kind: &str, sweep: usize, output: &Output) -> Result<Written, Fault> {
        let points = logged_points(self.drive, sweep);
        output.write(&self.file(kind, LIDAR, "bin"), &cloud_bytes(&points))?;
        if self.header.labelled {
            let labels: Vec<u8> = points.iter().map(|point| ids::terrain(point.label)).collect();
            output.write(&self.file("3d_semantic", LIDAR, "bin"), &labels)?;
        }
        let labelled = usize::from(self.header.labelled);
        Ok(Written { sweeps: 1, points: points.len(), labelled, ..Written::default() })
    }

    /// The boxes, if it is a keyframe's.
    fn write_boxes(&self, keyframe: Option<&Keyframe>, output: &Output) -> Result<Written, Fault> {
        let Some(keyframe) = keyframe else { return Ok(Written::default()) };
        let (text, boxes) = boxes::text(self.drive, keyframe.time, self.header);
        output.write(&self.file("3d_bbox", LIDAR, "json"), text.as_bytes())?;
        Ok(Written { boxes, ..Written::default() })
    }

    /// What the cameras see, and beside it what class each pixel is of.
    fn write_images(&self, cameras: &[usize], output: &Output) -> Result<Written, Fault> {
        for (number, &camera) in cameras.iter().enumerate() {
            let image = render(self.drive, &self.exposure(camera));
            let size = [image.width, image.height];
            let file = self.file("2d_raw", &format!("cam{number}"), "png");
            let below = file.split_once('/').map_or(&file[..], |(_, below)| below);
            output.write(&file, &png(&image.rgb, size, ExtendedColorType::Rgb8))?;
            let classes = png(&image.classes, size, ExtendedColorType::L8);
            output.write(&format!("masks/{below}"), &classes)?;
        }
        Ok(Written { images: cameras.len(), ..Written::default() })
    }

    fn exposure(&self, camera: usize) -> Exposure {
        exposure(self.drive.world(), self.drive.poses(), camera, self.header.time)
    }

    fn file(&self, kind: &str, sensor: &str, ending: &str) -> String {
        let (scene, number) = (&self.drive.scene().name, self.number);
        format!("{kind}/{sensor}/{scene}/{kind}_{sensor}_{scene}_{number}.{ending}")
    }
}

fn cloud_bytes(points: &[LoggedPoint]) -> Vec<u8> {
    let columns = points.iter().flat_map(|point| {
        let [x, y, z] = point.position_m.into();
        [x, y, z, INTENSITY]
    });
    columns.flat_map(f32::to_le_bytes).collect()
}

fn write_texts(drive: &Drive, sweeps: &[&SweepHeader], output: &Output) -> Result<(), Fault> {
    let time = |sweep: &&SweepHeader| seconds(sweep.time) + "\n";
    let pose = |sweep: &&SweepHeader| {
        format!("{} {}\n", seconds(sweep.time), pose_text(&sweep.world_from_lidar()))
    };
    let scene = &drive.scene().name;
    let times: String = sweeps.iter().map(time).collect();
    let poses: String = sweeps.iter().map(pose).collect();
    output.write(&format!("timestamps/{scene}.txt"), times.as_bytes())?;
    output.write(&format!("poses/dense/{scene}.txt"), poses.as_bytes())
}

/// Seconds with all digits of nanoseconds.
fn seconds(time: Timestamp) -> String {
    format!("{}.{:09}", time.0 / 1_000_000_000, time.0 % 1_000_000_000)
}

/// Place and quaternion, w first, with all their digits.
fn pose_text(pose: &Pose) -> String {
    let (place, turn) = (pose.translation.vector, pose.rotation);
    let numbers = [place.x, place.y, place.z, turn.w, turn.i, turn.j, turn.k];
    numbers.map(|number| format!("{number:e}")).join(" ")
}
