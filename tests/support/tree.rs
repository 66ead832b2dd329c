//! A label tree as it was left.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use occlabel_core::Evidence;
use occlabel_labels::{LabelArrays, LabelTree, Manifest, TreePath, read_evidence, read_labels};
use serde_json::Value;

/// All arrays of a keyframe.
pub(crate) struct Arrays {
    pub(crate) labels: LabelArrays,
    pub(crate) evidence: Evidence,
}

/// All files below a folder, by their path in it, with `/`.
pub(crate) fn files_under(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for path in paths_under(root) {
        let name = path.strip_prefix(root).expect("a path inside");
        let name = name.to_str().expect("UTF-8").replace('\\', "/");
        files.insert(name, fs::read(&path).expect("a file"));
    }
    files
}

fn paths_under(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.flat_map(|path| if path.is_dir() { paths_under(&path) } else { vec![path] }).collect()
}

/// The files below `gts`: the arrays.
pub(crate) fn gts_files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    files_under(&root.join("gts"))
}

/// BLAKE3 over paths, lengths and bytes of all files but the reports.
pub(crate) fn tree_hash(root: &Path) -> String {
    let mut hasher = blake3::Hasher::new();
    for (name, bytes) in files_under(root) {
        if !is_report(&name) {
            hasher.update(format!("{name}\0{}\0", bytes.len()).as_bytes()).update(&bytes);
        }
    }
    hasher.finalize().to_hex().to_string()
}

/// Whether a path is that of `report.json`, or of a shard's.
fn is_report(path: &str) -> bool {
    path.rsplit('/').next().is_some_and(|name| name.starts_with("report."))
}

/// Files that a finished run must not leave: parts, locks, the run's own records.
pub(crate) fn leftovers(root: &Path) -> Vec<String> {
    let is_leftover = |name: &String| {
        name.ends_with(".part")
            || name.ends_with(".lock")
            || name.starts_with("run.")
            || name.starts_with("journal.")
    };
    files_under(root).into_keys().filter(is_leftover).collect()
}

/// The manifest as it stands.
pub(crate) fn manifest(root: &Path) -> Value {
    json(&root.join("manifest.json"))
}

/// The report as it stands.
pub(crate) fn report(root: &Path) -> Value {
    json(&root.join("report.json"))
}

fn json(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).expect("JSON")
}

/// The arrays of a keyframe of a run with `--evidence`, checked against the manifest's grid.
pub(crate) fn read_arrays(root: &Path, scene: &str, token: &str) -> Arrays {
    let manifest = Manifest::load(&root.join("manifest.json")).expect("readable").expect("there");
    let spec = manifest.grid.spec().expect("a grid");
    let tree = LabelTree::new(root);
    let labels = tree.place(&TreePath::labels(scene, token).expect("a path"));
    let evidence = tree.place(&TreePath::evidence(scene, token).expect("a path"));
    Arrays {
        labels: read_labels(&labels, &spec).expect("labels"),
        evidence: read_evidence(&evidence, &spec).expect("evidence"),
    }
}
