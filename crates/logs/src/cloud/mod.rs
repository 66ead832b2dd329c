//! Clouds that were reconstructed, from images alone or otherwise: points of no time, which no lidar
//! measured.
//!
//! A scene has one cloud of what stands still, one of each thing that moves in the coordinates of its box,
//! and the poses and cameras of a drive. docs/cloud.md names every file, property and field that is read.
//! Files of points are read by hand, a record at a time: a cloud may be larger than what fits, and nothing
//! that a header says is believed.

mod cameras;
mod classes;
mod columns;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
mod folders;
mod json;
mod las;
#[cfg(feature = "laz")]
mod laz;
mod lzf;
mod pcd;
mod ply;
mod point_file;
mod points;
mod poses;
mod scene;
mod surfels;
mod text;
mod tracks;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use nalgebra::Point3;
use occlabel_core::{
    CloudSettings, Exposure, Fault, PointCloud, PointLabel, PointsOf, Scene, SweepHeader, TrackId,
};
use occlabel_disk as disk;

use crate::image_files::read_image_file;
use crate::names::{nearest_names, quoted};
use crate::{ReadOptions, ReaderDefaults, SceneSource, SweepPoints, UnknownLabels};

use folders::{Folder, scenes};
use points::{FilePoints, PointRules, count_points};
use scene::Loaded;
use surfels::SurfelRules;

/// What poses are called among the lidars, the first in byte order: keyframes refer to it.
const POSES: &str = "poses";
/// What clouds of tracks are called.
const OBJECTS: &str = "tracks";
/// What the cloud of what stands still is called.
const WORLD: &str = "world";

/// Files of a scene that are no points.
const TABLES: [&str; 4] = ["cameras.json", "classes.json", "poses.txt", "tracks.json"];

/// Whether a folder is a scene, or holds any.
pub(crate) fn has_clouds(root: &Path) -> bool {
    scenes(root).is_ok()
}

/// What to read of clouds, and how.
#[derive(Clone, Debug)]
pub struct CloudOptions {
    /// What every reader is asked for.
    pub read: ReadOptions,
    /// What the properties of surfels mean.
    pub settings: CloudSettings,
    /// A surfel becomes points so far apart, metres; `None`: its centre.
    pub surfel_spacing_m: Option<f64>,
}

/// A folder of scenes with clouds.
#[derive(Debug)]
pub struct CloudLog {
    root: PathBuf,
    options: ReadOptions,
    surfels: SurfelRules,
    scenes: Vec<SceneFolder>,
}

/// A scene, read when it is first asked for.
#[derive(Debug)]
struct SceneFolder {
    folder: Folder,
    loaded: OnceLock<Result<Loaded, Fault>>,
    /// Points of tracks that stand in the world's file.
    objects: OnceLock<Result<BTreeMap<TrackId, PointCloud<PointLabel>>, Fault>>,
}

impl CloudLog {
    /// Opens a log: finds its scenes.
    ///
    /// # Errors
    /// If there is none, or a wanted scene is not there.
    pub fn open(root: &Path, options: CloudOptions) -> Result<Self, Fault> {
        let CloudOptions { read, settings, surfel_spacing_m } = options;
        let mut folders = scenes(root)?;
        check_wanted(&read, &folders)?;
        folders.retain(|folder| read.wants(&folder.name));
        let scene =
            |folder| SceneFolder { folder, loaded: OnceLock::new(), objects: OnceLock::new() };
        let surfels = SurfelRules { settings, spacing_m: surfel_spacing_m };
        let scenes = folders.into_iter().map(scene).collect();
        Ok(Self { root: root.to_owned(), options: read, surfels, scenes })
    }

    /// What the format itself says where the configuration says `"auto"`. It knows nothing of the
    /// vehicle's body, whose points no reconstruction has.
    pub fn format_defaults() -> ReaderDefaults {
        ReaderDefaults { ego_box_m: None, taxonomy: "occupancy", reference_lidar: POSES.to_owned() }
    }

    fn loaded<'a>(&self, scene: &'a SceneFolder) -> Result<&'a Loaded, Fault> {
        let read = || Loaded::read(&self.root, &self.options, &scene.folder);
        scene.loaded.get_or_init(read).as_ref().map_err(Clone::clone)
    }

    /// The scene that a sweep is of.
    fn scene_of(&self, sweep: &SweepHeader) -> Result<&SceneFolder, Fault> {
        let is_it = |scene: &&SceneFolder| {
            let rest = sweep.source_id.strip_prefix(scene.folder.name.as_str());
            rest.is_some_and(|rest| rest.starts_with('/'))
        };
        self.scenes.iter().find(is_it).ok_or_else(|| unknown_scene(&sweep.source_id))
    }

    fn read_file(&self, scene: &SceneFolder, file: &str) -> Result<FilePoints, Fault> {
        let Loaded { classes, tracks, .. } = self.loaded(scene)?;
        let rules = PointRules { options: &self.options, surfels: &self.surfels, classes, tracks };
        FilePoints::read(&self.root, file, &rules)
    }

    /// The points of a track: all of its own file, or those that the world's file says are its.
    fn read_track(&self, sweep: &SweepHeader, track: TrackId) -> Result<SweepPoints, Fault> {
        let scene = self.scene_of(sweep)?;
        if sweep.file != scene.folder.cloud(&self.root)? {
            return self.read_file(scene, &sweep.file).map(FilePoints::background);
        }
        let read = || self.read_file(scene, &sweep.file).map(|points| points.of_tracks);
        let objects = scene.objects.get_or_init(read).as_ref().map_err(Clone::clone)?;
        Ok(plain(objects.get(&track).cloned().unwrap_or_else(no_points)))
    }
}

impl SceneSource for CloudLog {
    fn scene_names(&self) -> Vec<String> {
        self.scenes.iter().map(|scene| scene.folder.name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        let tables = (self.scenes.iter())
            .flat_map(|scene| TABLES.iter().map(|table| scene.folder.file(table)));
        tables.filter(|table| disk::is_file(&self.root.join(table))).collect()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        match sweep.points_of {
            PointsOf::Nothing => Vec::new(),
            _ => vec![sweep.file.clone()],
        }
    }

    fn read_image(&self, _scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        exposure.image.as_ref().map_or(Ok(None), |file| read_image_file(&self.root, file))
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        let known = self.scenes.iter().find(|known| known.folder.name == scene);
        let known = known.ok_or_else(|| unknown_scene(scene))?;
        Ok(self.loaded(known)?.scene.clone())
    }

    fn scene_points(&self, scene: &Scene) -> u64 {
        let mut files: Vec<&str> = (scene.sweeps.iter())
            .filter(|sweep| sweep.points_of.is_timeless())
            .map(|sweep| sweep.file.as_str())
            .collect();
        files.sort_unstable();
        files.dedup();
        files.into_iter().map(|file| count_points(&self.root, file, &self.surfels)).sum()
    }

    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        match sweep.points_of {
            PointsOf::Moment | PointsOf::Nothing => Ok(plain(no_points())),
            PointsOf::World => {
                let points = self.read_file(self.scene_of(sweep)?, &sweep.file)?;
                Ok(points.background())
            }
            PointsOf::Track(track) => self.read_track(sweep, track),
        }
    }

    fn defaults(&self) -> ReaderDefaults {
        Self::format_defaults()
    }
}

fn plain(cloud: PointCloud<PointLabel>) -> SweepPoints {
    SweepPoints { cloud, warnings: Vec::new(), unknown: UnknownLabels::default() }
}

fn no_points() -> PointCloud<PointLabel> {
    PointCloud::with_origins(vec![Point3::origin()])
}

fn unknown_scene(name: &str) -> Fault {
    Fault::new("scene-unknown", name, "a scene of this log", "none")
}

/// Whether every scene that is asked for by name is there.
fn check_wanted(options: &ReadOptions, folders: &[Folder]) -> Result<(), Fault> {
    let known: Vec<&str> = folders.iter().map(|folder| folder.name.as_str()).collect();
    let absent = |wanted: &&String| !known.contains(&wanted.as_str());
    let Some(name) = options.scenes.iter().flatten().find(absent) else { return Ok(()) };
    let fault = Fault::new("scene-unknown", "scenes", format!("a scene `{name}`"), "none");
    Err(fault.hint(format!("there is {}", quoted(&nearest_names(name, &known)))))
}
