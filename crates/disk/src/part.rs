//! A file that is not whole yet.

use std::io;
use std::path::Path;

use tempfile::{Builder, SpooledTempFile, TempPath};

use crate::Operation::{Create, Rename};
use crate::place::Place;
use crate::storage::Put;
use crate::{File, before};

/// What is on the way to a store is kept in memory up to this, beyond it in a file without a name.
const MAX_SPOOLED_BYTES: usize = 8 << 20;

/// A file that waits for its final name; dropped before, it is removed.
#[derive(Debug)]
pub struct Part {
    file: File,
    /// None of what is on the way to a store.
    path: Option<TempPath>,
}

impl Part {
    /// Creates an empty file in a folder, named as the builder has it.
    pub fn create(builder: &Builder, folder: &Path) -> io::Result<Self> {
        before(Create)?;
        match Place::of(folder)? {
            Place::Local(folder) => {
                let (file, path) = builder.tempfile_in(folder)?.into_parts();
                Ok(Self { file: File::local(file), path: Some(path) })
            }
            Place::Stored(_) => {
                Ok(Self { file: File::spool(SpooledTempFile::new(MAX_SPOOLED_BYTES)), path: None })
            }
        }
    }

    /// The file, to be written.
    pub fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Gives it its name, in place of a file that has it.
    pub fn rename(self, path: &Path) -> io::Result<()> {
        self.name(path, Put::Over, |part, path| part.persist(path))
    }

    /// Gives it its name, unless a file has it.
    pub fn rename_new(self, path: &Path) -> io::Result<()> {
        self.name(path, Put::New, |part, path| part.persist_noclobber(path))
    }

    /// Gives it the name of an open, locked file. In a store, where nobody has a lock, only if that was
    /// not replaced meanwhile.
    pub fn rename_over(self, path: &Path, open: &File) -> io::Result<()> {
        self.name(path, Put::InPlaceOf(open.version()), |part, path| part.persist(path))
    }

    fn name(
        self,
        path: &Path,
        put: Put,
        persist: impl FnOnce(TempPath, &Path) -> Result<(), tempfile::PathPersistError>,
    ) -> io::Result<()> {
        before(Rename)?;
        match (Place::of(path)?, self.path) {
            (Place::Local(path), Some(part)) => {
                persist(part, &path).map_err(|refused| refused.error)
            }
            (Place::Stored(object), None) => {
                let (mut file, bytes) = self.file.into_spool()?;
                object.put(&mut file, bytes, &put)
            }
            _ => Err(io::Error::new(io::ErrorKind::CrossesDevices, "a part of another folder")),
        }
    }
}
