//! Times that files are named by.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::files::unreadable;

/// The files in a folder that end so, by their times, nanoseconds; of two of a time, the first by its
/// name. None if the folder is absent.
///
/// # Errors
/// If it cannot be listed.
pub(super) fn files_by_time(
    root: &Path,
    folder: &str,
    endings: &[&str],
) -> Result<BTreeMap<i64, String>, Fault> {
    let entries = match disk::list(&root.join(folder)) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(error) => return Err(unreadable(folder, &error)),
    };
    let mut times: BTreeMap<i64, String> = BTreeMap::new();
    for entry in entries {
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        let number = endings.iter().find_map(|ending| name.strip_suffix(ending));
        let time = number.and_then(|number| number.parse::<i64>().ok());
        if let Some(time) = time.filter(|time| number == Some(time.to_string().as_str())) {
            let file = format!("{folder}{name}");
            let first = times.remove(&time).map_or(file.clone(), |other| other.min(file));
            times.insert(time, first);
        }
    }
    Ok(times)
}
