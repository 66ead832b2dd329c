//! What `describe` says of label files.

mod dialects;
mod published;
mod rules;

use std::path::Path;

use occlabel_dialects::describe::Description;
use occlabel_labels::{NumberArray, npz};

/// A folder with an `.npz` file of arrays.
pub(crate) struct Saved {
    folder: tempfile::TempDir,
}

impl Saved {
    pub(crate) fn npz(arrays: &[(&str, NumberArray)]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let bytes = npz(arrays.iter().map(|(name, array)| (*name, array)));
        std::fs::write(folder.path().join("labels.npz"), bytes).expect("a file");
        Self { folder }
    }

    pub(crate) fn describe(&self) -> Description {
        describe(&self.folder.path().join("labels.npz"))
    }
}

pub(crate) fn describe(path: &Path) -> Description {
    Description::of_file(path, None).expect("a description")
}

/// The names of the rules that are broken.
pub(crate) fn rules_of(description: &Description) -> Vec<&'static str> {
    description.suspicions.iter().map(|suspicion| suspicion.rule).collect()
}
