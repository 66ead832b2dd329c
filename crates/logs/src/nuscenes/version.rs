//! Which folder of a log holds its tables.

use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::files::{is_folder_name, unreadable};
use crate::names::quoted;

/// Version folders begin so.
const PREFIX: &str = "v1.0-";

/// The folder of the tables: the named one, else the only one called `v1.0-…`.
///
/// # Errors
/// If the root cannot be read, the named folder is not there, or none is named and there is not
/// exactly one.
pub(super) fn version_folder(root: &Path, version: Option<&str>) -> Result<PathBuf, Fault> {
    let place = root.to_string_lossy();
    let known = version_names(root)?;
    let list: Vec<&str> = known.iter().map(String::as_str).collect();
    let found = if list.is_empty() { "none".into() } else { quoted(&list) };
    match (version, list.as_slice()) {
        (Some(name), _) if is_folder_name(name) && disk::is_dir(&root.join(name)) => {
            Ok(root.join(name))
        }
        (Some(name), _) => {
            let expected = format!("a folder `{name}` with the tables");
            Err(Fault::new("version-folder", place, expected, found))
        }
        (None, [only]) => Ok(root.join(only)),
        (None, []) => {
            let expected = format!("a folder `{PREFIX}…` with the tables");
            Err(Fault::new("version-folder", place, expected, found))
        }
        (None, _) => {
            let fault = Fault::new("version-folder", place, "one version", found);
            Err(fault.hint("name one with `--version`"))
        }
    }
}

/// The tables of a version folder, relative to the log's root, sorted.
pub(super) fn table_files(root: &Path, folder: &Path) -> Result<Vec<String>, Fault> {
    let place = folder.to_string_lossy();
    let entries = disk::list(folder).map_err(|error| unreadable(&place, &error))?;
    let is_json = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "json");
    let is_table = |path: &PathBuf| is_json(path) && disk::is_file(path);
    let mut files: Vec<String> = entries
        .into_iter()
        .map(|entry| entry.path())
        .filter(is_table)
        .map(|path| path.strip_prefix(root).unwrap_or(&path).to_string_lossy().into_owned())
        .collect();
    files.sort_unstable();
    Ok(files)
}

/// Names of the version folders, sorted.
pub(super) fn version_names(root: &Path) -> Result<Vec<String>, Fault> {
    let place = root.to_string_lossy();
    let entries = disk::list(root).map_err(|error| unreadable(&place, &error))?;
    let mut names: Vec<String> = entries
        .into_iter()
        .filter(|entry| disk::is_dir(&entry.path()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| name.starts_with(PREFIX))
        .collect();
    names.sort_unstable();
    Ok(names)
}
