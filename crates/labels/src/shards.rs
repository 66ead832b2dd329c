//! The manifests of a run in shards, read as one.

use std::collections::BTreeSet;
use std::collections::btree_map::Entry;
use std::path::Path;

use occlabel_core::Fault;

use crate::run_files::shards_in;
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
        self.take_in(other)?;
        Ok(self.in_order())
    }

    /// Adds what another shard says; the files are out of order then, and the hashes not those of all.
    fn take_in(&mut self, other: Self) -> Result<(), Fault> {
        let other_keys = self.other_keys(&other);
        if !other_keys.is_empty() {
            let found = format!("another {}", other_keys.join(", "));
            return Err(Fault::new("shards", "manifest.json", "shards of one run", found)
                .hint("all shards of a run are labelled from one log by one configuration"));
        }
        for (scene, record) in other.scenes {
            match self.scenes.entry(scene) {
                Entry::Vacant(place) => drop(place.insert(record)),
                Entry::Occupied(told) if *told.get() == record => {}
                Entry::Occupied(told) => {
                    let expected = "each scene in one shard";
                    let fault = Fault::new("shards", "manifest.json", expected, told.key());
                    return Err(fault.record("scenes"));
                }
            }
        }
        self.files.extend(other.files);
        self.input_hashes.scenes.extend(other.input_hashes.scenes);
        Ok(())
    }

    fn in_order(mut self) -> Self {
        self.files.sort();
        self.files.dedup();
        self.inputs_hash = self.input_hashes.whole();
        self
    }

    /// In what another manifest is of another run.
    fn other_keys(&self, other: &Self) -> Vec<&'static str> {
        let same = [
            ("program", self.program == other.program),
            ("config", self.config == other.config),
            ("taxonomy", self.taxonomy == other.taxonomy),
            ("input_hashes.shared", self.input_hashes.shared == other.input_hashes.shared),
            ("dialect", self.dialect == other.dialect),
            ("grid", self.grid == other.grid),
            ("classes", self.classes == other.classes),
            ("free", self.free == other.free),
        ];
        same.iter().filter(|(_, is_same)| !is_same).map(|(key, _)| *key).collect()
    }

    /// All manifests as one; `None` of none.
    ///
    /// # Errors
    /// As for [`Manifest::merge`].
    pub fn merge_all(manifests: impl IntoIterator<Item = Self>) -> Result<Option<Self>, Fault> {
        let mut manifests = manifests.into_iter();
        let Some(mut merged) = manifests.next() else { return Ok(None) };
        let mut others = manifests.peekable();
        if others.peek().is_none() {
            return Ok(Some(merged));
        }
        others.try_for_each(|manifest| merged.take_in(manifest))?;
        Ok(Some(merged.in_order()))
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

/// How many shards there are, by the names of their manifests.
fn shard_count(root: &Path) -> Result<Option<usize>, Fault> {
    let shards = shards_in(&LabelTree::new(root), "manifest")?;
    let counts: BTreeSet<usize> = shards.into_iter().map(|(_, count)| count).collect();
    if counts.len() > 1 {
        let counts: Vec<String> = counts.iter().map(ToString::to_string).collect();
        let found = format!("shards of {}", counts.join(", and of "));
        let place = root.display().to_string();
        return Err(Fault::new("shards", place, "the shards of one run", found)
            .hint("move the manifests and records of all but one run away"));
    }
    Ok(counts.first().copied())
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
