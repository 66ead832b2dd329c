//! `merge-manifests`: what the shards of a run say, as one whole run would say it.
//!
//! The manifest of the whole is written last, then the shards' own files leave: a merge that was
//! interrupted is done by the same command.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_dialects::Annotations;
use occlabel_disk as disk;
use occlabel_labels::{
    FileRecord, LabelTree, Manifest, RunFiles, Shards, TreePath, name_of_whole, pretty_json,
    remove_file, write_file,
};
use serde_json::{Value, json};

use crate::args::MergeArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};

pub(crate) fn run(args: &MergeArgs, console: &Console) -> Result<Outcome, Stop> {
    let tree = LabelTree::new(&args.labels);
    let whole = RunFiles::whole(tree.clone());
    let merged = match Manifest::load(&whole.manifest())? {
        Some(merged) => merged,
        None => merge(&tree, &whole)?,
    };
    remove_merged(&tree, &merged)?;
    let keyframes: usize = merged.scenes.values().map(|scene| scene.keyframes.len()).sum();
    let (scenes, files) = (merged.scenes.len(), merged.files.len());
    console.result(&format!("{scenes} scenes, {keyframes} keyframes, {files} files"));
    Ok(Outcome::Complete)
}

/// Writes the whole run's files, the manifest last.
fn merge(tree: &LabelTree, whole: &RunFiles) -> Result<Manifest, Stop> {
    let shards = Shards::find(tree.root()).map_err(Stop::usage)?;
    let shards = shards.ok_or_else(|| Stop::usage(no_shards(tree.root())))?;
    let reports = shards.files.iter().map(|files| read_json(&files.report()));
    let report = merge_reports(&reports.collect::<Result<Vec<_>, _>>()?);
    let merged = Manifest::merge_all(shards.manifests)?.expect("at least one shard");
    let merged = with_files_of_whole(tree, merged)?;
    write_file(&whole.report(), &pretty_json(&report))?;
    write_file(&whole.manifest(), &merged.to_json())?;
    Ok(merged)
}

/// Writes the files that tell of all keyframes, lists first and then the manifests of sets below, and
/// lists them in place of those of the shards.
fn with_files_of_whole(tree: &LabelTree, mut merged: Manifest) -> Result<Manifest, Fault> {
    let mut of_shards: BTreeMap<String, Vec<TreePath>> = BTreeMap::new();
    for file in &merged.files {
        if let Some(whole) = name_of_whole(file.path.as_str()) {
            of_shards.entry(whole).or_default().push(file.path.clone());
        }
    }
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

/// The lists of keyframes of shards as one.
fn merge_lists(tree: &LabelTree, parts: &[TreePath]) -> Result<Vec<u8>, Fault> {
    let mut scenes = BTreeMap::new();
    for part in parts {
        let list: Annotations = read_json(&tree.place(part))?;
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
    let load = |part: &TreePath| read_json::<Manifest>(&tree.place(part));
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

/// Lists these files in place of the shards'.
fn replace(manifest: &mut Manifest, records: Vec<FileRecord>) {
    manifest.files.retain(|file| name_of_whole(file.path.as_str()).is_none());
    manifest.files.extend(records);
    manifest.files.sort();
}

/// Removes the shards' own files, now that the whole run's manifest says all that theirs do.
fn remove_merged(tree: &LabelTree, merged: &Manifest) -> Result<(), Fault> {
    let is_replaced = |whole: &str| {
        let listed = merged.files.iter().any(|file| file.path.as_str() == whole);
        listed || ["manifest.json", "report.json"].contains(&whole)
    };
    let of_shards = |path: &String| name_of_whole(path).is_some_and(|whole| is_replaced(&whole));
    let parts: Vec<String> = tree.files()?.into_iter().filter(of_shards).collect();
    for part in parts.iter().filter(|part| !part.contains('/') && part.starts_with("manifest.")) {
        let shard: Manifest = read_json(&tree.root().join(part))?;
        check_holds(merged, &shard, part)?;
    }
    parts.iter().try_for_each(|part| remove_file(&tree.root().join(part)))
}

/// Refuses to let a shard's manifest go of which the whole run's does not say everything.
fn check_holds(merged: &Manifest, shard: &Manifest, place: &str) -> Result<(), Fault> {
    let mut scenes = shard.scenes.iter();
    let is_held = merged.config_hash == shard.config_hash
        && scenes.all(|(scene, record)| merged.scenes.get(scene) == Some(record));
    if is_held {
        return Ok(());
    }
    let found = "a manifest.json of other labels beside it";
    Err(Fault::new("shards", place, "the manifest of a run that ended in shards", found)
        .hint("remove manifest.json, or give the shards another --output"))
}

/// The reports of shards as one: counts are summed, scenes and findings joined, the rest kept by shard.
fn merge_reports(reports: &[Value]) -> Value {
    let mut merged = json!({ "version": 1, "scenes": {}, "total": {} });
    let list = |key: &str| -> Vec<&Value> {
        reports.iter().flat_map(|report| report[key].as_array().into_iter().flatten()).collect()
    };
    for report in reports {
        add(&mut merged["scenes"], &report["scenes"]);
        add(&mut merged["total"], &report["total"]);
    }
    let is_degraded = reports.iter().any(|report| report["outcome"] != "complete");
    merged["outcome"] = json!(if is_degraded { "degraded" } else { "complete" });
    for key in ["warnings", "skipped_or_degraded"] {
        merged[key] = json!(list(key));
    }
    let of_shard = |report: &Value| {
        let keys = ["outcome", "seconds", "peak_memory_bytes", "threads", "host"];
        Value::Object(keys.map(|key| (key.to_owned(), report[key].clone())).into_iter().collect())
    };
    merged["shards"] = json!(reports.iter().map(of_shard).collect::<Vec<_>>());
    merged
}

/// Adds numbers to numbers, key by key; what is there once stays as it is.
fn add(sum: &mut Value, more: &Value) {
    match (sum, more) {
        (Value::Object(sum), Value::Object(more)) => {
            for (key, value) in more {
                match sum.get_mut(key) {
                    Some(there) => add(there, value),
                    None => drop(sum.insert(key.clone(), value.clone())),
                }
            }
        }
        (sum, Value::Number(more)) if sum.is_u64() && more.is_u64() => {
            *sum = json!(sum.as_u64().unwrap_or(0) + more.as_u64().unwrap_or(0));
        }
        (sum, Value::Number(more)) if sum.is_number() => {
            *sum = json!(sum.as_f64().unwrap_or(0.0) + more.as_f64().unwrap_or(0.0));
        }
        _ => {}
    }
}

fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, Fault> {
    let fault = |found: String| {
        Fault::new("json", path.display().to_string(), "a file as occlabel writes it", found)
    };
    let bytes = disk::read(path).map_err(|error| fault(error.to_string()))?;
    serde_json::from_slice(&bytes).map_err(|error| fault(error.to_string()))
}

fn no_shards(folder: &Path) -> Fault {
    let place = folder.display().to_string();
    Fault::new("shards", place, "manifests of shards: manifest.I-of-N.json", "none")
}
