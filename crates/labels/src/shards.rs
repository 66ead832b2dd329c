//! The manifests of a run in shards, read as one.

use std::fs;
use std::path::Path;

use occlabel_core::Fault;

use crate::{Manifest, RunFiles};

/// The manifests `manifest.I-of-N.json` of a tree as one; `None` if there are none.
///
/// # Errors
/// If one cannot be read or is absent, or they are of different runs.
pub(crate) fn load(root: &Path) -> Result<Option<Manifest>, Fault> {
    let Some(count) = shard_count(root) else { return Ok(None) };
    let shard = |index| {
        let path = RunFiles::shard(crate::LabelTree::new(root), index, count).manifest();
        Manifest::load(&path)?.ok_or_else(|| {
            let expected = format!("the manifests of all {count} shards");
            Fault::new("shards", path.display().to_string(), expected, "no such file")
        })
    };
    let mut whole = shard(0)?;
    for index in 1..count {
        join(&mut whole, shard(index)?, root)?;
    }
    whole.files.sort();
    Ok(Some(whole))
}

/// How many shards there are, by the name of any shard's manifest.
fn shard_count(root: &Path) -> Option<usize> {
    let names =
        fs::read_dir(root).ok()?.flatten().filter_map(|entry| entry.file_name().into_string().ok());
    let count = |name: String| {
        let shard = name.strip_prefix("manifest.")?.strip_suffix(".json")?;
        let (_, count) = shard.split_once("-of-")?;
        count.parse().ok().filter(|&count| count > 0)
    };
    names.filter_map(count).max()
}

fn join(whole: &mut Manifest, shard: Manifest, root: &Path) -> Result<(), Fault> {
    let is_same = whole.program == shard.program
        && whole.config == shard.config
        && whole.dialect == shard.dialect
        && whole.grid == shard.grid
        && whole.classes == shard.classes
        && whole.free == shard.free;
    if !is_same {
        let place = root.display().to_string();
        let found = "another program, configuration, grid or classes";
        return Err(Fault::new("shards", place, "shards of one run", found));
    }
    whole.scenes.extend(shard.scenes);
    whole.files.extend(shard.files);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::tests::manifest;

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
