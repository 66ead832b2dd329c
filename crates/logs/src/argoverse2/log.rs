//! The logs of a folder, as a source of scenes.

use std::path::{Path, PathBuf};

use nalgebra::Point3;
use occlabel_core::{Exposure, Fault, PointCloud, PointLabel, Scene, SweepHeader};
use occlabel_disk as disk;

use super::lidars::{Lidars, are_lasers, is_first};
use super::poses::Mountings;
use super::scene::{MOUNTINGS, TABLES, build_scene, is_log};
use super::table::Table;
use super::{DEPTH, POSES, format_defaults};
use crate::files::unreadable;
use crate::image_files::read_image_file;
use crate::names::{nearest_names, quoted};
use crate::{ReadOptions, ReaderDefaults, SceneSource, SweepPoints, UnknownLabels};

/// A log of Argoverse 2.
#[derive(Debug)]
pub struct Argoverse2Log {
    root: PathBuf,
    options: ReadOptions,
    /// By scene's name: its folder below the root, with a `/` at the end, or nothing.
    folders: Vec<(String, String)>,
}

impl Argoverse2Log {
    /// Opens a folder of logs, or one log.
    ///
    /// # Errors
    /// If there is none, or a wanted scene is not there.
    pub fn open(root: &Path, options: ReadOptions) -> Result<Self, Fault> {
        let mut folders = Vec::new();
        find_logs(root, String::new(), DEPTH, &mut folders)?;
        folders.sort_unstable();
        folders.dedup_by(|a, b| a.0 == b.0);
        check_wanted(root, &options, &folders)?;
        folders.retain(|(name, _)| options.wants(name));
        Ok(Self { root: root.to_owned(), options, folders })
    }

    /// What the format itself says where the configuration says `"auto"`.
    pub fn format_defaults() -> ReaderDefaults {
        format_defaults()
    }
}

impl SceneSource for Argoverse2Log {
    fn scene_names(&self) -> Vec<String> {
        self.folders.iter().map(|(name, _)| name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        let of_log = |(_, folder): &(_, String)| TABLES.map(|table| format!("{folder}{table}"));
        let tables = self.folders.iter().flat_map(of_log);
        tables.filter(|table| disk::is_file(&self.root.join(table))).collect()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        vec![sweep.file.clone()]
    }

    fn read_image(&self, _scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        exposure.image.as_ref().map_or(Ok(None), |file| read_image_file(&self.root, file))
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        match self.folders.iter().find(|(name, _)| name == scene) {
            Some((name, folder)) => build_scene(&self.root, &self.options, name, folder),
            None => Err(Fault::new("scene-unknown", scene, "a log of this folder", "none")),
        }
    }

    fn scene_points(&self, scene: &Scene) -> u64 {
        scene.sweeps.iter().map(|sweep| Table::rows(&self.root, &sweep.file).unwrap_or(0)).sum()
    }

    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let scene = sweep.source_id.split('/').next().unwrap_or_default();
        let folder = self.folders.iter().find(|(name, _)| name == scene);
        let folder = folder.map_or("", |(_, folder)| folder);
        let lidars = Lidars::of(&Mountings::read(&self.root, format!("{folder}{MOUNTINGS}"))?)?;
        let cloud = read_cloud(&self.root, sweep, &lidars)?;
        let empty = || Fault::new("sweep-empty", &sweep.file, "points", "none");
        let warnings = cloud.is_empty().then(empty).into_iter().collect();
        Ok(SweepPoints { cloud, warnings, unknown: UnknownLabels::default() })
    }

    fn defaults(&self) -> ReaderDefaults {
        format_defaults()
    }
}

/// The points of both lidars in the frame of the upper one, each with its own lidar as origin.
fn read_cloud(
    root: &Path,
    sweep: &SweepHeader,
    lidars: &Lidars,
) -> Result<PointCloud<PointLabel>, Fault> {
    let table = Table::read(root, &sweep.file)?;
    let (x, y, z) = (table.reals("x")?, table.reals("y")?, table.reals("z")?);
    let lasers = table.integers("laser_number")?;
    if !are_lasers(&lasers) {
        return Err(Fault::new("av2-laser", &sweep.file, "lasers 0 to 63", "another"));
    }
    let in_ego: Vec<Point3<f64>> = (0..x.len()).map(|i| Point3::new(x[i], y[i], z[i])).collect();
    let first_is_up = lidars.first_is_up(&in_ego, &lasers);
    let lidar_from_ego = sweep.ego_from_lidar.inverse();
    let origins = [lidars.ego_from_up, lidars.ego_from_down];
    let origins = origins.map(|ego| lidar_from_ego * Point3::from(ego.translation.vector));
    let mut cloud = PointCloud::with_origins(origins.to_vec());
    for (point, laser) in in_ego.iter().zip(lasers) {
        let origin = u32::from(is_first(laser) != first_is_up);
        cloud.push(lidar_from_ego * point, PointLabel::Unlabelled, origin);
    }
    Ok(cloud)
}

/// Adds the logs of a folder and of those below it.
fn find_logs(
    root: &Path,
    folder: String,
    depth: usize,
    found: &mut Vec<(String, String)>,
) -> Result<(), Fault> {
    let here = root.join(&folder);
    let place = here.display().to_string();
    if is_log(&here) {
        let full = disk::canonicalize(&here).map_err(|error| unreadable(&place, &error))?;
        let name = full.file_name().map(|name| name.to_string_lossy().into_owned());
        found.push((name.unwrap_or_default(), folder));
        return Ok(());
    }
    for entry in disk::list(&here).map_err(|error| unreadable(&place, &error))? {
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|_| depth > 0) else { continue };
        if disk::is_dir(&here.join(name)) {
            find_logs(root, format!("{folder}{name}/"), depth - 1, found)?;
        }
    }
    Ok(())
}

/// Whether there is a log, and every scene that is asked for by name.
fn check_wanted(
    root: &Path,
    options: &ReadOptions,
    folders: &[(String, String)],
) -> Result<(), Fault> {
    let place = root.display().to_string();
    if folders.is_empty() {
        let expected = format!("folders with {POSES}");
        return Err(Fault::new("av2-layout", place, expected, "none"));
    }
    let known: Vec<&str> = folders.iter().map(|(name, _)| name.as_str()).collect();
    let absent = |wanted: &&String| !known.contains(&wanted.as_str());
    let Some(name) = options.scenes.iter().flatten().find(absent) else { return Ok(()) };
    let fault = Fault::new("scene-unknown", place, format!("a log `{name}`"), "none");
    Err(fault.hint(format!("there is {}", quoted(&nearest_names(name, &known)))))
}
