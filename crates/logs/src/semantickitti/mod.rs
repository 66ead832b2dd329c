//! Logs in the layout of SemanticKITTI: scans, labels, poses of a camera, times.
//!
//! docs/semantickitti.md names every file that is read. There are no boxes and no tracks.

mod classes;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
mod mounting;
mod scene;
mod sequences;
mod tables;

#[cfg(any(test, fuzzing))]
pub(crate) use tables::{pose as line_of_pose, time as line_of_time};

use std::path::{Path, PathBuf};

use occlabel_core::{Fault, LIDAR_ORIGIN, PointCloud, PointLabel, Scene, SweepHeader};
use occlabel_disk as disk;

use crate::files::read_file;
use crate::kitti_labels::{class_name, decode_labels};
use crate::names::{nearest_names, quoted};
use crate::points::decode_points;
use crate::raw_labels::RawLabels;
use crate::{PointColumns, ReadOptions, ReaderDefaults, SceneSource, SweepPoints, UnknownLabels};

pub(crate) use classes::label_name;
use sequences::{Sequence, label_file, sequences};

/// The name of the only lidar.
const LIDAR: &str = "velodyne";

/// Whether a folder is a sequence, or holds any.
pub(crate) fn has_scans(root: &Path) -> bool {
    sequences(root).is_ok()
}

/// A log in the layout of SemanticKITTI.
#[derive(Debug)]
pub struct SemanticKittiLog {
    root: PathBuf,
    options: ReadOptions,
    sequences: Vec<Sequence>,
}

impl SemanticKittiLog {
    /// Opens a log: finds its sequences, in a folder `sequences` or as the root itself.
    ///
    /// # Errors
    /// If there is none, or a wanted scene is not there.
    pub fn open(root: &Path, options: ReadOptions) -> Result<Self, Fault> {
        let mut sequences = sequences(root)?;
        check_wanted(&options, &sequences)?;
        sequences.retain(|sequence| options.wants(&sequence.name));
        Ok(Self { root: root.to_owned(), options, sequences })
    }

    /// What the format itself says where the configuration says `"auto"`. It knows nothing of the
    /// vehicle's body.
    pub fn format_defaults() -> ReaderDefaults {
        ReaderDefaults {
            ego_box_m: None,
            taxonomy: "semantickitti",
            reference_lidar: LIDAR.to_owned(),
        }
    }

    fn read_cloud(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let bytes = read_file(&self.root, &sweep.file)?;
        let decoded = decode_points(&bytes, &sweep.file, Some(PointColumns::Four));
        let (positions, mut warnings) = decoded?;
        let mut names = RawLabels::new(&self.options, |raw| class_name(raw, label_name));
        let (labels, unknown) = match label_file(sweep).filter(|_| sweep.labelled) {
            Some(file) => {
                let bytes = read_file(&self.root, &file)?;
                let raw = decode_labels(&bytes, &file, positions.len())?;
                (names.labels(raw), names.finish(&file, &mut warnings)?)
            }
            None => (vec![PointLabel::Unlabelled; positions.len()], UnknownLabels::default()),
        };
        let cloud = PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels);
        Ok(SweepPoints { cloud, warnings, unknown })
    }
}

impl SceneSource for SemanticKittiLog {
    fn scene_names(&self) -> Vec<String> {
        self.sequences.iter().map(|sequence| sequence.name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        let tables = self.sequences.iter().flat_map(Sequence::tables);
        tables.filter(|table| disk::is_file(&self.root.join(table))).collect()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        let labels = label_file(sweep).filter(|_| sweep.labelled);
        [sweep.file.clone()].into_iter().chain(labels).collect()
    }

    fn load(&self, scene: &str) -> Result<Scene, Fault> {
        match self.sequences.iter().find(|sequence| sequence.name == scene) {
            Some(sequence) => scene::build_scene(&self.root, &self.options, sequence),
            None => Err(Fault::new("scene-unknown", scene, "a sequence of this log", "none")),
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
        Self::format_defaults()
    }
}

/// Whether every scene that is asked for by name is there.
fn check_wanted(options: &ReadOptions, sequences: &[Sequence]) -> Result<(), Fault> {
    let known: Vec<&str> = sequences.iter().map(|sequence| sequence.name.as_str()).collect();
    let absent = |wanted: &&String| !known.contains(&wanted.as_str());
    let Some(name) = options.scenes.iter().flatten().find(absent) else { return Ok(()) };
    let fault = Fault::new("scene-unknown", "sequences", format!("a sequence `{name}`"), "none");
    Err(fault.hint(format!("there is {}", quoted(&nearest_names(name, &known)))))
}
