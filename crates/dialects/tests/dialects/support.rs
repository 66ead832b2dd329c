//! Small label sets on disk.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{GridSpec, VoxelGrid};
use occlabel_dialects::{Dialect, Encoded, KeyframeLabels};
use occlabel_labels::{GridRecord, InputHashes, Manifest, Program, SceneRecord, TaxonomyRecord};

/// A grid with three different sides, so that no two axes can be mixed up unseen.
pub(crate) fn spec() -> GridSpec {
    GridSpec::new([0.0; 3], [4.0, 3.0, 2.0], [1.0; 3]).unwrap()
}

pub(crate) fn dialect(name: &str) -> Dialect {
    Dialect::named(name).unwrap()
}

/// Labels that are free everywhere, and say nothing else.
pub(crate) fn free(dialect: &Dialect, spec: &GridSpec) -> KeyframeLabels {
    let free = VoxelGrid::filled(spec, dialect.classes.free_index());
    KeyframeLabels::of_semantics(spec.clone(), free)
}

/// Writes a keyframe's files, and gives back what was written.
pub(crate) fn write(
    root: &Path,
    dialect: &Dialect,
    labels: &KeyframeLabels,
    scene: &str,
    token: &str,
) -> Encoded {
    let encoded = dialect.encode(labels, scene, token).unwrap();
    for (path, bytes) in &encoded.files {
        put(root, path.as_str(), bytes);
    }
    encoded
}

/// Writes a file and its folders, without waiting for the disk.
pub(crate) fn put(root: &Path, file: &str, bytes: &[u8]) {
    let place = root.join(file);
    std::fs::create_dir_all(place.parent().unwrap()).unwrap();
    std::fs::write(place, bytes).unwrap();
}

/// A manifest of one scene of one keyframe.
pub(crate) fn manifest(spec: &GridSpec, dialect: Option<&str>) -> Manifest {
    let keyframes = vec!["k".to_owned()];
    let scene = SceneRecord { keyframes, ..SceneRecord::default() };
    let name = |id: u16| ["car", "road"][usize::from(id)].to_owned();
    Manifest {
        program: Program::current(),
        preset: None,
        config: serde_json::json!({}),
        config_hash: String::new(),
        inputs_hash: String::new(),
        input_hashes: InputHashes::default(),
        taxonomy: TaxonomyRecord { name: "own".to_owned(), hash: String::new() },
        dialect: dialect.map(str::to_owned),
        notes: Vec::new(),
        grid: GridRecord::new("lidar", spec),
        classes: [0, 1].map(|id| occlabel_labels::ClassRecord { id, name: name(id) }).to_vec(),
        free: 9,
        scenes: BTreeMap::from([("s".to_owned(), scene)]),
        files: Vec::new(),
    }
}

pub(crate) fn write_manifest(root: &Path, manifest: &Manifest) {
    std::fs::write(root.join("manifest.json"), manifest.to_json()).unwrap();
}
