//! Files that a scene lists but that are not there.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use occlabel_core::{Scene, SweepHeader};

use super::NuScenesLog;

/// A file that is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingFile {
    /// Its path below the log's root.
    pub file: String,
    /// The sweep that it belongs to, by its place in the scene.
    pub sweep: usize,
    /// Whether a keyframe refers to that sweep.
    pub is_reference: bool,
    /// Whether it holds labels, not points.
    pub holds_labels: bool,
    /// The median size of the scene's files of its kind; 0 if there is none.
    pub estimated_bytes: u64,
}

/// All absent files of a scene's points and labels, in order of sweeps.
pub(super) fn missing_files(log: &NuScenesLog, scene: &Scene) -> Vec<MissingFile> {
    let points = |sweep: &SweepHeader| Some(sweep.file.clone());
    let labels = |sweep: &SweepHeader| log.label_file(sweep).map(|labels| labels.file.clone());
    let mut missing = missing_of_kind(log, scene, false, points);
    missing.extend(missing_of_kind(log, scene, true, labels));
    missing.sort_by_key(|file| (file.sweep, file.holds_labels));
    missing
}

fn missing_of_kind(
    log: &NuScenesLog,
    scene: &Scene,
    holds_labels: bool,
    file_of: impl Fn(&SweepHeader) -> Option<String>,
) -> Vec<MissingFile> {
    let references: BTreeSet<usize> = scene.keyframes.iter().map(|frame| frame.sweep).collect();
    let (mut sizes, mut missing) = (Vec::new(), Vec::new());
    for (sweep, header) in scene.sweeps.iter().enumerate() {
        let Some(file) = file_of(header) else { continue };
        match size(&log.root.join(&file)) {
            Some(bytes) => sizes.push(bytes),
            None => {
                let is_reference = references.contains(&sweep);
                let estimated_bytes = 0;
                missing.push(MissingFile {
                    file,
                    sweep,
                    is_reference,
                    holds_labels,
                    estimated_bytes,
                });
            }
        }
    }
    let estimated_bytes = median(sizes);
    missing.into_iter().map(|file| MissingFile { estimated_bytes, ..file }).collect()
}

/// A file's size; `None` if it is absent. One that is there but cannot be looked at counts as empty.
fn size(path: &Path) -> Option<u64> {
    match fs::metadata(path) {
        Ok(metadata) => Some(metadata.len()),
        Err(error) => (error.kind() != ErrorKind::NotFound).then_some(0),
    }
}

fn median(mut sizes: Vec<u64>) -> u64 {
    sizes.sort_unstable();
    sizes.get(sizes.len() / 2).copied().unwrap_or(0)
}
