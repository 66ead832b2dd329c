//! The files that tell of all keyframes of a run: lists, and the manifests of sets below the main one.

use std::collections::BTreeMap;

use occlabel_core::Fault;
use occlabel_dialects::Annotations;
use occlabel_labels::{
    FileRecord, LabelTree, Manifest, TreePath, name_of_whole, pretty_json, read_json_file,
};

/// Writes the files that tell of all keyframes, lists first and then the manifests of sets below, and
/// lists them in place of those of the shards.
pub(super) fn with_files_of_whole(
    tree: &LabelTree,
    mut merged: Manifest,
) -> Result<Manifest, Fault> {
    let of_shards = parts_of_whole(&merged)?;
    let is_manifest = |path: &str| path.ends_with("manifest.json");
    let (manifests, lists): (Vec<_>, Vec<_>) =
        of_shards.iter().partition(|(whole, _)| is_manifest(whole));
    let mut records = Vec::new();
    for (whole, parts) in lists {
        records.push(tree.write(&TreePath::new(whole)?, &merge_lists(tree, parts)?)?);
    }
    for (whole, parts) in manifests {
        let manifest = merge_below(tree, whole, parts, &records)?;
        records.push(tree.write(&TreePath::new(whole)?, &manifest.to_json())?);
    }
    replace(&mut merged, records);
    Ok(merged)
}

/// By the name of the whole run's file: those that become it, itself among them if an earlier merge
/// wrote it.
fn parts_of_whole(merged: &Manifest) -> Result<BTreeMap<String, Vec<TreePath>>, Fault> {
    let mut parts: BTreeMap<String, Vec<TreePath>> = BTreeMap::new();
    for file in &merged.files {
        if let Some(whole) = name_of_whole(file.path.as_str()) {
            parts.entry(whole).or_default().push(file.path.clone());
        }
    }
    for (whole, parts) in &mut parts {
        if merged.files.iter().any(|file| file.path.as_str() == whole) {
            parts.push(TreePath::new(whole.clone())?);
        }
    }
    Ok(parts)
}

/// The lists of keyframes of shards as one.
fn merge_lists(tree: &LabelTree, parts: &[TreePath]) -> Result<Vec<u8>, Fault> {
    let mut scenes = BTreeMap::new();
    for part in parts {
        let list: Annotations = read_json_file(&tree.place(part))?;
        scenes.extend(list.scene_infos);
    }
    Ok(pretty_json(&Annotations::of_scenes(scenes)))
}

/// The manifests of a set below the tree as one, with those of the records that are its own.
fn merge_below(
    tree: &LabelTree,
    whole: &str,
    parts: &[TreePath],
    records: &[FileRecord],
) -> Result<Manifest, Fault> {
    let load = |part: &TreePath| read_json_file::<Manifest>(&tree.place(part));
    let parts = parts.iter().map(load).collect::<Result<Vec<_>, _>>()?;
    let mut merged = Manifest::merge_all(parts)?.expect("at least one shard");
    let folder = whole.trim_end_matches("manifest.json");
    let own = records.iter().filter_map(|record| {
        let path = TreePath::new(record.path.as_str().strip_prefix(folder)?).ok()?;
        Some(FileRecord { path, ..record.clone() })
    });
    replace(&mut merged, own.collect());
    Ok(merged)
}

/// Lists these files in place of the shards', and of what they were before.
fn replace(manifest: &mut Manifest, records: Vec<FileRecord>) {
    let is_replaced = |file: &FileRecord| records.iter().any(|record| record.path == file.path);
    manifest.files.retain(|file| name_of_whole(file.path.as_str()).is_none() && !is_replaced(file));
    manifest.files.extend(records);
    manifest.files.sort();
}
