//! Whether the output folder may be written to.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_labels::{InputHashes, Manifest, RunFiles, RunRecord};

/// Refuses a folder that holds anything but what this very command wrote.
pub(crate) fn check(files: &RunFiles, record: &RunRecord) -> Result<(), Fault> {
    let root = files.tree().root();
    if is_empty(root) || begun_before(files, record) || ended_before(files, record)? {
        return Ok(());
    }
    let expected = "an empty folder, or what the same command wrote from the same labels";
    Err(Fault::new("output", root.display().to_string(), expected, "other files"))
}

/// Whether there is nothing, or nothing but the lock of a run that never began.
fn is_empty(root: &Path) -> bool {
    let Ok(entries) = fs::read_dir(root) else { return !root.exists() };
    entries.flatten().all(|entry| entry.file_name() == ".run.lock")
}

fn begun_before(files: &RunFiles, record: &RunRecord) -> bool {
    let earlier = File::open(files.run()).map(BufReader::new);
    let earlier = earlier.ok().and_then(|file| serde_json::from_reader(file).ok());
    earlier.is_some_and(|earlier: RunRecord| earlier == *record)
}

fn ended_before(files: &RunFiles, record: &RunRecord) -> Result<bool, Fault> {
    let Some(manifest) = Manifest::load(&files.manifest())? else { return Ok(false) };
    Ok(manifest.program == record.program
        && manifest.config == record.config
        && manifest.inputs_hash == InputHashes::of(&record.inputs).whole())
}
