//! Where a file of a label tree stands, and that it stands inside.
//!
//! ```text
//!   DIR/gts/<scene>/<keyframe token>/labels.npz
//!                                    evidence.npz
//!   DIR/gts/<scene>/.lock                          while the scene is being written
//!   DIR/run.json, journal.jsonl                    until the run is finished
//!   DIR/manifest.json, report.json                 from then on
//! ```

use std::fmt;
use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk as disk;
use serde::{Deserialize, Serialize};

use crate::FileRecord;
use crate::atomic::{create_dir, write_file};
use crate::files::read_fault;

/// A label tree on disk.
#[derive(Clone, Debug)]
pub struct LabelTree {
    root: PathBuf,
}

impl LabelTree {
    /// The tree in a folder, which need not exist yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Where a file of the tree is on disk.
    pub fn place(&self, path: &TreePath) -> PathBuf {
        self.root.join(&path.0)
    }

    /// Writes a file of the tree, its folders too, and gives what the manifest says of it.
    ///
    /// # Errors
    /// If it cannot be written; then nothing stands under its name that did not before.
    pub fn write(&self, path: &TreePath, bytes: &[u8]) -> Result<FileRecord, Fault> {
        let place = self.place(path);
        create_dir(place.parent().unwrap_or(&self.root))?;
        write_file(&place, bytes)?;
        Ok(FileRecord::of_bytes(path.clone(), bytes))
    }

    /// The paths of everything in the tree that is no folder, in order. Links are not followed.
    ///
    /// # Errors
    /// If a folder cannot be read.
    pub fn files(&self) -> Result<Vec<String>, Fault> {
        let mut found = Vec::new();
        collect(&self.root, "", &mut found)?;
        found.sort();
        Ok(found)
    }
}

fn collect(folder: &Path, prefix: &str, found: &mut Vec<String>) -> Result<(), Fault> {
    let unreadable = |error| read_fault(folder, &error);
    for entry in disk::list(folder).map_err(unreadable)? {
        let path = format!("{prefix}{}", entry.file_name().to_string_lossy());
        match entry.is_dir() {
            true => collect(&entry.path(), &format!("{path}/"), found)?,
            false => found.push(path),
        }
    }
    Ok(())
}

/// A file's path within a tree, with `/`, made of plain names: it cannot lead out.
///
/// A plain name is of `A-Z a-z 0-9 . _ + -` and does not start with a dot.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub struct TreePath(String);

impl TreePath {
    /// A path from its text.
    ///
    /// # Errors
    /// If one of its parts is no plain name.
    pub fn new(path: impl Into<String>) -> Result<Self, Fault> {
        let path = path.into();
        for name in path.split('/') {
            check_name(name, &path)?;
        }
        Ok(Self(path))
    }

    /// `gts/<scene>/<token>/labels.npz`, the layout of Occ3D-nuScenes.
    ///
    /// # Errors
    /// If the scene or the token is no plain name.
    pub fn labels(scene: &str, token: &str) -> Result<Self, Fault> {
        Self::of_keyframe(scene, token, "labels.npz")
    }

    /// `gts/<scene>/<token>/evidence.npz`.
    ///
    /// # Errors
    /// If the scene or the token is no plain name.
    pub fn evidence(scene: &str, token: &str) -> Result<Self, Fault> {
        Self::of_keyframe(scene, token, "evidence.npz")
    }

    /// `gts/<scene>/.lock`: the one path of the tree with a name that is not plain.
    pub(crate) fn lock(scene: &str) -> Result<Self, Fault> {
        check_name(scene, scene)?;
        Ok(Self(format!("gts/{scene}/.lock")))
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The scene of a path `gts/<scene>/...`.
    pub fn scene(&self) -> Option<&str> {
        let (scene, _) = self.0.strip_prefix("gts/")?.split_once('/')?;
        Some(scene)
    }

    /// The scene and the token of a path `gts/<scene>/<token>/<file>`.
    pub fn keyframe(&self) -> Option<(&str, &str)> {
        let (scene, rest) = self.0.strip_prefix("gts/")?.split_once('/')?;
        let (token, file) = rest.split_once('/')?;
        (!file.contains('/')).then_some((scene, token))
    }

    fn of_keyframe(scene: &str, token: &str, file: &str) -> Result<Self, Fault> {
        check_name(scene, scene)?;
        check_name(token, token)?;
        Ok(Self(format!("gts/{scene}/{token}/{file}")))
    }
}

impl TryFrom<String> for TreePath {
    type Error = Fault;

    fn try_from(path: String) -> Result<Self, Fault> {
        Self::new(path)
    }
}

impl fmt::Display for TreePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

fn check_name(name: &str, place: &str) -> Result<(), Fault> {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '+' | '-');
    if !name.is_empty() && !name.starts_with('.') && name.chars().all(plain) {
        return Ok(());
    }
    let expected = "a name of A-Z a-z 0-9 . _ + - that does not start with a dot";
    Err(Fault::new("name", place, expected, format!("`{name}`")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_11_the_layout_is_that_of_occ3d() {
        let path = TreePath::labels("scene-0061", "3e8750f3.a_b").unwrap();
        assert_eq!(path.as_str(), "gts/scene-0061/3e8750f3.a_b/labels.npz");
        assert_eq!(path.scene(), Some("scene-0061"));
        let evidence = TreePath::evidence("a", "b").unwrap();
        assert_eq!(evidence.as_str(), "gts/a/b/evidence.npz");
        assert_eq!(TreePath::new("manifest.json").unwrap().scene(), None);
    }

    #[test]
    fn fault_36_no_name_leads_out_of_the_tree() {
        let bad = ["", ".", "..", "../x", "/etc", "a/b", "a\\b", "a\0", "\u{1b}[31m", ".lock", "ä"];
        for name in bad {
            assert!(TreePath::labels(name, "token").is_err(), "scene {name:?}");
            assert!(TreePath::labels("scene", name).is_err(), "token {name:?}");
            assert!(TreePath::lock(name).is_err(), "lock {name:?}");
        }
        for path in ["../x", "/etc/passwd", "gts//x", "gts/../../x", "gts/a/", "gts/a/.lock"] {
            assert!(TreePath::new(path).is_err(), "{path}");
            assert!(serde_json::from_value::<TreePath>(path.into()).is_err(), "{path}");
        }
    }

    #[test]
    fn fault_36_a_refused_name_is_told_without_its_control_characters() {
        let text = TreePath::labels("\u{1b}[31mred", "t").unwrap_err().to_string();
        assert!(text.contains("\\u{1b}[31mred") && !text.contains('\u{1b}'), "{text}");
    }

    #[test]
    fn a_written_file_is_recorded() {
        let folder = tempfile::tempdir().unwrap();
        let tree = LabelTree::new(folder.path().join("not/yet/there"));
        let path = TreePath::labels("a", "b").unwrap();
        let record = tree.write(&path, b"bytes").unwrap();
        assert_eq!(std::fs::read(tree.place(&path)).unwrap(), b"bytes");
        assert_eq!((record.path, record.bytes), (path, 5));
    }
}
