//! A file whose every read and write is an operation that can fail.

use std::fs;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Deref;

use crate::faults::{before_read, before_write};

/// A file as [`std::fs::File`] is one, but for what fails on purpose.
#[derive(Debug)]
pub struct File(fs::File);

pub(crate) fn from_std(file: fs::File) -> File {
    File(file)
}

/// The file itself, for a library that takes no other: what it reads does not fail.
pub fn into_std(file: File) -> fs::File {
    file.0
}

impl Deref for File {
    type Target = fs::File;

    fn deref(&self) -> &fs::File {
        &self.0
    }
}

impl Read for File {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let bytes = before_read(bytes)?;
        self.0.read(bytes)
    }
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        before_write(&mut self.0, bytes)?;
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}
