//! Whether the output folder may be written to.

use std::io::{self, ErrorKind};
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::{InputHashes, Manifest, RunFiles, RunRecord};

/// Refuses a folder that holds anything but what this very command wrote.
pub(crate) fn check(files: &RunFiles, record: &RunRecord) -> Result<(), Fault> {
    let root = files.tree().root();
    if is_empty(root)? || begun_before(files, record)? || ended_before(files, record)? {
        return Ok(());
    }
    let expected = "an empty folder, or what the same command wrote from the same labels";
    Err(Fault::new("output", root.display().to_string(), expected, "other files"))
}

/// Whether there is nothing, or nothing but what a run that never began left: its lock, and parts of this
/// and of its record.
fn is_empty(root: &Path) -> Result<bool, Fault> {
    match disk::list(root) {
        Ok(entries) => Ok(entries.iter().all(is_of_beginning)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(true),
        Err(error) if error.kind() == ErrorKind::NotADirectory => Ok(false),
        Err(error) => Err(unreadable(root, &error)),
    }
}

fn is_of_beginning(entry: &disk::Entry) -> bool {
    let name = entry.file_name();
    let name = name.to_string_lossy();
    name.starts_with(".run.") || name.starts_with("..run.")
}

fn begun_before(files: &RunFiles, record: &RunRecord) -> Result<bool, Fault> {
    let path = files.run();
    let text = match disk::read(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        text => text.map_err(|error| unreadable(&path, &error))?,
    };
    Ok(serde_json::from_slice(&text).is_ok_and(|earlier: RunRecord| earlier == *record))
}

fn unreadable(path: &Path, error: &io::Error) -> Fault {
    Fault::new("read", path.display().to_string(), "to read what is there", error.to_string())
}

fn ended_before(files: &RunFiles, record: &RunRecord) -> Result<bool, Fault> {
    let Some(manifest) = Manifest::load(&files.manifest())? else { return Ok(false) };
    Ok(manifest.program == record.program
        && manifest.config == record.config
        && manifest.inputs_hash == InputHashes::of(&record.inputs).whole())
}
