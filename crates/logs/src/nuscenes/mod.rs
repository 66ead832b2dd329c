//! Logs in the layout of nuScenes v1.0: JSON tables, and a file of points for each sweep.
//!
//! The tables are read once, when the log is opened, row by row, keeping only what the wanted scenes
//! need: the full data set has millions of rows, a scene a few thousand. Scenes are built from these
//! rows on demand; points are read when they are asked for.

mod cameras;
mod captures;
mod chains;
mod copies;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
mod keyframes;
mod label_files;
mod label_names;
mod npz;
mod number;
mod optics;
mod pose;
mod records;
mod references;
mod rows;
mod scene;
mod sweep_points;
mod sweeps;
mod table;
mod tables;
mod token;
mod tracks;
mod version;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use occlabel_core::{Exposure, Fault, Scene, SweepHeader, reference_lidar};

use crate::image_files::read_image_file;
use crate::{ImageFile, PointColumns, ReadOptions, ReaderDefaults, SceneSource, SweepPoints};

#[cfg(any(test, fuzzing))]
pub(crate) use npz::read_data;
pub(crate) use npz::{read_header, text_of};
#[cfg(any(test, fuzzing))]
pub(crate) use optics::decode as decode_mask;
pub(crate) use optics::{LensFields, mask_of};
#[cfg(any(test, fuzzing))]
pub(crate) use records::Records;

pub use pose::QuaternionOrder;

use label_files::LabelFile;
use tables::Tables;
use token::Token;

/// Whether a folder holds tables of any version.
pub(crate) fn has_tables(root: &Path) -> bool {
    let tables = |name: String| version::table_files(root, &root.join(name)).unwrap_or_default();
    let names = version::version_names(root).unwrap_or_default();
    names.into_iter().any(|name| !tables(name).is_empty())
}

/// Body and roof rack of the nuScenes car, ego frame (rear axle on the ground), metres
/// (labels.md section 13).
const EGO_BOX_M: ([f64; 3], [f64; 3]) = ([-1.2, -1.1, -0.3], [3.7, 1.1, 2.2]);

/// How to read a nuScenes log.
#[derive(Clone, Debug)]
pub struct NuScenesOptions {
    /// What every reader is asked for.
    pub read: ReadOptions,
    /// The folder of the tables, such as `v1.0-mini`; `None`: the only one there is.
    pub version: Option<String>,
    /// How quaternions stand in the tables.
    pub quaternion_order: QuaternionOrder,
    /// Numbers a point; `None`: five, checked by the look of the fifth.
    pub columns: Option<PointColumns>,
}

/// A log in the layout of nuScenes v1.0.
#[derive(Debug)]
pub struct NuScenesLog {
    root: PathBuf,
    options: NuScenesOptions,
    tables: Tables,
    defaults: ReaderDefaults,
    /// Relative to the root.
    table_files: Vec<String>,
}

impl NuScenesLog {
    /// Opens a log: reads its tables, as far as the wanted scenes need them.
    ///
    /// # Errors
    /// If a table is absent, broken, or names rows that are not there; if a wanted scene is not
    /// there; if a scene's name cannot be that of a folder.
    pub fn open(root: &Path, options: NuScenesOptions) -> Result<Self, Fault> {
        let folder = version::version_folder(root, options.version.as_deref())?;
        let defaults = defaults(&folder)?;
        let tables = Tables::read(&folder, options.read.scenes.as_ref())?;
        let table_files = version::table_files(root, &folder)?;
        Ok(Self { root: root.to_owned(), options, tables, defaults, table_files })
    }

    /// What the format itself says where the configuration says `"auto"`: known before the log is
    /// opened, at the price of one small table.
    ///
    /// # Errors
    /// If the version folder or its table of sensors cannot be read, or no lidar is in it.
    pub fn format_defaults(root: &Path, version: Option<&str>) -> Result<ReaderDefaults, Fault> {
        defaults(&version::version_folder(root, version)?)
    }

    /// Every token of the tables that is there twice or names nothing, and every table that cannot be
    /// read: where opening the log tells the first.
    pub fn reference_faults(root: &Path, version: Option<&str>) -> Vec<Fault> {
        match version::version_folder(root, version) {
            Ok(folder) => references::reference_faults(&folder),
            Err(fault) => vec![fault],
        }
    }

    /// The file that labels a sweep's points, unless the sweep is to go without.
    fn label_file(&self, sweep: &SweepHeader) -> Option<&LabelFile> {
        let token = Token::from(sweep.source_id.as_str());
        self.tables.labels.get(&token).filter(|_| sweep.labelled)
    }
}

impl SceneSource for NuScenesLog {
    fn scene_names(&self) -> Vec<String> {
        self.tables.scenes.iter().map(|scene| scene.name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        self.table_files.clone()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        let labels = self.label_file(sweep).map(|labels| labels.file.clone());
        std::iter::once(sweep.file.clone()).chain(labels).collect()
    }

    fn image_files(&self, scene: &str) -> Vec<ImageFile> {
        let rows = self.tables.scene(scene);
        rows.map_or(Vec::new(), |rows| cameras::image_files(&self.tables, rows))
    }

    fn read_image(&self, _scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        exposure.image.as_ref().map_or(Ok(None), |file| read_image_file(&self.root, file))
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        match self.tables.scene(scene) {
            Some(rows) => scene::build_scene(self, rows),
            None => {
                Err(Fault::new("scene-unknown", "scene.json", format!("a scene `{scene}`"), "none"))
            }
        }
    }

    fn scene_points(&self, scene: &Scene) -> u64 {
        let columns = self.options.columns.unwrap_or(PointColumns::Five);
        columns.points_in(&self.root, &scene.sweeps)
    }

    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        sweep_points::read_sweep_points(self, sweep)
    }

    fn defaults(&self) -> ReaderDefaults {
        self.defaults.clone()
    }
}

fn defaults(folder: &Path) -> Result<ReaderDefaults, Fault> {
    let sensors: HashMap<Token, table::Row<rows::Sensor>> = table::read_keyed(folder, |_| true)?;
    #[expect(clippy::disallowed_methods, reason = "of their names the least is taken")]
    let lidars = sensors.values().filter(|sensor| sensor.modality == "lidar");
    let names: Vec<String> = lidars.map(|lidar| lidar.channel.clone()).collect();
    let none = || Fault::new("reference-lidar", "sensor.json", "a lidar", "none");
    let reference_lidar = reference_lidar(&names).cloned().ok_or_else(none)?;
    Ok(ReaderDefaults { ego_box_m: Some(EGO_BOX_M), taxonomy: "occ3d-nuscenes", reference_lidar })
}
