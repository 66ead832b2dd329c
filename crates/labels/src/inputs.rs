//! Fingerprint of what a run reads.

use std::fs;
use std::path::Path;
use std::time::UNIX_EPOCH;

use occlabel_core::Fault;
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
        Ok(Self { path, bytes, mark: InputMark::Blake3(blake3) })
    }

    /// The record of a sweep, which is not read.
    ///
    /// # Errors
    /// If it is not there.
    pub fn of_sweep(root: &Path, path: impl Into<String>) -> Result<Self, Fault> {
        let path = path.into();
        let place = root.join(&path);
        let meta = fs::metadata(&place).and_then(|meta| Ok((meta.len(), meta.modified()?)));
        let (bytes, modified) = meta.map_err(|error| read_fault(&place, &error))?;
        let since = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
        Ok(Self { path, bytes, mark: InputMark::MtimeNs(since.as_nanos() as i64) })
    }
}

/// BLAKE3 over paths, lengths and hashes, in hexadecimal: the same for every copy of a log, because
/// no time goes in.
pub fn inputs_hash(inputs: &[InputRecord]) -> String {
    let mut inputs: Vec<_> = inputs.iter().collect();
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
        };
        let hash = inputs_hash(&[sweep("a", 1, 5), sweep("b", 2, 6)]);
        assert_eq!(hash, inputs_hash(&[sweep("b", 2, 9), sweep("a", 1, 8)]));
        assert_ne!(hash, inputs_hash(&[sweep("a", 1, 5), sweep("b", 3, 6)]));
    }
}
