//! What one needs to read a label tree without us.
//!
//! Nothing in it depends on when, where or with how many threads it was made: the same input,
//! configuration and version give the same bytes.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{Fault, GridSpec};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{FileRecord, InputHashes, PoseRecord, json, shards};

/// `manifest.json`: the arrays' grid, classes and tracks, and every file with its hash.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Who wrote the tree.
    pub program: Program,
    /// The preset's name; `None` where a configuration file was given.
    pub preset: Option<String>,
    /// All tables of the configuration as resolved: no `"auto"` is left.
    pub config: Value,
    /// [`json_hash`](crate::json_hash) of `config`.
    pub config_hash: String,
    /// Of all that was read: the [whole](InputHashes::whole) of `input_hashes`.
    pub inputs_hash: String,
    /// Of the parts of it.
    #[serde(default)]
    pub input_hashes: InputHashes,
    /// Which raw name means which class.
    pub taxonomy: TaxonomyRecord,
    /// The dialect of the files; none of our own layout, which is that of Occ3D-nuScenes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dialect: Option<String>,
    /// What the arrays cannot say, and what was lost on the way to them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// The grid of every array.
    pub grid: GridRecord,
    /// The classes in order of their ids.
    pub classes: Vec<ClassRecord>,
    /// The id in `semantics` where a voxel is not occupied.
    pub free: u16,
    /// The scenes by name.
    pub scenes: BTreeMap<String, SceneRecord>,
    /// Every file of the tree but this one and the report, in order of their paths.
    pub files: Vec<FileRecord>,
}

/// A program and its version.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
}

/// A taxonomy by name and by what it says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaxonomyRecord {
    /// The shipped taxonomy's name, or the file's.
    pub name: String,
    /// BLAKE3 of it, in hexadecimal.
    pub hash: String,
}

/// The grid of every array.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridRecord {
    /// `ego` or `lidar`: the reference sweep's own pose.
    pub frame: String,
    /// `xyz`: the order of the arrays' indices, C order, index 0 at `min_m`.
    pub axes: String,
    /// Lower corner, metres.
    pub min_m: [f64; 3],
    /// Upper corner, metres.
    pub max_m: [f64; 3],
    /// Voxel size along each axis, metres.
    pub voxel_size_m: [f64; 3],
    /// Voxels along each axis.
    pub shape: [usize; 3],
}

/// A class by its id.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClassRecord {
    /// Its value in `semantics`.
    pub id: u16,
    /// Its name.
    pub name: String,
}

/// What the arrays of a scene refer to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// Channel names: bit i of `camera_bits` is the i-th.
    pub cameras: Vec<String>,
    /// Tracks in order of their indices.
    pub tracks: Vec<TrackRecord>,
    /// Tokens of the labelled keyframes, in order of time.
    pub keyframes: Vec<String>,
    /// Where the ego and the reference lidar stood at each keyframe of the scene, in order of time,
    /// labelled or not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<PoseRecord>,
    /// Of a simulated log: the hash of the world that the scene was driven in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<String>,
}

/// A track of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrackRecord {
    /// Its value in `instances`, from 1.
    pub index: u16,
    /// The log's own id of it.
    pub id: String,
    /// Its class's name; `None` if its category is ignored.
    pub class: Option<String>,
    /// The log's own category of it.
    pub category: String,
}

impl Manifest {
    /// Reads a `manifest.json`; `None` if there is none.
    ///
    /// # Errors
    /// If it cannot be read, is no manifest, or lists a path that could lead out of the tree.
    pub fn load(path: &Path) -> Result<Option<Self>, Fault> {
        json::read(path)
    }

    /// Reads the manifest of a tree, or those of all shards of the run that wrote it, put together;
    /// `None` if there is none.
    ///
    /// # Errors
    /// As for [`Manifest::load`]; if a shard's is absent, or is of another run.
    pub fn load_tree(root: &Path) -> Result<Option<Self>, Fault> {
        match Self::load(&root.join("manifest.json"))? {
            Some(manifest) => Ok(Some(manifest)),
            None => shards::load(root),
        }
    }

    /// The file's bytes.
    pub fn to_json(&self) -> Vec<u8> {
        json::pretty(self)
    }
}

impl Program {
    /// This program, in this version.
    pub fn current() -> Self {
        Self { name: "occlabel".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() }
    }
}

impl GridRecord {
    /// The record of a grid in a frame.
    pub fn new(frame: impl Into<String>, spec: &GridSpec) -> Self {
        Self {
            frame: frame.into(),
            axes: "xyz".to_owned(),
            min_m: spec.min_m().into(),
            max_m: spec.max_m().into(),
            voxel_size_m: spec.size_m().into(),
            shape: spec.shape(),
        }
    }

    /// The grid itself.
    ///
    /// # Errors
    /// If the limits and sizes make no grid, or one of another shape than the record says.
    pub fn spec(&self) -> Result<GridSpec, Fault> {
        let spec = GridSpec::new(self.min_m, self.max_m, self.voxel_size_m)?;
        if spec.shape() == self.shape {
            return Ok(spec);
        }
        let (expected, found) = (format!("shape {:?}", spec.shape()), format!("{:?}", self.shape));
        Err(Fault::new("grid", "manifest.json", expected, found).record("grid"))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::npz::tests::spec;
    use crate::{TreePath, json_hash};
    use proptest::prelude::*;
    use serde_json::json;

    pub(crate) fn manifest() -> Manifest {
        let config = json!({"raycast": {"outside": "clip"}, "states": {"occupied_min_hits": 1}});
        let keyframes = vec!["k1".to_owned(), "k2".to_owned()];
        Manifest {
            program: Program::current(),
            preset: Some("precise".to_owned()),
            config_hash: json_hash(&config),
            config,
            inputs_hash: "00".to_owned(),
            input_hashes: InputHashes::default(),
            taxonomy: TaxonomyRecord { name: "occ3d-nuscenes".to_owned(), hash: "11".to_owned() },
            dialect: None,
            notes: Vec::new(),
            grid: GridRecord::new("ego", &spec()),
            classes: vec![ClassRecord { id: 0, name: "others".to_owned() }],
            free: 17,
            scenes: [("s".to_owned(), SceneRecord { keyframes, ..Default::default() })].into(),
            files: Vec::new(),
        }
    }

    #[test]
    fn section_11_the_fields_are_those_of_the_contract() {
        let value = serde_json::to_value(manifest()).unwrap();
        let mut keys: Vec<_> = value.as_object().unwrap().keys().cloned().collect();
        let mut expected = [
            "program",
            "preset",
            "config",
            "config_hash",
            "inputs_hash",
            "input_hashes",
            "taxonomy",
            "grid",
            "classes",
            "free",
            "scenes",
            "files",
        ];
        keys.sort();
        expected.sort_unstable();
        assert_eq!(keys, expected);
        assert_eq!(value["grid"]["axes"], "xyz");
        assert_eq!(value["grid"]["shape"], json!([5, 4, 3]));
        assert_eq!(value["grid"]["voxel_size_m"], json!([1.0, 1.0, 1.0]));
        assert_eq!(value["scenes"]["s"]["keyframes"], json!(["k1", "k2"]));
        let own = Manifest { preset: None, ..manifest() };
        assert!(serde_json::to_value(own).unwrap()["preset"].is_null());
    }

    #[test]
    fn section_12_the_file_is_pretty_and_the_same_each_time() {
        let text = String::from_utf8(manifest().to_json()).unwrap();
        assert!(text.starts_with("{\n  \"program\": {\n    \"name\": \"occlabel\""), "{text}");
        assert!(text.ends_with("}\n"));
        assert_eq!(text.as_bytes(), manifest().to_json());
    }

    #[test]
    fn a_grid_that_contradicts_itself_is_refused() {
        assert_eq!(manifest().grid.spec().unwrap(), spec());
        let wrong = GridRecord { shape: [5, 4, 2], ..manifest().grid };
        assert!(wrong.spec().unwrap_err().to_string().contains("[5, 4, 3]"));
    }

    #[test]
    fn fault_36_a_manifest_that_lists_a_path_outside_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("manifest.json");
        let mut value = serde_json::to_value(manifest()).unwrap();
        value["files"] = json!([{"path": "../../etc/passwd", "bytes": 1, "blake3": ""}]);
        std::fs::write(&path, value.to_string()).unwrap();
        let text = Manifest::load(&path).unwrap_err().to_string();
        assert!(text.contains("manifest.json") && text.contains("../../etc/passwd"), "{text}");
    }

    prop_compose! {
        fn track()(index in 1..u16::MAX, id in ".*", class in proptest::option::of("[a-z ]+"),
                   category in ".*") -> TrackRecord {
            TrackRecord { index, id, class, category }
        }
    }

    prop_compose! {
        fn scene()(cameras in prop::collection::vec(".*", 0..4),
                   tracks in prop::collection::vec(track(), 0..4),
                   keyframes in prop::collection::vec("[a-f0-9]{4}", 0..4),
                   world in proptest::option::of("[a-f0-9]{4}")) -> SceneRecord {
            SceneRecord { cameras, tracks, keyframes, poses: Vec::new(), world }
        }
    }

    prop_compose! {
        fn file()(path in "[a-z]{1,3}(/[a-z0-9][a-z0-9._-]{0,4}){0,3}", bytes in any::<u64>(),
                  blake3 in "[0-9a-f]{8}") -> FileRecord {
            FileRecord { path: TreePath::new(path).unwrap(), bytes, blake3, keyframe: None }
        }
    }

    prop_compose! {
        fn any_manifest()(size in prop::array::uniform3(1e-3..10.0_f64), free in any::<u16>(),
                          scenes in prop::collection::btree_map(".*", scene(), 0..3),
                          files in prop::collection::vec(file(), 0..5),
                          number in -1e9..1e9_f64) -> Manifest {
            let grid = GridRecord { voxel_size_m: size, ..manifest().grid };
            Manifest { grid, free, scenes, files, config: json!({"a": number}), ..manifest() }
        }
    }

    proptest! {
        #[test]
        fn section_11_a_manifest_survives_its_file(manifest in any_manifest()) {
            let read: Manifest = serde_json::from_slice(&manifest.to_json()).unwrap();
            prop_assert_eq!(read.to_json(), manifest.to_json());
            prop_assert_eq!(read, manifest);
        }
    }
}
