//! Whether what is given is a path, or the URL of a store that can be talked to.

use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::exit::Stop;

/// Refuses a URL of no store, of one that this program cannot talk to, or whose variables in the
/// environment cannot be meant.
pub(crate) fn check_url(path: &Path) -> Result<(), Stop> {
    disk::check_url(path).map_err(|error| {
        let expected = "a path, or the URL of a store";
        Stop::usage(Fault::new("url", path.display().to_string(), expected, error.to_string()))
    })
}
