//! Every operation on the files of logs and of label trees, one at a time, so that a test can have any
//! of them fail.
//!
//! A disk fails anywhere: a folder cannot be listed, a file ends in an error halfway, there is no room
//! for the name of what was written. What the program promises then (`docs/reliability.md`) is only
//! known once each of these was tried; so readers and writers alike go through here. Built without the
//! feature `faults`, a [`File`] is the one of [`std::fs`], and each function its namesake there.
//!
//! A file may be asked for that need not be there. [`is_file`], [`is_dir`] and [`exists`] call absent
//! what is known to be absent: what cannot be looked at counts as there, and opening it tells why. So a
//! disk that fails never passes for a log without labels.
//!
//! ```
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("a.txt");
//! assert!(!occlabel_disk::is_file(&path));
//! std::fs::write(&path, "text")?;
//! assert_eq!(occlabel_disk::read_to_string(&path)?, "text");
//! # Ok::<(), std::io::Error>(())
//! ```

#[cfg(feature = "faults")]
mod failing_file;
#[cfg(feature = "faults")]
mod faults;
mod operations;
mod part;
#[cfg(not(feature = "faults"))]
mod plain_file;

#[cfg(feature = "faults")]
use failing_file::from_std;
#[cfg(feature = "faults")]
pub use failing_file::{File, into_std};
#[cfg(feature = "faults")]
use faults::before;
pub use operations::{
    canonicalize, create_dir, exists, is_dir, is_file, list, metadata, open, open_by, read,
    read_to_string, remove_dir, remove_file, symlink_metadata, sync,
};
pub use part::Part;
#[cfg(not(feature = "faults"))]
pub use plain_file::{File, into_std};
#[cfg(not(feature = "faults"))]
use plain_file::{before, from_std};

/// What can fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "faults"), expect(dead_code, reason = "Read and Write cannot fail then"))]
enum Operation {
    Open,
    Look,
    List,
    Read,
    Create,
    Write,
    Sync,
    Rename,
    CreateFolder,
    Remove,
    RemoveFolder,
}
