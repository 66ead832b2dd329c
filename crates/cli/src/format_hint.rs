//! What a wrong `--format` or `--input` was meant to be.

use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_logs::looks_like;

use crate::args::LogArgs;
use crate::format_flags::name;

/// Rules of faults that a folder of another format breaks.
const LAYOUTS: [&str; 8] = [
    "version-folder",
    "waymo-layout",
    "semantickitti-layout",
    "mcap-files",
    "cloud-layout",
    "av2-layout",
    "av2",
    "coda-layout",
];

/// The fault with the format that the folder looks like, if it breaks the layout of the one given.
pub(crate) fn with_format(fault: Fault, log: &LogArgs) -> Fault {
    if !LAYOUTS.contains(&fault.rule) {
        return fault;
    }
    match looks_like(&log.input) {
        Some(other) if other != name(log.format) => {
            fault.hint(format!("it looks like `--format {other}`"))
        }
        _ => fault,
    }
}

/// Refuses an input that is no folder.
pub(crate) fn check_input(input: &Path) -> Result<(), Fault> {
    if disk::is_dir(input) {
        return Ok(());
    }
    let fault =
        |found| Fault::new("input", input.display().to_string(), "a log's root folder", found);
    if !disk::is_file(input) {
        return Err(fault(if disk::exists(input) { "something else" } else { "nothing" }));
    }
    let folder = input.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).display();
    Err(fault("a file").hint(format!("give its folder: `--input {folder}`")))
}
