//! Logs as MCAP files of Foxglove's schemas, protobuf encoded.
//!
//! ```text
//!   /tf                    FrameTransform     map -> base_link at every message's time,
//!                                             base_link -> sensors once, at the drive's begin
//!   /<lidar>/points        PointCloud         x y z, ring; label if labelled; offset_ns if rolling
//!   /<camera>/calibration  CameraCalibration  with every exposure
//!   /<camera>/image        CompressedImage    PNG; /<camera>/body_mask where there is one
//!   /annotations           SceneUpdate        all boxes of a keyframe: cubes in map, the track's
//!                                             name as id, its category as metadata
//! ```
//!
//! Frames are named as their sensors. The metadata record `point_labels` names the numbers of the
//! field `label`. What the schemas have no words for goes by ours: distortion models `mei` (xi k1 k2
//! p1 p2) and `ocam` (centre u v, affine c d e, largest angle, polynomial).

mod messages;
mod recorder;
mod schemas;

use image::ExtendedColorType;
use occlabel_core::{Exposure, Fault, Taxonomy, Timestamp};

use crate::{Drive, render};

use super::files::Output;
use super::png::{mask_png, png};
use super::points::logged_points;
use super::raw_names::RawNames;
use super::written::{Images, Written};

use recorder::Recorder;

/// The frame in which the ego's poses stand.
const WORLD: &str = "map";
/// The ego's frame.
const EGO: &str = "base_link";

/// Writes a drive as one file; the taxonomy is the drive's. To be finished with the entry that is
/// returned.
///
/// # Errors
/// If the file cannot be written.
pub fn write_mcap(
    drive: &Drive,
    taxonomy: &Taxonomy,
    images: Images,
    output: &Output,
) -> Result<(Written, String), Fault> {
    let names = RawNames::new(std::slice::from_ref(drive), taxonomy)?;
    let file = format!("{}.mcap", drive.scene().name);
    let mut log = DriveLog { drive, names, images, to: Recorder::create(output.stream(&file)?)? };
    let written = log.record()?;
    log.to.finish()?;
    Ok((written, file))
}

/// A drive on its way into a file.
struct DriveLog<'a> {
    drive: &'a Drive,
    names: RawNames<'a>,
    images: Images,
    to: Recorder,
}

/// Something that happens at a time; of two at one time that goes first which stands first.
#[derive(Clone, Debug)]
enum Event {
    Sweep(usize),
    Exposure(Exposure),
    Keyframe(usize),
}

impl DriveLog<'_> {
    fn record(&mut self) -> Result<Written, Fault> {
        let scene = self.drive.scene();
        self.to.name_labels(self.names.all())?;
        let events = events(self.drive, self.images);
        let mut written = Written {
            scenes: 1,
            sweeps: scene.sweeps.len(),
            keyframes: scene.keyframes.len(),
            ..Written::default()
        };
        self.mount_sensors(events.first().map_or(Timestamp(0), |(time, _)| *time))?;
        let mut placed = None;
        for (time, event) in events {
            if placed.replace(time) != Some(time) {
                self.place_ego(time)?;
            }
            match event {
                Event::Sweep(sweep) => self.sweep(sweep, &mut written)?,
                Event::Exposure(exposure) => self.exposure(&exposure, &mut written)?,
                Event::Keyframe(keyframe) => written.boxes += self.boxes(keyframe)?,
            }
        }
        Ok(written)
    }

    fn mount_sensors(&mut self, time: Timestamp) -> Result<(), Fault> {
        let (world, poses) = (self.drive.world(), self.drive.poses());
        let lidars = world.lidars.iter().map(|lidar| &lidar.name).zip(&poses.ego_from_lidar);
        let cameras = self.drive.scene().cameras.iter().map(|camera| &camera.name);
        for (name, ego_from_sensor) in lidars.chain(cameras.zip(&poses.ego_from_camera)) {
            let message = messages::transform(time, EGO, name, ego_from_sensor);
            self.to.write("/tf", "FrameTransform", time, &message)?;
        }
        Ok(())
    }

    fn place_ego(&mut self, time: Timestamp) -> Result<(), Fault> {
        let world_from_ego = self.drive.poses().world_from_ego(self.drive.world(), time);
        let message = messages::transform(time, WORLD, EGO, &world_from_ego);
        self.to.write("/tf", "FrameTransform", time, &message)
    }

    fn sweep(&mut self, sweep: usize, written: &mut Written) -> Result<(), Fault> {
        let header = &self.drive.scene().sweeps[sweep];
        let points = logged_points(self.drive, sweep);
        let message = messages::point_cloud(header, &points, &self.names);
        written.points += points.len();
        written.labelled += usize::from(header.labelled);
        let topic = format!("/{}/points", header.lidar);
        self.to.write(&topic, "PointCloud", header.time, &message)
    }

    fn exposure(&mut self, exposure: &Exposure, written: &mut Written) -> Result<(), Fault> {
        let named = &self.drive.scene().cameras[exposure.camera];
        let (name, time) = (&named.name, exposure.time);
        let calibration = messages::calibration(time, named);
        self.to.write(&format!("/{name}/calibration"), "CameraCalibration", time, &calibration)?;
        if let Some(mask) = &named.camera.body_mask {
            let message = messages::image(time, name, &mask_png(mask));
            self.to.write(&format!("/{name}/body_mask"), "CompressedImage", time, &message)?;
        }
        if self.images == Images::None {
            return Ok(());
        }
        let picture = render(self.drive, exposure);
        let size = [picture.width, picture.height];
        let message =
            messages::image(time, name, &png(&picture.rgb, size, ExtendedColorType::Rgb8));
        written.images += 1;
        self.to.write(&format!("/{name}/image"), "CompressedImage", time, &message)
    }

    /// Gives the number of boxes.
    fn boxes(&mut self, keyframe: usize) -> Result<usize, Fault> {
        let scene = self.drive.scene();
        let time = scene.keyframes[keyframe].time;
        let standing = scene.tracks.iter().filter_map(|track| {
            let (_, boxed) = track.boxes.iter().find(|(at, _)| *at == time)?;
            Some((track, boxed))
        });
        let standing: Vec<_> = standing.collect();
        let message = messages::scene_update(time, &standing);
        self.to.write("/annotations", "SceneUpdate", time, &message)?;
        Ok(standing.len())
    }
}

/// All events of a drive in order of time.
fn events(drive: &Drive, images: Images) -> Vec<(Timestamp, Event)> {
    let scene = drive.scene();
    let sweeps = scene.sweeps.iter().map(|sweep| sweep.time).zip((0..).map(Event::Sweep));
    let keys = scene.keyframes.iter().map(|key| key.time).zip((0..).map(Event::Keyframe));
    let cameras = 0..scene.cameras.len();
    let exposures = cameras.flat_map(|camera| super::exposures::exposures(drive, camera, images));
    let exposures = exposures.map(|exposure| (exposure.time, Event::Exposure(exposure)));
    let mut events: Vec<_> = sweeps.chain(exposures).chain(keys).collect();
    events.sort_by_key(|(time, _)| *time);
    events
}
