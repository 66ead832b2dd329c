//! The manifests of a run in shards, read as one.

use std::io::{self, ErrorKind};
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::files::read_fault;
use crate::{LabelTree, Manifest, RunFiles};

/// The shards of a run that wrote a tree; none of a run that was undivided.
#[derive(Clone, Debug, Default)]
pub struct Shards {
    /// Those that have ended: each one's own files and what it says of its scenes, in order.
    pub ended: Vec<(RunFiles, Manifest)>,
    /// The others, of which there is no manifest: none yet, or no longer.
    pub absent: Vec<RunFiles>,
}

impl Shards {
    /// The shards whose manifests `manifest.I-of-N.json` stand in a tree.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn find(root: &Path) -> Result<Self, Fault> {
        let (tree, mut shards) = (LabelTree::new(root), Self::default());
        let count = shard_count(root)?.unwrap_or(0);
        for files in (0..count).map(|index| RunFiles::shard(tree.clone(), index, count)) {
            match Manifest::load(&files.manifest())? {
                Some(manifest) => shards.ended.push((files, manifest)),
                None => shards.absent.push(files),
            }
        }
        Ok(shards)
    }
}

impl Manifest {
    /// What two shards of a run say together: the same in any order and in any groups.
    ///
    /// # Errors
    /// If they are of different runs, or say different things of one scene.
    pub fn merge(mut self, other: Self) -> Result<Self, Fault> {
        let is_same_run = self.program == other.program
            && self.config == other.config
            && self.taxonomy == other.taxonomy
            && self.input_hashes.shared == other.input_hashes.shared
            && self.dialect == other.dialect
            && self.grid == other.grid
            && self.classes == other.classes
            && self.free == other.free;
        if !is_same_run {
            let found = "another program, configuration, input, grid or classes";
            return Err(Fault::new("shards", "manifest.json", "shards of one run", found));
        }
        for (scene, record) in other.scenes {
            let told = self.scenes.entry(scene.clone()).or_insert_with(|| record.clone());
            if *told != record {
                let fault = Fault::new("shards", "manifest.json", "each scene in one shard", scene);
                return Err(fault.record("scenes"));
            }
        }
        self.files.extend(other.files);
        self.files.sort();
        self.files.dedup();
        self.input_hashes.scenes.extend(other.input_hashes.scenes);
        self.inputs_hash = self.input_hashes.whole();
        Ok(self)
    }

    /// All manifests as one; `None` of none.
    ///
    /// # Errors
    /// As for [`Manifest::merge`].
    pub fn merge_all(manifests: impl IntoIterator<Item = Self>) -> Result<Option<Self>, Fault> {
        let mut manifests = manifests.into_iter();
        let Some(first) = manifests.next() else { return Ok(None) };
        manifests.try_fold(first, Self::merge).map(Some)
    }
}

/// The manifests `manifest.I-of-N.json` of a tree as one; `None` if there are none.
///
/// # Errors
/// If one cannot be read or is absent, or they are of different runs.
pub(crate) fn load(root: &Path) -> Result<Option<Manifest>, Fault> {
    let shards = Shards::find(root)?;
    if let Some(files) = shards.absent.first() {
        let expected = format!("the manifests of all {} shards", files.count());
        let place = files.manifest().display().to_string();
        return Err(Fault::new("shards", place, expected, "no such file"));
    }
    Manifest::merge_all(shards.ended.into_iter().map(|(_, manifest)| manifest))
}

/// How many shards there are, by the name of any shard's manifest.
fn shard_count(root: &Path) -> Result<Option<usize>, Fault> {
    let entries = match disk::list(root) {
        Err(error) if is_no_folder(&error) => return Ok(None),
        entries => entries.map_err(|error| read_fault(root, &error))?,
    };
    let names = entries.into_iter().filter_map(|entry| entry.file_name().into_string().ok());
    let count = |name: String| {
        let shard = name.strip_prefix("manifest.")?.strip_suffix(".json")?;
        let (_, count) = shard.split_once("-of-")?;
        count.parse().ok().filter(|&count| count > 0)
    };
    Ok(names.filter_map(count).max())
}

fn is_no_folder(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::tests::manifest;
    use std::fs;

    fn write(root: &Path, name: &str, manifest: &Manifest) {
        fs::write(root.join(name), manifest.to_json()).unwrap();
    }

    fn of_scene(name: &str) -> Manifest {
        let mut manifest = manifest();
        let record = manifest.scenes.remove("s").unwrap();
        manifest.scenes.insert(name.to_owned(), record);
        manifest
    }

    #[test]
    fn shards_are_read_as_one() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        assert_eq!(Manifest::load_tree(root).unwrap(), None);
        write(root, "manifest.0-of-2.json", &of_scene("a"));
        let fault = Manifest::load_tree(root).unwrap_err();
        assert!(fault.place.contains("1-of-2") && fault.rule == "shards", "{fault}");
        write(root, "manifest.1-of-2.json", &of_scene("b"));
        let whole = Manifest::load_tree(root).unwrap().unwrap();
        assert_eq!(whole.scenes.keys().collect::<Vec<_>>(), ["a", "b"]);
    }

    #[test]
    fn shards_of_different_runs_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), "manifest.0-of-2.json", &of_scene("a"));
        write(folder.path(), "manifest.1-of-2.json", &Manifest { free: 3, ..of_scene("b") });
        assert_eq!(Manifest::load_tree(folder.path()).unwrap_err().rule, "shards");
    }
}
