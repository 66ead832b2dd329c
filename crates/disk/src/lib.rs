//! Every operation on the files of logs and of label trees, one at a time: on a disk, or in a store of
//! objects; and so that a test can have any of them fail.
//!
//! A disk fails anywhere: a folder cannot be listed, a file ends in an error halfway, there is no room
//! for the name of what was written. What the program promises then (`docs/reliability.md`) is only
//! known once each of these was tried; so readers and writers alike go through here.
//!
//! A path that begins as a URL does, `s3://bucket/folder`, is in a store (`docs/stores.md`): with the
//! feature `stores`, each function does there what it does on a disk. A store has objects, and neither
//! folders nor links: a folder is there as long as something is in it.
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

mod address;
#[cfg(feature = "faults")]
mod faults;
mod file;
mod growing_file;
mod metadata;
#[cfg(not(feature = "faults"))]
mod no_faults;
mod operations;
mod part;
mod place;
mod storage;
#[cfg(feature = "stores")]
mod store;

pub use address::is_stored;
pub use file::{File, into_std};
pub use metadata::{Entry, Metadata};
pub use operations::{
    canonicalize, check_url, create_dir, exists, expect, expect_no_change, is_dir, is_file, list,
    metadata, open, open_to_append, open_to_lock, read, read_to_string, reading_bytes, remove_dir,
    remove_file, symlink_metadata, sync,
};
pub use part::Part;

#[cfg(feature = "faults")]
use faults::{before, before_read, before_write};
#[cfg(not(feature = "faults"))]
use no_faults::{before, before_read, before_write};

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
