//! What a store's error is on a disk.

use std::io::{self, ErrorKind};

use object_store::Error;

/// The longest text of an error that is told: some stores send a page.
const MAX_CHARACTERS: usize = 400;

/// The error in a line, of the kind that a disk would give.
pub(crate) fn io_error(error: Error) -> io::Error {
    let kind = match &error {
        Error::NotFound { .. } => ErrorKind::NotFound,
        Error::AlreadyExists { .. } | Error::Precondition { .. } => ErrorKind::AlreadyExists,
        Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => {
            ErrorKind::PermissionDenied
        }
        Error::NotSupported { .. } | Error::NotImplemented { .. } => ErrorKind::Unsupported,
        Error::InvalidPath { .. } => ErrorKind::InvalidInput,
        _ => ErrorKind::Other,
    };
    let text = error.to_string();
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    io::Error::new(kind, line.chars().take(MAX_CHARACTERS).collect::<String>())
}
