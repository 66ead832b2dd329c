//! Logs in the layout of CODa, the campus of a robot: an Ouster's sweeps, terrain, boxes, two cameras.
//!
//! docs/coda.md names every file that is read.

mod calibration;
mod cameras;
mod classes;
#[cfg(any(test, fuzzing))]
pub(crate) mod doors;
mod frames;
mod scene;
mod sequence;
mod tracks;

use std::path::{Path, PathBuf};

use occlabel_core::{Exposure, Fault, LIDAR_ORIGIN, PointCloud, PointLabel, Scene, SweepHeader};
use occlabel_disk as disk;

use crate::files::read_file;
use crate::image_files::read_image_file;
use crate::names::{nearest_names, quoted};
use crate::points::decode_points;
use crate::raw_labels::RawLabels;
use crate::{PointColumns, ReadOptions, ReaderDefaults, SceneSource, SweepPoints, UnknownLabels};

use cameras::CAMERAS;
use classes::{NO_TERRAIN, label_name};
use sequence::{Sequence, label_file, sequences};

/// The name of the only lidar.
const LIDAR: &str = "os1";

/// Whether a folder holds sequences.
pub(crate) fn has_sequences(root: &Path) -> bool {
    sequences(root).is_ok()
}

/// A log in the layout of CODa.
#[derive(Debug)]
pub struct CodaLog {
    root: PathBuf,
    options: ReadOptions,
    sequences: Vec<Sequence>,
}

impl CodaLog {
    /// Opens a log: finds its sequences.
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
    /// robot's body.
    pub fn format_defaults() -> ReaderDefaults {
        ReaderDefaults { ego_box_m: None, taxonomy: "coda", reference_lidar: LIDAR.to_owned() }
    }

    fn read_cloud(&self, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
        let bytes = read_file(&self.root, &sweep.file)?;
        let decoded = decode_points(&bytes, &sweep.file, Some(PointColumns::Four));
        let (positions, mut warnings) = decoded?;
        let names_no_terrain = self.options.taxonomy.points.contains_key(NO_TERRAIN);
        let mut names = RawLabels::new(&self.options, |raw| label_name(raw, names_no_terrain));
        let (labels, unknown) = match label_file(sweep).filter(|_| sweep.labelled) {
            Some(file) => {
                let raw = read_labels(&self.root, &file, positions.len())?;
                (names.labels(raw), names.finish(&file, &mut warnings)?)
            }
            None => (vec![PointLabel::Unlabelled; positions.len()], UnknownLabels::default()),
        };
        let cloud = PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels);
        Ok(SweepPoints { cloud, warnings, unknown })
    }
}

impl SceneSource for CodaLog {
    fn scene_names(&self) -> Vec<String> {
        self.sequences.iter().map(|sequence| sequence.name.clone()).collect()
    }

    fn tables(&self) -> Vec<String> {
        let tables = self.sequences.iter().flat_map(|sequence| tables(&self.root, sequence));
        tables.filter(|table| disk::is_file(&self.root.join(table))).collect()
    }

    fn sweep_files(&self, sweep: &SweepHeader) -> Vec<String> {
        let labels = label_file(sweep).filter(|_| sweep.labelled);
        [sweep.file.clone()].into_iter().chain(labels).collect()
    }

    fn read_image(&self, _scene: &Scene, exposure: &Exposure) -> Result<Option<Vec<u8>>, Fault> {
        exposure.image.as_ref().map_or(Ok(None), |file| read_image_file(&self.root, file))
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

/// The label of each point, a byte each.
fn read_labels(root: &Path, file: &str, count: usize) -> Result<Vec<u8>, Fault> {
    let labels = read_file(root, file)?;
    if labels.len() != count {
        let expected = format!("{count} bytes, a label for each of {count} points");
        let found = format!("{} bytes", labels.len());
        return Err(Fault::new("label-count", file, expected, found));
    }
    Ok(labels)
}

/// All files of a sequence that are no sweep's. A folder that cannot be listed is told when the sequence
/// is read.
fn tables(root: &Path, sequence: &Sequence) -> Vec<String> {
    let of_camera = |name: &str| [format!("{name}_intrinsics"), format!("os1_to_{name}")];
    let calibrations = CAMERAS.into_iter().flat_map(of_camera).map(|of| sequence.calibration(&of));
    let boxed = sequence.boxed_frames(root).unwrap_or_default();
    let boxes = boxed.into_iter().map(|frame| sequence.boxes(frame));
    let texts = [sequence.poses(), sequence.times()].into_iter().flatten();
    texts.chain(calibrations).chain(boxes).collect()
}

/// Whether every scene that is asked for by name is there.
fn check_wanted(options: &ReadOptions, sequences: &[Sequence]) -> Result<(), Fault> {
    let known: Vec<&str> = sequences.iter().map(|sequence| sequence.name.as_str()).collect();
    let absent = |wanted: &&String| !known.contains(&wanted.as_str());
    let Some(name) = options.scenes.iter().flatten().find(absent) else { return Ok(()) };
    let fault = Fault::new("scene-unknown", "os1", format!("a sequence `{name}`"), "none");
    Err(fault.hint(format!("there is {}", quoted(&nearest_names(name, &known)))))
}
