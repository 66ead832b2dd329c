//! Files that stand beside the labels of a tree and are none: images of polarization.
//!
//! A manifest tells of labels alone, and `verify` of every file that it does not list. What else is put
//! into a tree is listed in a record of its own, so that a flipped bit is found there too.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use occlabel_core::Fault;
use serde::{Deserialize, Serialize};

use crate::atomic::{create_dir, write_file};
use crate::{FileRecord, LabelTree, json};

/// The record of files beside the labels, at the top of a tree.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beside {
    /// By what files are called: the cameras that they were made of.
    pub cameras: BTreeMap<String, Vec<String>>,
    /// The files, in order of their paths.
    pub files: Vec<FileRecord>,
}

impl Beside {
    /// Its file's name.
    pub const NAME: &str = "polarization.json";

    /// The record of a tree; an empty one if there is none.
    ///
    /// # Errors
    /// If it cannot be read, or is none.
    pub fn load(tree: &LabelTree) -> Result<Self, Fault> {
        Ok(json::read(&place(tree))?.unwrap_or_default())
    }

    /// Adds files, in place of those of the same paths.
    pub fn add(&mut self, name: &str, cameras: &[String], files: Vec<FileRecord>) {
        self.cameras.insert(name.to_owned(), cameras.to_vec());
        let paths: BTreeSet<_> = files.iter().map(|file| file.path.clone()).collect();
        self.files.retain(|file| !paths.contains(&file.path));
        self.files.extend(files);
        self.files.sort();
    }

    /// Writes the record into a tree.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, tree: &LabelTree) -> Result<(), Fault> {
        create_dir(tree.root())?;
        write_file(&place(tree), &json::pretty(self))
    }

    /// The paths of the files that it tells of, and its own.
    pub fn paths(&self) -> BTreeSet<&str> {
        self.files.iter().map(|file| file.path.as_str()).chain([Self::NAME]).collect()
    }
}

fn place(tree: &LabelTree) -> PathBuf {
    tree.root().join(Beside::NAME)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TreePath;

    #[test]
    fn files_are_told_once_and_the_record_reads_back() {
        let folder = tempfile::tempdir().unwrap();
        let tree = LabelTree::new(folder.path().join("tree"));
        let file = |name: &str, bytes: &[u8]| {
            FileRecord::of_bytes(TreePath::new(format!("gts/s/k/{name}")).unwrap(), bytes)
        };
        let mut beside = Beside::load(&tree).unwrap();
        assert_eq!(beside, Beside::default());
        let cameras = ["a", "b", "c", "d"].map(str::to_owned);
        beside.add("x", &cameras, vec![file("x_dolp.png", b"1"), file("x_aolp.png", b"2")]);
        beside.add("x", &cameras, vec![file("x_dolp.png", b"3")]);
        beside.write(&tree).unwrap();
        assert_eq!(Beside::load(&tree).unwrap(), beside);
        assert_eq!(beside.files, [file("x_aolp.png", b"2"), file("x_dolp.png", b"3")]);
        assert!(beside.paths().contains("polarization.json"));
    }
}
