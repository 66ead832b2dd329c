//! A file that is not whole yet.

use std::io;
use std::path::Path;

use tempfile::{Builder, TempPath};

use crate::Operation::{Create, Rename};
use crate::{File, before, from_std};

/// A file that waits for its final name; dropped before, it is removed.
#[derive(Debug)]
pub struct Part {
    file: File,
    path: TempPath,
}

impl Part {
    /// Creates an empty file in a folder, named as the builder has it.
    pub fn create(builder: &Builder, folder: &Path) -> io::Result<Self> {
        before(Create)?;
        let (file, path) = builder.tempfile_in(folder)?.into_parts();
        Ok(Self { file: from_std(file), path })
    }

    /// The file, to be written.
    pub fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Gives it its name, in place of a file that has it.
    pub fn rename(self, path: &Path) -> io::Result<()> {
        before(Rename)?;
        self.path.persist(path).map_err(|refused| refused.error)
    }

    /// Gives it its name, unless a file has it.
    pub fn rename_new(self, path: &Path) -> io::Result<()> {
        before(Rename)?;
        self.path.persist_noclobber(path).map_err(|refused| refused.error)
    }
}
