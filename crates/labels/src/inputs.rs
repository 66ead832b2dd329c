//! Fingerprint of what a run reads.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::UNIX_EPOCH;

use occlabel_core::Fault;
use occlabel_disk as disk;
use serde::{Deserialize, Serialize};

use crate::files::{hash_file, read_fault};

/// An input file: a table by its hash, a sweep (there are many, and they are large) by its time.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InputRecord {
    /// Its path relative to the log's root, with `/`.
    pub path: String,
    /// Its length.
    pub bytes: u64,
    /// What changes when the file does.
    #[serde(flatten)]
    pub mark: InputMark,
    /// The scene that it belongs to; none of what all scenes share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
}

/// What changes when a file does.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputMark {
    /// BLAKE3 of the bytes, in hexadecimal.
    Blake3(String),
    /// Time of the last modification, nanoseconds since 1970.
    MtimeNs(i64),
}

impl InputRecord {
    /// The record of a table, read and hashed.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of_table(root: &Path, path: impl Into<String>) -> Result<Self, Fault> {
        let path = path.into();
        let (bytes, blake3) = hash_file(&root.join(&path))?;
        Ok(Self { path, bytes, mark: InputMark::Blake3(blake3), scene: None })
    }

    /// The record of a sweep, which is not read.
    ///
    /// # Errors
    /// If it is not there.
    pub fn of_sweep(root: &Path, path: impl Into<String>) -> Result<Self, Fault> {
        let path = path.into();
        let place = root.join(&path);
        let meta = disk::metadata(&place).and_then(|meta| Ok((meta.bytes(), meta.modified()?)));
        let (bytes, modified) = meta.map_err(|error| read_fault(&place, &error))?;
        let since = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
        Ok(Self { path, bytes, mark: InputMark::MtimeNs(since.as_nanos() as i64), scene: None })
    }

    /// The same as a file of this scene alone.
    pub fn of_scene(mut self, scene: &str) -> Self {
        self.scene = Some(scene.to_owned());
        self
    }
}

/// Hashes of what a run reads, which those of its shards make up: the same for every copy of a log,
/// because no time goes in.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputHashes {
    /// Of what all scenes share.
    pub shared: String,
    /// Of each scene's own files.
    pub scenes: BTreeMap<String, String>,
}

impl InputHashes {
    /// The hashes of these inputs, BLAKE3 over paths, lengths and hashes, in hexadecimal.
    pub fn of(inputs: &[InputRecord]) -> Self {
        let mut by_scene: BTreeMap<Option<&String>, Vec<&InputRecord>> = BTreeMap::new();
        for input in inputs {
            by_scene.entry(input.scene.as_ref()).or_default().push(input);
        }
        let shared = hash(by_scene.remove(&None).unwrap_or_default());
        let of_scene = |(scene, inputs): (Option<&String>, _)| Some((scene?.clone(), hash(inputs)));
        Self { shared, scenes: by_scene.into_iter().filter_map(of_scene).collect() }
    }

    /// One hash of them all.
    pub fn whole(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.shared.as_bytes());
        for (scene, hash) in &self.scenes {
            hasher.update(format!("\n{scene}\0{hash}").as_bytes());
        }
        hasher.finalize().to_hex().to_string()
    }
}

fn hash(mut inputs: Vec<&InputRecord>) -> String {
    inputs.sort();
    let mut hasher = blake3::Hasher::new();
    for input in inputs {
        let hash = match &input.mark {
            InputMark::Blake3(hash) => hash,
            InputMark::MtimeNs(_) => "-",
        };
        hasher.update(format!("{}\0{}\0{hash}\n", input.path, input.bytes).as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    #[test]
    fn tables_are_hashed_and_sweeps_are_timed() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.json"), b"[]").unwrap();
        let table = InputRecord::of_table(folder.path(), "scene.json").unwrap();
        let hash = blake3::hash(b"[]").to_hex().to_string();
        let expected = json!({"path": "scene.json", "bytes": 2, "blake3": hash});
        assert_eq!(serde_json::to_value(&table).unwrap(), expected);

        let sweep = InputRecord::of_sweep(folder.path(), "scene.json").unwrap();
        assert!(matches!(sweep.mark, InputMark::MtimeNs(time) if time > 1_600_000_000_000_000_000));
        let again = serde_json::from_value(serde_json::to_value(&sweep).unwrap()).unwrap();
        assert_eq!(sweep, again);
        assert!(InputRecord::of_sweep(folder.path(), "absent.bin").is_err());
    }

    #[test]
    fn section_12_the_hash_knows_no_times_and_no_order() {
        let sweep = |path: &str, bytes, time| InputRecord {
            path: path.to_owned(),
            bytes,
            mark: InputMark::MtimeNs(time),
            scene: None,
        };
        let hash = |inputs: &[InputRecord]| InputHashes::of(inputs).whole();
        let told = hash(&[sweep("a", 1, 5), sweep("b", 2, 6)]);
        assert_eq!(told, hash(&[sweep("b", 2, 9), sweep("a", 1, 8)]));
        assert_ne!(told, hash(&[sweep("a", 1, 5), sweep("b", 3, 6)]));
        assert_ne!(told, hash(&[sweep("a", 1, 5), sweep("b", 2, 6).of_scene("s")]));
    }

    #[test]
    fn the_hashes_of_shards_make_up_that_of_the_whole() {
        let folder = tempfile::tempdir().unwrap();
        ["table", "a", "b"]
            .iter()
            .for_each(|name| fs::write(folder.path().join(name), name).unwrap());
        let table = InputRecord::of_table(folder.path(), "table").unwrap();
        let sweep = |name: &str| InputRecord::of_sweep(folder.path(), name).unwrap().of_scene(name);
        let mut merged = InputHashes::of(&[table.clone(), sweep("a")]);
        let other = InputHashes::of(&[sweep("b"), table.clone()]);
        assert_eq!(merged.shared, other.shared);
        merged.scenes.extend(other.scenes);
        let whole = InputHashes::of(&[table, sweep("a"), sweep("b")]);
        assert_eq!((merged.whole(), &merged), (whole.whole(), &whole));
    }
}
