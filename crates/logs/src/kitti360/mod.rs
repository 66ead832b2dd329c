//! Logs in the layout of KITTI-360: scans as the lidar turned, poses at some frames, fused labels,
//! boxes.
//!
//! docs/semantickitti.md names every file that is read.

mod boxes;
mod calibration;
mod cameras;
mod classes;
mod deskew;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
mod fused;
mod layout;
mod poses;
mod scene;
mod stamps;
mod tracks;

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

use nalgebra::Point3;
use occlabel_core::{Exposure, Fault, LIDAR_ORIGIN, PointCloud, PointLabel, Scene, SweepHeader};
use occlabel_disk as disk;

use crate::files::read_file;
use crate::image_files::read_image_file;
use crate::kitti_labels::{class_name, decode_labels};
use crate::names::{nearest_names, quoted};
use crate::points::decode_points;
use crate::raw_labels::RawLabels;
use crate::{PointColumns, ReadOptions, ReaderDefaults, SceneSource, SweepPoints, UnknownLabels};

use classes::label_name;
use deskew::deskew;
use fused::FusedLabels;
use layout::Drive;
use scene::Loaded;

/// The name of the lidar.
const LIDAR: &str = "velodyne";

/// A log in the layout of KITTI-360.
#[derive(Debug)]
pub struct Kitti360Log {
    root: PathBuf,
    options: ReadOptions,
    drives: Vec<(String, OnceLock<Result<Loaded, Fault>>)>,
    /// The fused labels that were read last, by file.
    fused: Mutex<Option<(String, Arc<FusedLabels>)>>,
}

impl Kitti360Log {
    /// Whether a folder is a log of this layout.
    pub fn is_log(root: &Path) -> bool {
        layout::is_log(root)
    }

    /// Opens a log: finds its drives.
    ///
    /// # Errors
    /// If there is none, or a wanted scene is not there.
    pub fn open(root: &Path, options: ReadOptions) -> Result<Self, Fault> {
        let names = layout::drives(root)?;
        let absent = |wanted: &&String| !names.contains(wanted);
        if let Some(name) = options.scenes.iter().flatten().find(absent) {
            let known: Vec<&str> = names.iter().map(String::as_str).collect();
            let expected = format!("a drive `{name}`");
            let fault = Fault::new("scene-unknown", layout::POINTS, expected, "none");
            return Err(fault.hint(format!("there is {}", quoted(&nearest_names(name, &known)))));
        }
        let wanted = names.into_iter().filter(|name| options.wants(name));
        let drives = wanted.map(|name| (name, OnceLock::new())).collect();
        Ok(Self { root: root.to_owned(), options, drives, fused: Mutex::default() })
    }

    /// What the drive was loaded as; none if it is not of this log.
    fn loaded(&self, name: &str) -> Option<Result<&Loaded, Fault>> {
        let (name, loaded) = self.drives.iter().find(|(known, _)| known == name)?;
        let loaded = loaded.get_or_init(|| Loaded::read(&self.root, &self.options, name));
        Some(loaded.as_ref().map_err(Clone::clone))
    }

    /// The drive and the frame of a sweep.
    fn place<'a>(&self, sweep: &'a SweepHeader) -> Result<(&Loaded, Drive<'a>, usize), Fault> {
        let parts = sweep.source_id.rsplit_once('/');
        let found = parts.and_then(|(drive, frame)| {
            Some((self.loaded(drive)?, Drive(drive), frame.parse().ok()?))
        });
        let unknown = || Fault::new("sweep-unknown", &sweep.file, "a sweep of this log", "another");
        let (loaded, drive, frame) = found.ok_or_else(unknown)?;
        Ok((loaded?, drive, frame))
    }

    /// The file of a labelled sweep's labels: its own, or the fused cloud of its window.
    fn labels_of(&self, sweep: &SweepHeader) -> Option<LabelSource> {
        let (loaded, drive, frame) = self.place(sweep).ok().filter(|_| sweep.labelled)?;
        let own = drive.labels(frame);
        if disk::is_file(&self.root.join(&own)) {
            return Some(LabelSource::Scan(own));
        }
        let window = loaded.windows.iter().find(|(_, frames)| frames.contains(&frame));
        window.map(|(file, _)| LabelSource::Fused(file.clone()))
    }

    fn fused(&self, file: &str) -> Result<Arc<FusedLabels>, Fault> {
        // One at a time: sweeps of a window stand side by side, and a window is large.
        let mut last = self.fused.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some((_, labels)) = last.as_ref().filter(|(known, _)| known == file) {
            return Ok(labels.clone());
        }
        let labels = Arc::new(FusedLabels::read(&read_file(&self.root, file)?, file)?);
        *last = Some((file.to_owned(), labels.clone()));
        Ok(labels)
    }

    fn read_cloud(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let (loaded, _, frame) = self.place(sweep)?;
        let bytes = read_file(&self.root, &sweep.file)?;
        let decoded = decode_points(&bytes, &sweep.file, Some(PointColumns::Four))?;
        let (positions, mut warnings) = decoded;
        let labels = vec![PointLabel::Unlabelled; positions.len()];
        let mut cloud = match loaded.motions.get(&frame) {
            Some(motion) => deskew(positions, labels, motion),
            None => PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels),
        };
        let raw: Vec<u16> = match self.labels_of(sweep) {
            None => return Ok(SweepPoints { cloud, warnings, unknown: UnknownLabels::default() }),
            Some(LabelSource::Scan(file)) => {
                decode_labels(&read_file(&self.root, &file)?, &file, cloud.len())?
            }
            Some(LabelSource::Fused(file)) => {
                let (labels, place) = (self.fused(&file)?, sweep.world_from_lidar());
                let class = |p: &Point3<f64>| labels.class_at((place * p).into());
                cloud.positions.iter().map(|p| class(p).unwrap_or(0)).collect()
            }
        };
        let mut names = RawLabels::new(&self.options, |raw| class_name(raw, label_name));
        cloud.labels = names.labels(raw);
        let unknown = names.finish(&sweep.file, &mut warnings)?;
        Ok(SweepPoints { cloud, warnings, unknown })
    }
}

/// Where a scan's labels come from.
enum LabelSource {
    Scan(String),
    Fused(String),
}

impl SceneSource for Kitti360Log {
    fn scene_names(&self) -> Vec<String> {
        self.drives.iter().map(|(name, _)| name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        let of_drive = |(name, _): &(String, _)| {
            let drive = Drive(name);
            let [poses, of_camera] = drive.poses();
            [poses, of_camera, drive.stamps(), drive.boxes()]
        };
        let tables = self.drives.iter().flat_map(of_drive);
        let tables = calibration::FILES.map(str::to_owned).into_iter().chain(tables);
        tables.filter(|table| disk::is_file(&self.root.join(table))).collect()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        let labels = self.labels_of(sweep).map(|source| match source {
            LabelSource::Scan(file) | LabelSource::Fused(file) => file,
        });
        [sweep.file.clone()].into_iter().chain(labels).collect()
    }

    fn read_image(&self, _scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        exposure.image.as_ref().map_or(Ok(None), |file| read_image_file(&self.root, file))
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        match self.loaded(scene) {
            Some(loaded) => loaded.map(|loaded| loaded.scene.clone()),
            None => Err(Fault::new("scene-unknown", scene, "a drive of this log", "none")),
        }
    }

    fn scene_points(&self, scene: &Scene) -> u64 {
        PointColumns::Four.points_in(&self.root, &scene.sweeps)
    }

    fn read_sweep(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let located = |fault: Fault| fault.record(format!("sweep {}", sweep.source_id));
        Ok(self.read_cloud(sweep).map_err(located)?.located(located))
    }

    fn defaults(&self) -> ReaderDefaults {
        ReaderDefaults {
            ego_box_m: None,
            taxonomy: "semantickitti",
            reference_lidar: LIDAR.to_owned(),
        }
    }
}
