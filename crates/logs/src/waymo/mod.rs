//! Logs of the Waymo Open Dataset, perception: v1 (TFRecord) and v2 (Parquet).
//!
//! Both versions give the same [`Segment`]s and range images; from there on, nothing knows which it
//! was. docs/waymo.md names every field that is read.

mod calibration;
mod cameras;
mod classes;
#[cfg(feature = "waymo-v2")]
mod component_images;
#[cfg(feature = "waymo-v2")]
mod components;
pub(crate) mod compressed;
#[cfg(all(feature = "waymo-v2", any(test, fuzzing)))]
pub(crate) mod doors;
mod frame;
mod layout;
mod matrix;
#[cfg(feature = "waymo-v2")]
mod parquet_cursor;
#[cfg(feature = "waymo-v2")]
mod parquet_table;
mod range_image;
mod scene;
mod segment;
mod sweep_id;
mod tfrecord;
mod tfrecords;
mod tracks;

use std::path::Path;
use std::slice;

use occlabel_core::{Exposure, Fault, Scene, SweepHeader, reference_lidar};

use crate::names::{nearest_names, quoted};
use crate::raw_labels::RawLabels;
use crate::sampled_points::sampled_points;
use crate::{ReadOptions, ReaderDefaults, SceneSource, SweepPoints};

use classes::point_class;
#[cfg(feature = "waymo-v2")]
use components::Components;
use layout::Layout;
use range_image::{RangeImages, points};
use segment::{LidarCalibration, Place, Segment};
use sweep_id::SweepId;
use tfrecords::TfRecords;

/// The vehicle's body around its top lidar, along the vehicle's axes, metres: what the code behind
/// Occ3D-Waymo drops, which knows no bounds of height (labels.md section 13).
const BODY_AROUND_TOP_M: ([f64; 3], [f64; 3]) = ([-8.0, -2.0, -1000.0], [4.0, 2.0, 1000.0]);

/// Whether a folder holds frames of either version.
pub(crate) fn has_frames(root: &Path) -> bool {
    Layout::of_folder(root).is_ok()
}

/// A log of the Waymo Open Dataset.
#[derive(Debug)]
pub struct WaymoLog {
    options: ReadOptions,
    version: Version,
    names: Vec<String>,
    defaults: ReaderDefaults,
}

#[derive(Debug)]
enum Version {
    V1(TfRecords),
    #[cfg(feature = "waymo-v2")]
    V2(Components),
}

impl WaymoLog {
    /// Opens a log: finds its frames.
    ///
    /// # Errors
    /// If the folder holds neither version, a wanted scene is not there, or no frame can be read.
    pub fn open(root: &Path, options: ReadOptions) -> Result<Self, Fault> {
        let version = Version::open(root)?;
        let defaults = version.defaults()?;
        let all = version.names();
        check_wanted(&options, &all)?;
        let names = all.into_iter().filter(|name| options.wants(name)).collect();
        Ok(Self { options, version, names, defaults })
    }

    /// What the format itself says where the configuration says `"auto"`: known before the log is
    /// opened, at the price of one file.
    ///
    /// # Errors
    /// If the folder holds neither version, or no frame can be read.
    pub fn format_defaults(root: &Path) -> Result<ReaderDefaults, Fault> {
        if let Layout::V1(files) = Layout::of_folder(root)? {
            let of_file = |file: &String| Version::V1(TfRecords::open(root, slice::from_ref(file)));
            if let Some(defaults) = files.iter().find_map(|file| of_file(file).defaults().ok()) {
                return Ok(defaults);
            }
        }
        Version::open(root)?.defaults()
    }
}

impl SceneSource for WaymoLog {
    fn scene_names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn tables(&self) -> Vec<String> {
        match &self.version {
            Version::V1(_) => Vec::new(),
            #[cfg(feature = "waymo-v2")]
            Version::V2(log) => self.names.iter().flat_map(|name| log.tables(name)).collect(),
        }
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        match (&self.version, SweepId::parse(&sweep.source_id)) {
            #[cfg(feature = "waymo-v2")]
            (Version::V2(log), Some(id)) => log.sweep_files(&id, sweep),
            _ => vec![sweep.file.clone()],
        }
    }

    fn read_image(&self, scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        let Some(camera) = scene.cameras.get(exposure.camera) else { return Ok(None) };
        match &self.version {
            Version::V1(log) => log.jpeg(&scene.name, &camera.name, exposure.time),
            #[cfg(feature = "waymo-v2")]
            Version::V2(log) => log.jpeg(&scene.name, &camera.name, exposure.time),
        }
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        match self.version.segment(scene) {
            Some(segment) => scene::build_scene(&self.options, scene, segment?),
            None => Err(Fault::new("scene-unknown", scene, "a segment of this log", "none")),
        }
    }

    fn scene_points(&self, scene: &Scene) -> u64 {
        sampled_points(self, scene)
    }

    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let record = sweep.source_id.clone();
        let place = Place { file: sweep.file.clone(), record, offset: None };
        let unknown = || place.fault("sweep-unknown", "a sweep of this log", "another");
        let id = SweepId::parse(&sweep.source_id).ok_or_else(unknown)?;
        let (images, calibration) = self.version.images(&id, sweep)?;
        let rows = images.check().and_then(|()| calibration.inclinations.rows(images.size().0));
        let rows = rows.map_err(|found| {
            place.fault("range-image", "images of one size, an inclination for each row", found)
        })?;
        let mut classes = RawLabels::new(&self.options, point_class);
        let cloud = points(&images, &rows, sweep, |raw| classes.label(raw.into()));
        let located = |fault: Fault| fault.record(&sweep.source_id);
        let mut warnings = Vec::new();
        let unknown = classes.finish(&sweep.file, &mut warnings).map_err(located)?;
        Ok(SweepPoints { cloud, warnings, unknown }.located(located))
    }

    fn defaults(&self) -> ReaderDefaults {
        self.defaults.clone()
    }
}

impl Version {
    fn open(root: &Path) -> Result<Self, Fault> {
        match Layout::of_folder(root)? {
            Layout::V1(files) => Ok(Self::V1(TfRecords::open(root, &files))),
            #[cfg(feature = "waymo-v2")]
            Layout::V2 => Components::open(root).map(Self::V2),
            #[cfg(not(feature = "waymo-v2"))]
            Layout::V2 => {
                let expected = "a program built with the cargo feature `waymo-v2`";
                Err(Fault::new("waymo-v2", root.display().to_string(), expected, "one without it"))
            }
        }
    }

    fn names(&self) -> Vec<String> {
        match self {
            Self::V1(log) => log.names().cloned().collect(),
            #[cfg(feature = "waymo-v2")]
            Self::V2(log) => log.names().to_vec(),
        }
    }

    fn segment(&self, name: &str) -> Option<Result<Segment, Fault>> {
        match self {
            Self::V1(log) => log.segment(name),
            #[cfg(feature = "waymo-v2")]
            Self::V2(log) => log.segment(name),
        }
    }

    fn images(
        &self,
        id: &SweepId,
        sweep: &SweepHeader,
    ) -> Result<(RangeImages, LidarCalibration), Fault> {
        match self {
            Self::V1(log) => log.images(id, sweep),
            #[cfg(feature = "waymo-v2")]
            Self::V2(log) => log.images(id, sweep),
        }
    }

    fn defaults(&self) -> Result<ReaderDefaults, Fault> {
        let lidars = match self {
            Self::V1(log) => log.any_lidars()?,
            #[cfg(feature = "waymo-v2")]
            Self::V2(log) => log.any_lidars()?,
        };
        let names: Vec<String> =
            lidars.iter().map(|calibration| calibration.lidar.name().to_owned()).collect();
        let top = lidars.iter().find(|calibration| calibration.lidar.name() == "TOP");
        Ok(ReaderDefaults {
            ego_box_m: top.map(body),
            taxonomy: "occ3d-waymo",
            reference_lidar: reference_lidar(&names).cloned().unwrap_or_else(|| "TOP".into()),
        })
    }
}

/// The vehicle's body in its own frame, by where its top lidar stands.
fn body(top: &LidarCalibration) -> ([f64; 3], [f64; 3]) {
    let place = top.ego_from_lidar.translation.vector;
    let moved = |corner: [f64; 3]| [0, 1, 2].map(|axis| corner[axis] + place[axis]);
    (moved(BODY_AROUND_TOP_M.0), moved(BODY_AROUND_TOP_M.1))
}

/// Whether every scene that is asked for by name is there.
fn check_wanted(options: &ReadOptions, names: &[String]) -> Result<(), Fault> {
    let absent = |wanted: &&String| !names.contains(wanted);
    let Some(name) = options.scenes.iter().flatten().find(absent) else { return Ok(()) };
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    let fault = Fault::new("scene-unknown", "frames", format!("a segment `{name}`"), "none");
    let near = quoted(&nearest_names(name, &known));
    Err(if near.is_empty() { fault } else { fault.hint(format!("there is {near}")) })
}
