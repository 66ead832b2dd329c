//! The frames of a drive: all lidars' sweeps of one time, with the boxes and images that go with it.

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Pose, SweepHeader, Timestamp};

use crate::Drive;
use crate::schedule::{exposure_times, nearest_exposures};
use crate::write::written::Written;

use super::align::yaw_rad;
use super::ids::box_type;
use super::range_image::RangeImage;
use super::rig::Rig;

/// All that the log holds of one time.
pub(super) struct Frame<'a> {
    pub(super) time: Timestamp,
    pub(super) world_from_ego: Pose,
    pub(super) images: Vec<Image>,
    pub(super) lidars: Vec<RangeImage>,
    pub(super) boxes: Vec<BoxLabel<'a>>,
}

/// What a camera saw, without the picture.
pub(super) struct Image {
    /// The camera's place in the rig.
    pub(super) camera: usize,
    pub(super) time_s: f64,
    /// There the vehicle stood at that time.
    pub(super) world_from_ego: Pose,
}

/// An upright box in the vehicle's frame.
pub(super) struct BoxLabel<'a> {
    pub(super) track: &'a str,
    pub(super) kind: u64,
    pub(super) center_m: Vector3<f64>,
    /// Length, width, height.
    pub(super) size_m: Vector3<f64>,
    pub(super) heading_rad: f64,
}

/// The frames of a drive in order of time, one whenever a lidar's sweep begins.
pub(super) fn frames<'a>(drive: &'a Drive, rig: &'a Rig) -> impl Iterator<Item = Frame<'a>> {
    let times = exposure_times(drive.world());
    let sweeps = &drive.scene().sweeps;
    let mut first = 0;
    sweeps.chunk_by(|a, b| a.time == b.time).map(move |of_frame| {
        let numbers = first..first + of_frame.len();
        first = numbers.end;
        let SweepHeader { time, world_from_ego, .. } = of_frame[0];
        let exposures = nearest_exposures(&times, time);
        let images = exposures.map(|(camera, time)| image(drive, camera, time));
        let lidar = |sweep: usize| {
            let number = drive.world().lidar_number(&sweeps[sweep].lidar);
            RangeImage::of(drive, sweep, &rig.lidars[number])
        };
        Frame {
            time,
            world_from_ego,
            images: images.collect(),
            lidars: numbers.map(lidar).collect(),
            boxes: boxes(drive, time, &world_from_ego),
        }
    })
}

impl Frame<'_> {
    /// What of it counts.
    pub(super) fn counts(&self) -> Written {
        Written {
            sweeps: self.lidars.len(),
            labelled: self.lidars.iter().filter(|lidar| lidar.labels.is_some()).count(),
            points: self.lidars.iter().map(|lidar| lidar.points).sum(),
            boxes: self.boxes.len(),
            ..Written::default()
        }
    }
}

fn image(drive: &Drive, camera: usize, time: Timestamp) -> Image {
    let world_from_ego = drive.poses().world_from_ego(drive.world(), time);
    Image { camera, time_s: time.seconds_since(Timestamp(0)), world_from_ego }
}

/// The boxes that stand at a time, of movers that the format boxes.
fn boxes<'a>(drive: &'a Drive, time: Timestamp, world_from_ego: &Pose) -> Vec<BoxLabel<'a>> {
    let labelled = |track: &'a BoxTrack| {
        let (_, boxed) = track.boxes.iter().find(|(at, _)| *at == time)?;
        Some(box_label(&track.source_id, box_type(&track.category)?, boxed, world_from_ego))
    };
    drive.scene().tracks.iter().filter_map(labelled).collect()
}

/// A box's tilt against the vehicle is lost: the format has none.
fn box_label<'a>(track: &'a str, kind: u64, boxed: &Box3, world_from_ego: &Pose) -> BoxLabel<'a> {
    let ego_from_box = world_from_ego.inverse() * boxed.world_from_box;
    BoxLabel {
        track,
        kind,
        center_m: ego_from_box.translation.vector,
        size_m: boxed.size_m,
        heading_rad: yaw_rad(&ego_from_box.rotation),
    }
}
