//! The sequences of a folder, and the names of their files.

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::{Fault, SweepHeader};
use occlabel_disk as disk;

use crate::files::unreadable;

/// The folder of all sequences.
const SEQUENCES: &str = "sequences";
/// The folder of a sequence's points.
const SCANS: &str = "velodyne/";

/// One sequence: a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sequence {
    /// The name of its folder.
    pub(super) name: String,
    /// Its folder below the log's root, with a `/` at the end, or nothing.
    folder: String,
}

impl Sequence {
    /// The lidar's mounting.
    pub(super) fn calib(&self) -> String {
        format!("{}calib.txt", self.folder)
    }

    /// The camera's poses.
    pub(super) fn poses(&self) -> String {
        format!("{}poses.txt", self.folder)
    }

    /// The scans' times.
    pub(super) fn times(&self) -> String {
        format!("{}times.txt", self.folder)
    }

    /// The points of a scan.
    pub(super) fn scan(&self, number: usize) -> String {
        format!("{}{SCANS}{number:06}.bin", self.folder)
    }

    /// All files that are no scan's.
    pub(super) fn tables(&self) -> [String; 3] {
        [self.calib(), self.poses(), self.times()]
    }

    /// The numbers of the scans that are there.
    ///
    /// # Errors
    /// If their folder is absent or cannot be read.
    pub(super) fn scans(&self, root: &Path) -> Result<BTreeSet<usize>, Fault> {
        let folder = format!("{}{SCANS}", self.folder);
        let number = |name: String| {
            let number = name.strip_suffix(".bin")?.parse().ok()?;
            (format!("{number:06}.bin") == name).then_some(number)
        };
        Ok(entries(&root.join(&folder), &folder)?.into_iter().filter_map(number).collect())
    }
}

/// The file of a sweep's labels.
pub(super) fn label_file(sweep: &SweepHeader) -> Option<String> {
    let (folder, scan) = sweep.file.strip_suffix(".bin")?.rsplit_once(SCANS)?;
    Some(format!("{folder}labels/{scan}.label"))
}

/// The sequences below a folder, in byte order of their names; or the folder itself, if it is one.
///
/// # Errors
/// If there is none.
pub(super) fn sequences(root: &Path) -> Result<Vec<Sequence>, Fault> {
    let has_scans = |folder: &Path| disk::is_dir(&folder.join(SCANS));
    let mut found = Vec::new();
    if disk::is_dir(&root.join(SEQUENCES)) {
        let mut names = entries(&root.join(SEQUENCES), SEQUENCES)?;
        names.sort_unstable();
        names.retain(|name| has_scans(&root.join(SEQUENCES).join(name)));
        let sequence = |name| Sequence { folder: format!("{SEQUENCES}/{name}/"), name };
        found.extend(names.into_iter().map(sequence));
    } else if has_scans(root) {
        found.push(Sequence { name: own_name(root)?, folder: String::new() });
    }
    if found.is_empty() {
        let expected = "sequences/<name>/velodyne, or velodyne of one sequence";
        let place = root.display().to_string();
        return Err(Fault::new("semantickitti-layout", place, expected, "neither"));
    }
    Ok(found)
}

/// The name of a folder, however it is written.
fn own_name(folder: &Path) -> Result<String, Fault> {
    let place = folder.display().to_string();
    let full = disk::canonicalize(folder).map_err(|error| unreadable(&place, &error))?;
    Ok(full.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()))
}

/// The names in a folder. One that is no UTF-8 is left out.
fn entries(folder: &Path, place: &str) -> Result<Vec<String>, Fault> {
    let listed = disk::list(folder).map_err(|error| unreadable(place, &error))?;
    Ok(listed.into_iter().filter_map(|entry| entry.file_name().into_string().ok()).collect())
}
