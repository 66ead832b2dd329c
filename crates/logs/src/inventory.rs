//! Which of a scene's files are there, found out without reading them.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use occlabel_core::{Fault, Scene};
use occlabel_disk as disk;

use crate::SceneSource;
use crate::files::unreadable;

/// The files of a scene's sweeps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inventory {
    /// Those that are there, relative to the log's root, with their sizes.
    pub present: Vec<(String, u64)>,
    /// Those that are not, in order of sweeps.
    pub missing: Vec<MissingFile>,
}

/// A file that is not there, or cannot be looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingFile {
    /// Its path below the log's root.
    pub file: String,
    /// The first sweep that it belongs to, by its place in the scene.
    pub sweep: usize,
    /// Whether a keyframe refers to a sweep that it belongs to.
    pub is_reference: bool,
    /// That it is absent, or why it cannot be looked at.
    found: Fault,
}

impl MissingFile {
    /// That it is missing, as a fault.
    pub fn fault(&self) -> Fault {
        let fault = self.found.clone();
        if self.is_reference { fault.record("reference sweep of a keyframe") } else { fault }
    }
}

impl Inventory {
    /// Looks for every file of the scene's sweeps below the log's root. One that many sweeps share
    /// counts once.
    pub fn take(source: &dyn SceneSource, root: &Path, scene: &Scene) -> Self {
        let references: BTreeSet<usize> = scene.keyframes.iter().map(|frame| frame.sweep).collect();
        let (mut inventory, mut seen) = (Self::default(), HashMap::new());
        for (sweep, header) in scene.sweeps.iter().enumerate() {
            for file in source.sweep_files(header) {
                let place =
                    seen.entry(file.clone()).or_insert_with(|| inventory.look(root, file, sweep));
                if let Some(missing) = place.and_then(|place| inventory.missing.get_mut(place)) {
                    missing.is_reference |= references.contains(&sweep);
                }
            }
        }
        inventory
    }

    /// Looks for a file; its place among the missing, if it is one.
    fn look(&mut self, root: &Path, file: String, sweep: usize) -> Option<usize> {
        match disk::metadata(&root.join(&file)) {
            Ok(metadata) => {
                self.present.push((file, metadata.bytes()));
                None
            }
            Err(error) => {
                let found = unreadable(&file, &error);
                self.missing.push(MissingFile { file, sweep, is_reference: false, found });
                Some(self.missing.len() - 1)
            }
        }
    }

    /// One fault about all that is missing: how many files, and about how many bytes.
    pub fn summary(&self) -> Option<Fault> {
        let missing = self.missing.len();
        let expected = format!("all {}", missing + self.present.len());
        let found = format!("{missing} missing, about {} bytes", self.missing_bytes());
        let fault = Fault::new("missing-files", "files of points and labels", expected, found);
        (missing > 0).then_some(fault)
    }

    /// About how many bytes are missing: each file weighs as the median of the present ones of
    /// its kind.
    pub fn missing_bytes(&self) -> u64 {
        self.missing.iter().map(|missing| self.typical_bytes(kind(&missing.file))).sum()
    }

    fn typical_bytes(&self, of_kind: &str) -> u64 {
        let alike = self.present.iter().filter(|(file, _)| kind(file) == of_kind);
        let mut sizes: Vec<u64> = alike.map(|(_, bytes)| *bytes).collect();
        sizes.sort_unstable();
        sizes.get(sizes.len() / 2).copied().unwrap_or(0)
    }
}

/// What a file holds, told by its ending: `pcd.bin`, `npz`.
fn kind(file: &str) -> &str {
    let name = file.rsplit('/').next().unwrap_or(file);
    name.split_once('.').map_or("", |(_, ending)| ending)
}
