//! A scene from its recording: the reader's conductor.

use std::path::Path;

use occlabel_core::{Fault, McapSettings, Scene, SweepHeader};

use super::cameras::cameras;
use super::container::Container;
use super::dispatch::{Decoded, decode};
use super::layout::{FrameRoles, lidar_names};
use super::options::{McapOptions, Purpose, TimeSource, purpose};
use super::recording::{CloudHead, Recording};
use super::sweep_points::sweep_points;
use super::sweeps::{source_id, sweep_headers};
use super::tracks::{annotated_times, tracks};
use crate::SweepPoints;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;

/// A file, read but for its points.
#[derive(Debug)]
pub(super) struct Loaded {
    scene: Scene,
    recording: Recording,
    roles: FrameRoles,
}

impl Loaded {
    /// Everything of a scene but its points (labels.md section 2).
    ///
    /// # Errors
    /// If its name cannot be that of a folder, the file is broken, its frames have no parts, no
    /// sweep is of the reference lidar, or a track has two boxes at a time.
    pub(super) fn read(
        root: &Path,
        name: &str,
        file: &str,
        options: &McapOptions,
    ) -> Result<Self, Fault> {
        if !is_folder_name(name) {
            let expected = "a file's name of A-Z, a-z, 0-9, `.`, `_` and `-`";
            return Err(Fault::new("scene-name", name, expected, format!("`{name}`")));
        }
        let McapOptions { read, settings, .. } = options;
        let mut notes = Notes::default();
        let recording = Recording::read(root, file, options, &mut notes)?;
        let roles = FrameRoles::find(&recording, settings)?;
        let lidars = lidar_names(&recording.clouds, settings);
        let sweeps = sweep_headers(&recording, settings, &roles, &lidars, &mut notes);
        let (cameras, exposures) = cameras(&recording, settings, &roles, &mut notes);
        let annotated = annotated_times(&recording);
        let is_annotated = |sweep: &SweepHeader| annotated.contains(&sweep.time);
        let keyframes = keyframes(&read.keyframes, name, &sweeps, is_annotated, &exposures)?;
        let tracks = tracks(&recording, (read, settings), &roles, &mut notes)?;
        let (warnings, refused) = notes.finish();
        let name = name.to_owned();
        let scene = Scene { name, sweeps, tracks, cameras, keyframes, warnings, refused };
        Ok(Self { scene, recording, roles })
    }

    /// The scene.
    pub(super) fn scene(&self) -> Scene {
        self.scene.clone()
    }

    /// How many points its clouds hold.
    pub(super) fn points(&self) -> u64 {
        self.recording.clouds.iter().map(|cloud| cloud.points).sum()
    }

    /// The points of a sweep; `None` if it is none of this file.
    ///
    /// # Errors
    /// If its message is broken, or its labels mean nothing.
    pub(super) fn read_sweep(
        &self,
        root: &Path,
        sweep: &SweepHeader,
        options: &McapOptions,
    ) -> Result<Option<SweepPoints>, Fault> {
        let is_it = |cloud: &&CloudHead| source_id(cloud.at) == sweep.source_id;
        let Some(head) = self.recording.clouds.iter().find(is_it) else { return Ok(None) };
        let mut container = Container::open(root, &self.recording.file)?;
        let message = container.message(&self.recording.contents, head.at)?;
        let record = format!("{} at {} ns", head.topic, sweep.time.0);
        let place = (self.recording.file.as_str(), record.as_str());
        match decode(&message, options.time_source == TimeSource::Log) {
            Ok(Some(Decoded::Cloud(cloud))) => {
                let world = (&self.recording, self.roles.world.as_str());
                sweep_points(&cloud, world, options, place).map(Some)
            }
            Ok(_) => Ok(None),
            Err(defect) => {
                let fault = Fault::new("mcap-message", place.0, defect.expected, defect.found);
                Err(fault.record(record).offset(head.at.block))
            }
        }
    }
}

/// The names of a file's lidars.
///
/// # Errors
/// If the file cannot be read, or holds no clouds.
pub(super) fn lidars_of(
    root: &Path,
    file: &str,
    settings: &McapSettings,
) -> Result<Vec<String>, Fault> {
    let mut container = Container::open(root, file)?;
    let (contents, _) = container.contents();
    let is_cloud = |channel: &_| purpose(settings, channel) == Some(Purpose::Sweeps);
    let mut clouds = Vec::new();
    for message in container.first_of_each(&contents, is_cloud)? {
        if let Ok(Some(Decoded::Cloud(cloud))) = decode(&message, false) {
            clouds.push(CloudHead::new(&message, cloud));
        }
    }
    if clouds.is_empty() {
        let fault = Fault::new("mcap-clouds", file, "messages of point clouds", "none");
        return Err(fault.hint("`reader.mcap.lidars` limits them to certain topics"));
    }
    Ok(lidar_names(&clouds, settings).into_values().collect())
}
