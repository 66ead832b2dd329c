//! A scene from its recording: the reader's conductor.

use std::path::Path;
use std::sync::OnceLock;

use occlabel_core::{Fault, Scene, SweepHeader, Timestamp};

use super::cameras::cameras;
use super::container::Container;
use super::dispatch::{Decoded, decode};
use super::layout::{FrameRoles, lidar_names};
use super::options::{McapOptions, TimeSource};
use super::pictures::Pictures;
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
    pictures: OnceLock<Result<Pictures, Fault>>,
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
        let roles = FrameRoles::find(&recording, settings).map_err(|fault| match fault.rule {
            "mcap-clouds" => notes.explain(fault),
            _ => fault,
        })?;
        let lidars = lidar_names(&recording.clouds, settings);
        let sweeps = sweep_headers(&recording, settings, &roles, &lidars, &mut notes);
        let (cameras, exposures) = cameras(&recording, settings, &roles, &mut notes);
        let annotated = annotated_times(&recording);
        let is_annotated = |sweep: &SweepHeader| annotated.contains(&sweep.time);
        let keyframes =
            keyframes(&read.keyframes, name, &sweeps, is_annotated, &exposures, &notes)?;
        let tracks = tracks(&recording, (read, settings), &roles, &mut notes)?;
        let (warnings, refused) = notes.finish();
        let name = name.to_owned();
        let scene =
            Scene { name, sweeps, tracks, cameras, keyframes, exposures, warnings, refused };
        Ok(Self { scene, recording, roles, pictures: OnceLock::new() })
    }

    /// The scene.
    pub(super) fn scene(&self) -> Scene {
        self.scene.clone()
    }

    /// How many points its clouds hold.
    pub(super) fn points(&self) -> u64 {
        self.recording.clouds.iter().map(|cloud| cloud.points).sum()
    }

    /// The bytes of the image that a camera took at a time; `None` if there is none.
    ///
    /// # Errors
    /// If the file, or the image's message, is broken.
    pub(super) fn read_image(
        &self,
        root: &Path,
        camera: &str,
        time: Timestamp,
        options: &McapOptions,
    ) -> Result<Option<Vec<u8>>, Fault> {
        let find = || Pictures::find(root, &self.recording, options);
        let pictures = self.pictures.get_or_init(find).as_ref().map_err(Clone::clone)?;
        pictures.read((root, &self.recording, options), camera, time)
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
        let limit = options.settings.max_record_bytes;
        let mut container = Container::open(root, &self.recording.file, limit)?;
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
