//! JSON on disk: pretty, the same bytes each time, and bounded when read.

use std::io::{ErrorKind, Read};
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::files::read_fault;

/// The largest JSON file that is read: a manifest of a million keyframes has about 300 MB.
const MAX_BYTES: u64 = 1 << 30;

/// BLAKE3 of a value's shortest JSON, in hexadecimal: the hash of a configuration or a taxonomy.
///
/// # Panics
/// If the value has no JSON form, such as a map with keys that are no strings.
pub fn json_hash(value: &impl Serialize) -> String {
    let json = serde_json::to_vec(value).expect("a value with a JSON form");
    blake3::hash(&json).to_hex().to_string()
}

/// The value as a JSON file: two spaces an indent, one newline at the end.
///
/// # Panics
/// If the value has no JSON form.
pub fn pretty(value: &impl Serialize) -> Vec<u8> {
    let mut json = serde_json::to_vec_pretty(value).expect("a value with a JSON form");
    json.push(b'\n');
    json
}

/// A JSON file that has to be there, read back.
///
/// # Errors
/// If it is absent, cannot be read, or is no such JSON.
pub fn read_file<T: DeserializeOwned>(path: &Path) -> Result<T, Fault> {
    let absent = || read_fault(path, &ErrorKind::NotFound.into());
    read(path)?.ok_or_else(absent)
}

/// A JSON file read back; `None` if there is none.
///
/// # Errors
/// If it cannot be read, or is no such JSON.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, Fault> {
    let Some(bytes) = read_bounded(path)? else { return Ok(None) };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| {
        Fault::new(
            "json",
            path.display().to_string(),
            "a file as occlabel writes it",
            error.to_string(),
        )
        .hint("mend it, take it away, or name another folder")
    })
}

/// A file's bytes; `None` if there is none.
pub(crate) fn read_bounded(path: &Path) -> Result<Option<Vec<u8>>, Fault> {
    let mut bytes = Vec::new();
    match disk::open(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(read_fault(path, &error)),
        Ok(_) if bytes.len() as u64 > MAX_BYTES => {
            let expected = format!("at most {MAX_BYTES} bytes");
            Err(Fault::new("json-size", path.display().to_string(), expected, "more"))
        }
        Ok(_) => Ok(Some(bytes)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn a_file_that_is_absent_is_none_a_broken_one_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        assert_eq!(read::<Value>(&path).unwrap(), None);
        std::fs::write(&path, b"{\"torn\": ").unwrap();
        let fault = read::<Value>(&path).unwrap_err().to_string();
        assert!(fault.contains("a.json") && fault.contains("line 1"), "{fault}");
    }

    #[test]
    fn section_12_the_hash_does_not_depend_on_the_order_of_keys() {
        let one: Value = serde_json::from_str(r#"{"a": 0.4, "b": [1, "x"]}"#).unwrap();
        let two: Value = serde_json::from_str(r#"{"b": [1, "x"], "a": 0.4}"#).unwrap();
        assert_eq!(json_hash(&one), json_hash(&two));
        assert_ne!(json_hash(&one), json_hash(&json!({"a": 0.5, "b": [1, "x"]})));
    }
}
