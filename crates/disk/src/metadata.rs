//! What is known of a file or folder without reading it.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What the disk or the store says of a file or folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Metadata {
    kind: Kind,
    bytes: u64,
    modified: Option<SystemTime>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    File,
    Folder,
    Link,
    Other,
}

impl Metadata {
    /// Whether it is a plain file.
    pub fn is_file(&self) -> bool {
        self.kind == Kind::File
    }

    /// Whether it is a folder.
    pub fn is_dir(&self) -> bool {
        self.kind == Kind::Folder
    }

    /// Whether it is a symbolic link.
    pub fn is_symlink(&self) -> bool {
        self.kind == Kind::Link
    }

    /// Its length in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// When it was last modified.
    ///
    /// # Errors
    /// If the system does not tell.
    pub fn modified(&self) -> io::Result<SystemTime> {
        self.modified.ok_or_else(|| io::Error::new(ErrorKind::Unsupported, "no time of change"))
    }

    /// Of an object.
    #[cfg(feature = "stores")]
    pub(crate) fn of_object(bytes: u64, modified: SystemTime) -> Self {
        Self { kind: Kind::File, bytes, modified: Some(modified) }
    }

    /// Of a folder of objects.
    #[cfg(feature = "stores")]
    pub(crate) fn of_stored_folder() -> Self {
        Self { kind: Kind::Folder, bytes: 0, modified: None }
    }
}

impl From<fs::Metadata> for Metadata {
    fn from(metadata: fs::Metadata) -> Self {
        let kind = Kind::from(metadata.file_type());
        Self { kind, bytes: metadata.len(), modified: metadata.modified().ok() }
    }
}

impl From<fs::FileType> for Kind {
    fn from(kind: fs::FileType) -> Self {
        match (kind.is_file(), kind.is_dir(), kind.is_symlink()) {
            (true, ..) => Self::File,
            (_, true, _) => Self::Folder,
            (.., true) => Self::Link,
            _ => Self::Other,
        }
    }
}

/// What stands in a folder.
#[derive(Clone, Debug)]
pub struct Entry {
    path: PathBuf,
    kind: Kind,
}

impl Entry {
    /// Its path: the folder's, as it was asked for, and its name.
    pub fn path(&self) -> PathBuf {
        self.path.clone()
    }

    /// Its name.
    pub fn file_name(&self) -> OsString {
        self.path.file_name().map(OsStr::to_owned).unwrap_or_default()
    }

    /// Whether it is a folder; a link to one is none.
    pub fn is_dir(&self) -> bool {
        self.kind == Kind::Folder
    }

    pub(crate) fn of_local(folder: &Path, entry: &fs::DirEntry) -> io::Result<Self> {
        let kind = Kind::from(entry.file_type()?);
        Ok(Self { path: folder.join(entry.file_name()), kind })
    }

    pub(crate) fn of_stored(folder: &Path, (name, metadata): (String, Metadata)) -> Self {
        Self { path: folder.join(name), kind: metadata.kind }
    }
}
