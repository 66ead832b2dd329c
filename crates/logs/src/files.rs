//! Files of a log, and names that may be trusted as theirs.

use std::io::{self, Read};
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk::{self as disk, File};

/// A file of points, labels or pixels longer than this is refused.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Opens a regular file, through symbolic links too; `place` names it in faults.
///
/// # Errors
/// If it is absent (`missing-file`), or cannot be opened.
pub(crate) fn open_file(path: &Path, place: &str) -> Result<File, Fault> {
    let metadata = disk::metadata(path).map_err(|error| unreadable(place, &error))?;
    if !metadata.is_file() {
        return Err(Fault::new("unreadable-file", place, "a file", "something else"));
    }
    disk::open(path).map_err(|error| unreadable(place, &error))
}

/// The bytes of a file of the log, at most 1 GiB.
///
/// # Errors
/// If it is absent (`missing-file`), longer, or cannot be read.
pub(crate) fn read_file(root: &Path, name: &str) -> Result<Vec<u8>, Fault> {
    let file = open_file(&root.join(name), name)?;
    check_size(name, file.size_bytes().map_err(|error| unreadable(name, &error))?)?;
    let mut bytes = Vec::new();
    // It may grow meanwhile.
    let read = file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| unreadable(name, &error))?;
    check_size(name, bytes.len() as u64)?;
    Ok(bytes)
}

fn check_size(name: &str, bytes: u64) -> Result<(), Fault> {
    if bytes <= MAX_FILE_BYTES {
        return Ok(());
    }
    let (expected, found) = (format!("at most {MAX_FILE_BYTES} bytes"), format!("{bytes} bytes"));
    Err(Fault::new("file-size", name, expected, found))
}

/// Whether all these files are there.
///
/// # Errors
/// One that names all that are not (`missing-file`).
pub(crate) fn check_present(root: &Path, names: &[String]) -> Result<(), Fault> {
    let absent = names.iter().filter(|name| !disk::exists(&root.join(name)));
    let absent: Vec<&str> = absent.map(String::as_str).collect();
    match absent.len() {
        0 => Ok(()),
        1 => Err(Fault::new("missing-file", absent[0], "a file", "none")),
        _ => Err(Fault::new("missing-file", absent.join(", "), "these files", "none of them")),
    }
}

/// A file's size in bytes; 0 if it cannot be looked at.
pub(crate) fn file_bytes(root: &Path, name: &str) -> u64 {
    disk::metadata(&root.join(name)).map_or(0, |metadata| metadata.bytes())
}

/// What an error of the file system says about a file.
pub(crate) fn unreadable(place: &str, error: &io::Error) -> Fault {
    match error.kind() {
        io::ErrorKind::NotFound => Fault::new("missing-file", place, "a file", "none"),
        _ => Fault::new("unreadable-file", place, "a readable file", error.to_string()),
    }
}

/// What is wrong with a file's name in a table, if anything: it has to stay below the log's root on
/// every system, and off the terminal.
pub(crate) fn name_defect(name: &str) -> Option<&'static str> {
    let drive = name.as_bytes().get(1) == Some(&b':');
    if name.is_empty() {
        Some("no name")
    } else if name.chars().any(char::is_control) {
        Some("control characters")
    } else if name.contains('\\') || drive || name.starts_with('/') {
        Some("an absolute path, a drive or a backslash")
    } else if name.split('/').any(|part| part == "..") {
        Some("a way out of the folder")
    } else {
        None
    }
}

/// Longer names are too long for some file systems, together with those of files that are being written.
const MAX_NAME_BYTES: usize = 200;

/// Whether a name can be that of an output folder: of A-Z, a-z, 0-9, `.`, `_`, `-` only, not hidden, and
/// not too long.
pub(crate) fn is_folder_name(name: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"._-".contains(&byte);
    let is_of_length = (1..=MAX_NAME_BYTES).contains(&name.len());
    is_of_length && !name.starts_with('.') && name.bytes().all(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    #[test]
    fn fault_36_file_names_stay_below_the_root() {
        for name in ["samples/LIDAR_TOP/a.pcd.bin", "a", "./a..b/..c", "a/.../b", "été/x y.bin"] {
            assert_eq!(name_defect(name), None, "{name}");
        }
        for name in [
            "",
            "/etc/passwd",
            "../a",
            "a/..",
            "a/../b",
            "C:\\a",
            "c:a",
            "a\\b",
            "\\\\host\\a",
            "a\0b",
            "a\u{1b}[31m",
            "a\nb",
        ] {
            assert!(name_defect(name).is_some(), "{name:?}");
        }
    }

    /// A file without blocks: reading it up to the bound would take a GiB.
    #[test]
    fn fault_34_files_that_are_too_long_are_refused_by_their_size() {
        let folder = tempfile::tempdir().unwrap();
        let file = File::create(folder.path().join("a.bin")).unwrap();
        file.set_len(1 << 40).unwrap();
        let fault = read_file(folder.path(), "a.bin").unwrap_err();
        assert_eq!((fault.rule, fault.found.as_str()), ("file-size", "1099511627776 bytes"));
    }

    #[test]
    fn fault_36_folder_names_are_plain() {
        assert!(["scene-0061", "a.b_c", "_"].into_iter().all(is_folder_name));
        assert!(is_folder_name(&"n".repeat(200)) && !is_folder_name(&"n".repeat(201)));
        assert!(
            !["", ".", "..", ".a", "a/b", "a b", "é", "a\n", "a\0"].into_iter().any(is_folder_name)
        );
    }
}
