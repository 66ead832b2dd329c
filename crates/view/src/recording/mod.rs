//! A scene as an MCAP file of Foxglove's schemas, on one time line.
//!
//! ```text
//!   /tf                    FrameTransform     map -> grid at each keyframe; map -> base_link, base_link
//!                                             -> lidar at each sweep; map -> camera at each exposure
//!   /occupancy/grid        VoxelGrid          label, red, green, blue, alpha: 0 where nothing stands
//!   /occupancy/voxels      PointCloud         the occupied centres: class, colour, track, hits, crossings
//!   /annotations           SceneUpdate        all boxes of a keyframe in map, the track's name as id
//!   /<lidar>/points        PointCloud         label and colour too if labelled
//!   /<camera>/calibration  CameraCalibration
//!   /<camera>/image        CompressedImage
//! ```
//!
//! The metadata records `classes` and `class_colors` name what the numbers mean, `point_labels` those of
//! the sweeps. No message depends on the machine's clock or on the versions of crates: same input, same
//! bytes.

mod boxes;
mod cameras;
mod clouds;
mod common;
mod grids;
mod recorder;

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use occlabel_core::{
    Fault, NamedCamera, Palette, PointCloud, PointLabel, Pose, SweepHeader, Timestamp,
};

use crate::{ShownKeyframe, ShownScene};

pub use boxes::ShownBox;
use recorder::Recorder;

/// The frame of the log's poses.
pub const WORLD: &str = "map";
/// The ego's frame.
pub const EGO: &str = "base_link";
/// The frame of the grids.
pub const GRID: &str = "grid";

/// A file on its way; messages are to come in order of time.
pub struct Recording<W: Write + Seek> {
    recorder: Recorder<W>,
    /// When each frame was placed last.
    placed: BTreeMap<String, Timestamp>,
}

impl<W: Write + Seek> Recording<W> {
    /// Begins a file, which faults call `place`, with what the numbers of the classes mean.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn begin(to: W, place: &str, scene: &ShownScene) -> Result<Self, Fault> {
        let mut recorder = Recorder::begin(to, place)?;
        let named = |id: u8| Some((id.to_string(), scene.palette.name(id)?.to_owned()));
        let free = (scene.free.to_string(), "free".to_owned());
        recorder.metadata("classes", (0..scene.free).filter_map(named).chain([free]))?;
        let color = |id: u8| (id.to_string(), hex(scene.palette.color(id)));
        recorder.metadata("class_colors", (0..scene.free).map(color))?;
        let labels = [("scene", &scene.name), ("grid_frame", &scene.frame)];
        let texts = labels.map(|(key, value)| (key.to_owned(), value.clone()));
        recorder.metadata("labels", texts.into_iter())?;
        Ok(Self { recorder, placed: BTreeMap::new() })
    }

    /// Names the labels of the sweeps' points, in the order of their numbers.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn name_point_labels(&mut self, names: &[String]) -> Result<(), Fault> {
        let numbered = names.iter().enumerate().map(|(id, name)| (id.to_string(), name.clone()));
        self.recorder.metadata("point_labels", numbered)
    }

    /// Places a frame, if it was not placed at this time before.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn place(
        &mut self,
        time: Timestamp,
        parent: &str,
        child: &str,
        parent_from_child: &Pose,
    ) -> Result<(), Fault> {
        if self.placed.insert(child.to_owned(), time) == Some(time) {
            return Ok(());
        }
        let message = common::transform(time, parent, child, parent_from_child);
        self.recorder.write("/tf", time, &message)
    }

    /// Adds the labels of a keyframe, as a grid and as the centres of the occupied voxels.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn keyframe(
        &mut self,
        time: Timestamp,
        keyframe: &ShownKeyframe,
        scene: &ShownScene,
    ) -> Result<(), Fault> {
        self.recorder.write("/occupancy/grid", time, &grids::grid(time, keyframe, scene))?;
        let voxels = clouds::voxels(time, keyframe, scene);
        self.recorder.write("/occupancy/voxels", time, &voxels)
    }

    /// Adds all boxes that stand at a time, in place of all that stood before.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn boxes(&mut self, time: Timestamp, boxes: &[ShownBox]) -> Result<(), Fault> {
        self.recorder.write("/annotations", time, &boxes::boxes(time, boxes))
    }

    /// Adds a sweep's points, in the frame of its lidar; the palette is that of their classes.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn sweep(
        &mut self,
        header: &SweepHeader,
        cloud: &PointCloud<PointLabel>,
        palette: &Palette,
    ) -> Result<(), Fault> {
        let topic = format!("/{}/points", header.lidar);
        self.recorder.write(&topic, header.time, &clouds::sweep(header, cloud, palette))
    }

    /// Adds a camera's optics.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn camera(&mut self, time: Timestamp, camera: &NamedCamera) -> Result<(), Fault> {
        let topic = format!("/{}/calibration", camera.name);
        self.recorder.write(&topic, time, &cameras::calibration(time, camera))
    }

    /// Adds an image, JPEG or PNG, of a camera.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn image(&mut self, time: Timestamp, camera: &str, bytes: Vec<u8>) -> Result<(), Fault> {
        let topic = format!("/{camera}/image");
        self.recorder.write(&topic, time, &cameras::image(time, camera, bytes))
    }

    /// Ends the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self) -> Result<(), Fault> {
        self.recorder.finish()
    }
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
