//! Every touch of a label tree's files, one operation at a time, so that a test can have any of them
//! fail.

use std::fs::{self, DirEntry, File, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

#[cfg(feature = "faults")]
use crate::faults::{before, shorten};

/// Nothing fails on purpose.
#[cfg(not(feature = "faults"))]
fn before(_operation: &str) -> io::Result<()> {
    Ok(())
}

/// Everything is written.
#[cfg(not(feature = "faults"))]
fn shorten(_file: &mut impl Write, _bytes: &[u8]) -> io::Result<()> {
    Ok(())
}

pub(crate) fn open(path: &Path) -> io::Result<File> {
    before("open")?;
    File::open(path)
}

pub(crate) fn open_by(options: &OpenOptions, path: &Path) -> io::Result<File> {
    before("open")?;
    options.open(path)
}

pub(crate) fn create_part(builder: &Builder, folder: &Path) -> io::Result<NamedTempFile> {
    before("create")?;
    builder.tempfile_in(folder)
}

pub(crate) fn write(file: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    shorten(file, bytes)?;
    file.write_all(bytes)
}

pub(crate) fn sync(file: &File) -> io::Result<()> {
    before("sync")?;
    file.sync_all()
}

pub(crate) fn rename(part: NamedTempFile, path: &Path) -> io::Result<File> {
    before("rename")?;
    part.persist(path).map_err(|refused| refused.error)
}

pub(crate) fn rename_new(part: NamedTempFile, path: &Path) -> io::Result<File> {
    before("rename")?;
    part.persist_noclobber(path).map_err(|refused| refused.error)
}

pub(crate) fn create_dir(path: &Path) -> io::Result<()> {
    before("create folder")?;
    fs::create_dir(path)
}

pub(crate) fn remove_file(path: &Path) -> io::Result<()> {
    before("remove")?;
    fs::remove_file(path)
}

pub(crate) fn remove_dir(path: &Path) -> io::Result<()> {
    before("remove folder")?;
    fs::remove_dir(path)
}

pub(crate) fn list(folder: &Path) -> io::Result<Vec<DirEntry>> {
    before("list")?;
    fs::read_dir(folder)?.collect()
}

pub(crate) fn metadata(path: &Path) -> io::Result<Metadata> {
    before("look at")?;
    fs::symlink_metadata(path)
}
