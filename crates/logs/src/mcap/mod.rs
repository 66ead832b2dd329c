//! Logs as MCAP files, one scene each.
//!
//! No topic's name is assumed: messages are told apart by encoding and schema, frames by the tree
//! that transforms span. Encodings turn messages into the values of `messages`; from there on,
//! nothing knows which it was. docs/mcap.md names every schema and field that is read.

mod cameras;
mod chunk;
mod classes;
#[cfg(test)]
mod conformance;
mod container;
mod contents;
mod dispatch;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
#[cfg(test)]
mod encoding_tests;
mod frames;
mod json;
mod layout;
mod messages;
mod options;
mod pictures;
mod points;
mod protobuf;
mod record;
mod record_file;
mod recording;
#[cfg(test)]
mod refusal_tests;
mod resolve;
mod ros;
#[cfg(test)]
mod ros_tests;
#[cfg(any(test, fuzzing))]
mod ros_writer;
#[cfg(any(test, fuzzing))]
pub(crate) mod samples;
mod scene;
mod survey;
mod sweep_points;
mod sweeps;
mod tracks;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use occlabel_core::{Exposure, Fault, McapSettings, Scene, SweepHeader, reference_lidar};
use occlabel_disk as disk;

use crate::files::unreadable;
use crate::names::{nearest_names, quoted};
use crate::{ReaderDefaults, SceneSource, SweepPoints};

use layout::FrameRoles;
pub use options::{McapOptions, TimeSource};
use resolve::{Told, resolve};
use scene::Loaded;

/// A folder of MCAP files.
#[derive(Debug)]
pub struct McapLog {
    root: PathBuf,
    options: McapOptions,
    scenes: Vec<SceneFile>,
    defaults: ReaderDefaults,
}

/// A scene, read when it is first asked for.
#[derive(Debug)]
struct SceneFile {
    name: String,
    file: String,
    loaded: OnceLock<Result<Loaded, Fault>>,
}

/// How a scene's file ends.
const ENDING: &str = ".mcap";

impl McapLog {
    /// Opens a folder: finds its files.
    ///
    /// # Errors
    /// If it holds none, a wanted scene is not there, or no file tells its lidars.
    pub fn open(root: &Path, options: McapOptions) -> Result<Self, Fault> {
        let wanted = options.read.scenes.as_ref();
        let (defaults, settings) = Self::resolve(root, wanted, &options.settings)?;
        let scene = |file: String| {
            let name = file.strip_suffix(ENDING).unwrap_or(&file).to_owned();
            SceneFile { name, file, loaded: OnceLock::new() }
        };
        let scenes = wanted_files(root, wanted)?.into_iter().map(scene).collect();
        let options = McapOptions { settings, ..options };
        Ok(Self { root: root.to_owned(), options, scenes, defaults })
    }

    /// What the log itself says where the configuration says `"auto"`, and the settings with that in
    /// them: known before the log is opened, at the price of one pass over one file of the wanted
    /// scenes (`None`: all). It holds for all of them. An `"auto"` is left only if no file tells.
    ///
    /// # Errors
    /// If there is no file, a wanted scene is not there, or none can be read.
    pub fn resolve(
        root: &Path,
        wanted: Option<&BTreeSet<String>>,
        settings: &McapSettings,
    ) -> Result<(ReaderDefaults, McapSettings), Fault> {
        let (mut first, mut fault) = (None, None);
        for file in wanted_files(root, wanted)? {
            match resolve(root, &file, settings) {
                Ok(Told { lidars, roles: Some(roles) }) => {
                    let FrameRoles { world: world_frame, ego: ego_frame } = roles;
                    let settings = McapSettings { world_frame, ego_frame, ..settings.clone() };
                    return Ok((defaults(&lidars), settings));
                }
                Ok(told) => drop(first.get_or_insert(told)),
                Err(found) => drop(fault.get_or_insert(found)),
            }
        }
        let first = first.ok_or_else(|| fault.unwrap_or_else(|| no_files(root)))?;
        Ok((defaults(&first.lidars), settings.clone()))
    }

    fn loaded<'a>(&self, scene: &'a SceneFile) -> &'a Result<Loaded, Fault> {
        scene
            .loaded
            .get_or_init(|| Loaded::read(&self.root, &scene.name, &scene.file, &self.options))
    }
}

impl SceneSource for McapLog {
    fn scene_names(&self) -> Vec<String> {
        self.scenes.iter().map(|scene| scene.name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        Vec::new()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        vec![sweep.file.clone()]
    }

    fn describe(&self, scene: &str) -> Result<Vec<String>, Fault> {
        match self.scenes.iter().find(|known| known.name == scene) {
            Some(known) => survey::survey(&self.root, &known.file, &self.options),
            None => Ok(Vec::new()),
        }
    }

    fn read_image(&self, scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        let known = self.scenes.iter().find(|known| known.name == scene.name);
        let (Some(known), Some(camera)) = (known, scene.cameras.get(exposure.camera)) else {
            return Ok(None);
        };
        let loaded = self.loaded(known).as_ref().map_err(Clone::clone)?;
        loaded.read_image(&self.root, &camera.name, exposure.time, &self.options)
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        match self.scenes.iter().find(|known| known.name == scene) {
            Some(known) => self.loaded(known).as_ref().map_err(Clone::clone).map(Loaded::scene),
            None => Err(Fault::new("scene-unknown", scene, "a scene of this log", "none")),
        }
    }

    fn scene_points(&self, scene: &Scene) -> u64 {
        let known = self.scenes.iter().find(|known| known.name == scene.name);
        let loaded = known.and_then(|known| self.loaded(known).as_ref().ok());
        loaded.map_or(0, Loaded::points)
    }

    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let known = self.scenes.iter().find(|scene| scene.file == sweep.file);
        let unknown = || {
            let fault = Fault::new("sweep-unknown", &sweep.file, "a sweep of this log", "another");
            fault.record(&sweep.source_id)
        };
        let loaded = self.loaded(known.ok_or_else(unknown)?).as_ref().map_err(Clone::clone)?;
        loaded.read_sweep(&self.root, sweep, &self.options)?.ok_or_else(unknown)
    }

    fn defaults(&self) -> ReaderDefaults {
        self.defaults.clone()
    }
}

fn defaults(lidars: &[String]) -> ReaderDefaults {
    ReaderDefaults {
        ego_box_m: None,
        taxonomy: "occ3d-nuscenes",
        reference_lidar: reference_lidar(lidars).cloned().unwrap_or_else(|| "LIDAR_TOP".into()),
    }
}

/// Whether a folder holds any file.
pub(crate) fn has_files(root: &Path) -> bool {
    mcap_files(root).is_ok()
}

/// The folder's files, in byte order of their names.
fn mcap_files(root: &Path) -> Result<Vec<String>, Fault> {
    let place = root.display().to_string();
    let mut files = Vec::new();
    for entry in disk::list(root).map_err(|error| unreadable(&place, &error))? {
        let name = entry.file_name().into_string().ok();
        let is_file = |name: &String| name.ends_with(ENDING) && disk::is_file(&entry.path());
        files.extend(name.filter(is_file));
    }
    files.sort_unstable();
    if files.is_empty() { Err(no_files(root)) } else { Ok(files) }
}

fn no_files(root: &Path) -> Fault {
    let fault = Fault::new("mcap-files", root.display().to_string(), "files *.mcap", "none");
    fault.hint("name the folder that holds the files")
}

/// The files of the wanted scenes.
fn wanted_files(root: &Path, wanted: Option<&BTreeSet<String>>) -> Result<Vec<String>, Fault> {
    let mut files = mcap_files(root)?;
    let Some(wanted) = wanted else { return Ok(files) };
    check_wanted(wanted, &files)?;
    files.retain(|file| file.strip_suffix(ENDING).is_some_and(|name| wanted.contains(name)));
    Ok(files)
}

/// Whether every scene that is asked for by name is there.
fn check_wanted(wanted: &BTreeSet<String>, files: &[String]) -> Result<(), Fault> {
    let names: Vec<&str> = files.iter().filter_map(|file| file.strip_suffix(ENDING)).collect();
    let absent = |wanted: &&String| !names.contains(&wanted.as_str());
    let Some(name) = wanted.iter().find(absent) else { return Ok(()) };
    let fault = Fault::new("scene-unknown", "files", format!("a file `{name}{ENDING}`"), "none");
    let near = quoted(&nearest_names(name, &names));
    Err(if near.is_empty() { fault } else { fault.hint(format!("there is {near}")) })
}
