//! What a manifest or a journal says of a file: its path, length and hash.

use std::io;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use serde::{Deserialize, Serialize};

use crate::{LabelTree, TreePath};

/// A finished file of a tree.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FileRecord {
    /// Where it stands in the tree.
    pub path: TreePath,
    /// Its length.
    pub bytes: u64,
    /// BLAKE3 of its bytes, in hexadecimal.
    pub blake3: String,
    /// The scene and the token of its keyframe, where its folders do not tell: they do under
    /// `gts/<scene>/<token>/`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keyframe: Option<(String, String)>,
}

impl FileRecord {
    /// The record of a file with these bytes.
    pub fn of_bytes(path: TreePath, bytes: &[u8]) -> Self {
        let blake3 = blake3::hash(bytes).to_hex().to_string();
        Self { path, bytes: bytes.len() as u64, blake3, keyframe: None }
    }

    /// The same as a file of a keyframe.
    pub fn of_keyframe(mut self, scene: &str, token: &str) -> Self {
        let tells = self.path.keyframe() == Some((scene, token));
        self.keyframe = (!tells).then(|| (scene.to_owned(), token.to_owned()));
        self
    }

    /// The scene and the token of its keyframe, if it belongs to one.
    pub fn keyframe(&self) -> Option<(&str, &str)> {
        match &self.keyframe {
            Some((scene, token)) => Some((scene, token)),
            None => self.path.keyframe(),
        }
    }

    /// The record of a file as it stands, read and hashed.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of_file(tree: &LabelTree, path: TreePath) -> Result<Self, Fault> {
        let (bytes, blake3) = hash_file(&tree.place(&path))?;
        Ok(Self { path, bytes, blake3, keyframe: None })
    }

    /// Whether a file of the recorded length stands there. (It is not read.)
    pub fn stands(&self, tree: &LabelTree) -> bool {
        let meta = disk::symlink_metadata(&tree.place(&self.path));
        meta.is_ok_and(|meta| meta.is_file() && meta.bytes() == self.bytes)
    }
}

/// The records of finished files, in order of their paths.
///
/// # Errors
/// If one cannot be read.
pub fn hash_files(
    tree: &LabelTree,
    paths: impl IntoIterator<Item = TreePath>,
) -> Result<Vec<FileRecord>, Fault> {
    let records = paths.into_iter().map(|path| FileRecord::of_file(tree, path));
    let mut records = records.collect::<Result<Vec<_>, Fault>>()?;
    records.sort();
    records.dedup();
    Ok(records)
}

/// Length and BLAKE3 of a file, read in pieces.
pub(crate) fn hash_file(path: &Path) -> Result<(u64, String), Fault> {
    let mut hasher = blake3::Hasher::new();
    disk::open(path)
        .and_then(|file| hasher.update_reader(file).map(|_| ()))
        .map_err(|error| read_fault(path, &error))?;
    Ok((hasher.count(), hasher.finalize().to_hex().to_string()))
}

/// A file that cannot be read.
pub(crate) fn read_fault(path: &Path, error: &io::Error) -> Fault {
    Fault::new("read", path.display().to_string(), "to read this file", error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn tree_with(paths: &[&str]) -> (tempfile::TempDir, LabelTree) {
        let folder = tempfile::tempdir().unwrap();
        let tree = LabelTree::new(folder.path());
        for path in paths {
            tree.write(&TreePath::new(*path).unwrap(), path.as_bytes()).unwrap();
        }
        (folder, tree)
    }

    #[test]
    fn hashing_a_file_gives_the_record_that_writing_gave() {
        let (_folder, tree) = tree_with(&[]);
        let path = TreePath::labels("a", "b").unwrap();
        let large = vec![7; 300_000];
        let written = tree.write(&path, &large).unwrap();
        assert_eq!(FileRecord::of_file(&tree, path).unwrap(), written);
    }

    #[test]
    fn section_12_records_are_sorted_by_path() {
        let (_folder, tree) = tree_with(&["gts/b/x", "gts/a/y", "gts/a/x"]);
        let paths = ["gts/b/x", "gts/a/y", "gts/a/x"].map(|path| TreePath::new(path).unwrap());
        let records = hash_files(&tree, paths).unwrap();
        let sorted: Vec<_> = records.iter().map(|record| record.path.as_str()).collect();
        assert_eq!(sorted, ["gts/a/x", "gts/a/y", "gts/b/x"]);
    }

    #[test]
    fn a_missing_file_is_an_error_that_names_it() {
        let (_folder, tree) = tree_with(&[]);
        let fault = hash_files(&tree, [TreePath::new("gts/x").unwrap()]).unwrap_err();
        assert!(fault.to_string().contains("gts/x"), "{fault}");
    }

    #[test]
    fn a_record_stands_while_its_length_does() {
        let (_folder, tree) = tree_with(&["gts/a"]);
        let record = FileRecord::of_file(&tree, TreePath::new("gts/a").unwrap()).unwrap();
        assert!(record.stands(&tree));
        fs::write(tree.place(&record.path), b"other").unwrap();
        assert_eq!(record.stands(&tree), record.bytes == 5);
        fs::write(tree.place(&record.path), b"longer").unwrap();
        assert!(!record.stands(&tree));
        fs::remove_file(tree.place(&record.path)).unwrap();
        assert!(!record.stands(&tree));
    }
}
