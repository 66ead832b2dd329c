//! A file of the standard library, and nothing that fails on purpose.

use std::io;

use crate::Operation;

pub use std::fs::File;

pub(crate) fn before(_operation: Operation) -> io::Result<()> {
    Ok(())
}

pub(crate) fn from_std(file: File) -> File {
    file
}

/// The file itself, for a library that takes no other.
pub fn into_std(file: File) -> File {
    file
}
