//! An open file.

use std::fs;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};

use tempfile::SpooledTempFile;

use crate::growing_file::GrowingFile;
use crate::storage::StoredFile;
use crate::{before_read, before_write};

/// An open file, whose every read and write is an operation that can fail.
#[derive(Debug)]
pub struct File(Kind);

#[derive(Debug)]
enum Kind {
    Local(fs::File),
    /// Read from a store.
    Stored(Box<dyn StoredFile>),
    /// Appended to in a store.
    Growing(GrowingFile),
    /// On the way to a store.
    Spool(SpooledTempFile),
}

/// The file itself, for a library that takes no other: what it reads does not fail on purpose. What is in
/// a store is first fetched whole.
///
/// # Errors
/// If it cannot be fetched.
pub fn into_std(file: File) -> io::Result<fs::File> {
    match file.0 {
        Kind::Local(file) => Ok(file),
        Kind::Stored(mut stored) => {
            let mut file = tempfile::tempfile()?;
            io::copy(&mut stored, &mut file)?;
            file.rewind()?;
            Ok(file)
        }
        Kind::Growing(_) | Kind::Spool(_) => Err(unsupported()),
    }
}

impl File {
    pub(crate) fn local(file: fs::File) -> Self {
        Self(Kind::Local(file))
    }

    pub(crate) fn stored(file: Box<dyn StoredFile>) -> Self {
        Self(Kind::Stored(file))
    }

    pub(crate) fn growing(file: GrowingFile) -> Self {
        Self(Kind::Growing(file))
    }

    pub(crate) fn spool(file: SpooledTempFile) -> Self {
        Self(Kind::Spool(file))
    }

    /// Its length in bytes.
    ///
    /// # Errors
    /// If the system does not tell.
    pub fn size_bytes(&self) -> io::Result<u64> {
        match &self.0 {
            Kind::Local(file) => Ok(file.metadata()?.len()),
            Kind::Stored(file) => Ok(file.len()),
            Kind::Growing(file) => Ok(file.bytes()),
            Kind::Spool(_) => Err(unsupported()),
        }
    }

    /// Cuts it, or fills it with zeros, to so many bytes.
    ///
    /// # Errors
    /// If that cannot be done.
    pub fn set_len(&mut self, bytes: u64) -> io::Result<()> {
        match &mut self.0 {
            Kind::Local(file) => file.set_len(bytes),
            Kind::Growing(file) => file.cut(bytes),
            Kind::Spool(file) => file.set_len(bytes),
            Kind::Stored(_) => Err(unsupported()),
        }
    }

    /// Waits for the right to change it, among the processes of this machine; objects have none.
    ///
    /// # Errors
    /// If the system gives none.
    pub fn lock(&self) -> io::Result<()> {
        match &self.0 {
            Kind::Local(file) => file.lock(),
            _ => Ok(()),
        }
    }

    /// The version of an object, as it was when it was opened.
    pub(crate) fn version(&self) -> Option<String> {
        match &self.0 {
            Kind::Stored(file) => file.version().map(str::to_owned),
            _ => None,
        }
    }

    pub(crate) fn sync(&mut self) -> io::Result<()> {
        match &mut self.0 {
            Kind::Local(file) => file.sync_all(),
            Kind::Growing(file) => file.put(),
            // It is safe once it is put; nothing was written to what is read.
            Kind::Spool(_) | Kind::Stored(_) => Ok(()),
        }
    }

    /// What was written on the way to a store, to be read from its beginning, and its length in bytes.
    pub(crate) fn into_spool(self) -> io::Result<(SpooledTempFile, u64)> {
        let Kind::Spool(mut file) = self.0 else { return Err(unsupported()) };
        let bytes = file.seek(SeekFrom::End(0))?;
        file.rewind()?;
        Ok((file, bytes))
    }
}

impl Read for File {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let bytes = before_read(bytes)?;
        match &mut self.0 {
            Kind::Local(file) => file.read(bytes),
            Kind::Stored(file) => file.read(bytes),
            Kind::Spool(file) => file.read(bytes),
            Kind::Growing(_) => Err(unsupported()),
        }
    }
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.0 {
            Kind::Local(file) => write(file, bytes),
            Kind::Growing(file) => write(file, bytes),
            Kind::Spool(file) => write(file, bytes),
            Kind::Stored(_) => Err(unsupported()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.0 {
            Kind::Local(file) => file.flush(),
            Kind::Spool(file) => file.flush(),
            Kind::Growing(_) | Kind::Stored(_) => Ok(()),
        }
    }
}

fn write(file: &mut impl Write, bytes: &[u8]) -> io::Result<usize> {
    before_write(file, bytes)?;
    file.write(bytes)
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.0 {
            Kind::Local(file) => file.seek(to),
            Kind::Stored(file) => file.seek(to),
            Kind::Spool(file) => file.seek(to),
            Kind::Growing(_) => Err(unsupported()),
        }
    }
}

fn unsupported() -> io::Error {
    io::Error::new(ErrorKind::Unsupported, "not done with such a file")
}
