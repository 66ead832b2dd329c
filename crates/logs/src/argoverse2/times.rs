//! Times that files are named by.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use occlabel_core::Fault;

use crate::files::unreadable;

/// The times of the files in a folder that end so, nanoseconds. None if the folder is absent.
///
/// # Errors
/// If it cannot be listed.
pub(super) fn file_times(
    root: &Path,
    folder: &str,
    endings: &[&str],
) -> Result<BTreeSet<i64>, Fault> {
    let entries = match fs::read_dir(root.join(folder)) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(BTreeSet::new()),
        Err(error) => return Err(unreadable(folder, &error)),
    };
    let mut times = BTreeSet::new();
    for entry in entries {
        let name = entry.map_err(|error| unreadable(folder, &error))?.file_name();
        let stem = |ending: &&str| name.to_str()?.strip_suffix(ending);
        let number = endings.iter().find_map(stem);
        let time = number.and_then(|number| number.parse::<i64>().ok());
        times.extend(time.filter(|time| number == Some(time.to_string().as_str())));
    }
    Ok(times)
}
