//! Operations on paths.

use std::fs;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use crate::Operation::{CreateFolder, List, Look, Open, Remove, RemoveFolder, Sync};
use crate::growing_file::GrowingFile;
use crate::place::Place;
use crate::{Entry, File, Metadata, before, is_stored};

/// Whether a path leads anywhere: to a disk, or by a URL to a store of which one knows how to ask it.
pub fn check_url(path: &Path) -> io::Result<()> {
    Place::of(path).map(|_| ())
}

/// Opens a file to be read.
pub fn open(path: &Path) -> io::Result<File> {
    before(Open)?;
    match Place::of(path)? {
        Place::Local(path) => fs::File::open(path).map(File::local),
        Place::Stored(object) => object.open().map(File::stored),
    }
}

/// Opens a file that is there, to append to it.
pub fn open_to_append(path: &Path) -> io::Result<File> {
    before(Open)?;
    match Place::of(path)? {
        Place::Local(path) => fs::OpenOptions::new().append(true).open(path).map(File::local),
        Place::Stored(object) => GrowingFile::open(object).map(File::growing),
    }
}

/// Opens a file that is there, to lock it.
pub fn open_to_lock(path: &Path) -> io::Result<File> {
    before(Open)?;
    match Place::of(path)? {
        Place::Local(path) => {
            fs::OpenOptions::new().read(true).write(true).open(path).map(File::local)
        }
        Place::Stored(object) => object.open().map(File::stored),
    }
}

/// All bytes of a file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A file that is text in UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    io::read_to_string(open(path)?)
}

/// What is known of a file or folder, through symbolic links.
pub fn metadata(path: &Path) -> io::Result<Metadata> {
    before(Look)?;
    match Place::of(path)? {
        Place::Local(path) => fs::metadata(path).map(Metadata::from),
        Place::Stored(object) => object.metadata(),
    }
}

/// What is known of a file, folder or symbolic link.
pub fn symlink_metadata(path: &Path) -> io::Result<Metadata> {
    before(Look)?;
    match Place::of(path)? {
        Place::Local(path) => fs::symlink_metadata(path).map(Metadata::from),
        Place::Stored(object) => object.metadata(),
    }
}

/// Whether there is a file, or something that cannot be looked at.
pub fn is_file(path: &Path) -> bool {
    is(path, Metadata::is_file)
}

/// Whether there is a folder, or something that cannot be looked at.
pub fn is_dir(path: &Path) -> bool {
    is(path, Metadata::is_dir)
}

/// Whether there is anything, even if it cannot be looked at.
pub fn exists(path: &Path) -> bool {
    is(path, |_| true)
}

fn is(path: &Path, is_such: impl Fn(&Metadata) -> bool) -> bool {
    use ErrorKind::{InvalidFilename, InvalidInput, NotADirectory, NotFound};
    match metadata(path) {
        Ok(metadata) => is_such(&metadata),
        // The others are those of names that nothing can have.
        Err(error) => {
            !matches!(error.kind(), NotFound | NotADirectory | InvalidInput | InvalidFilename)
        }
    }
}

/// The full path of what is there, without symbolic links.
pub fn canonicalize(path: &Path) -> io::Result<PathBuf> {
    before(Look)?;
    match Place::of(path)? {
        Place::Local(path) => fs::canonicalize(path),
        Place::Stored(_) => Ok(path.to_owned()),
    }
}

/// What stands in a folder, in no order.
pub fn list(folder: &Path) -> io::Result<Vec<Entry>> {
    before(List)?;
    match Place::of(folder)? {
        Place::Local(here) => {
            let entries = fs::read_dir(here)?;
            entries.map(|entry| Entry::of_local(folder, &entry?)).collect()
        }
        Place::Stored(object) => {
            let named = object.list()?.into_iter();
            Ok(named.map(|named| Entry::of_stored(folder, named)).collect())
        }
    }
}

/// Creates a folder in one that is there. In a store, there is nothing to do.
pub fn create_dir(path: &Path) -> io::Result<()> {
    before(CreateFolder)?;
    match Place::of(path)? {
        Place::Local(path) => fs::create_dir(path),
        Place::Stored(_) => Ok(()),
    }
}

/// Removes a file.
pub fn remove_file(path: &Path) -> io::Result<()> {
    before(Remove)?;
    match Place::of(path)? {
        Place::Local(path) => fs::remove_file(path),
        Place::Stored(object) => object.remove(),
    }
}

/// Removes an empty folder. In a store, it went with what was in it.
pub fn remove_dir(path: &Path) -> io::Result<()> {
    before(RemoveFolder)?;
    match Place::of(path)? {
        Place::Local(path) => fs::remove_dir(path),
        Place::Stored(_) => Ok(()),
    }
}

/// Waits until a file's bytes, or a folder's names, are safe.
pub fn sync(file: &mut File) -> io::Result<()> {
    before(Sync)?;
    file.sync()
}

/// Nothing in a folder will change as long as the program runs, as a log does not: then a store need not
/// be asked for each of its files.
pub fn expect_no_change(folder: &Path) {
    if let (true, Ok(Place::Stored(object))) = (is_stored(folder), Place::of(folder)) {
        object.expect_no_change();
    }
}

/// These files of a folder will be read, about in this order; in place of those that were expected before.
/// From a store, the next ones are fetched while one is worked on. Names and sizes in bytes.
pub fn expect<'f>(folder: &Path, files: impl IntoIterator<Item = &'f (String, u64)>) {
    if let (true, Ok(Place::Stored(object))) = (is_stored(folder), Place::of(folder)) {
        object.expect(&mut files.into_iter().map(|(name, bytes)| (name.as_str(), *bytes)));
    }
}

/// The memory that so many readers at once of a folder's files take at most.
pub fn reading_bytes(folder: &Path, readers: usize) -> u64 {
    match Place::of(folder) {
        Ok(Place::Stored(object)) => object.reading_bytes(readers),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_absent_is_neither_file_nor_folder() {
        let folder = tempfile::tempdir().unwrap();
        let (file, absent) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&file, "x").unwrap();
        assert!(is_file(&file) && exists(&file) && !is_dir(&file));
        assert!(is_dir(folder.path()) && exists(folder.path()) && !is_file(folder.path()));
        let long = folder.path().join("n".repeat(300));
        for path in [absent, file.join("below"), PathBuf::from("a\0b"), long] {
            assert!(!exists(&path) && !is_file(&path) && !is_dir(&path), "{path:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_cannot_be_looked_at_counts_as_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("loop");
        std::os::unix::fs::symlink(&path, &path).unwrap();
        assert!(is_file(&path) && open(&path).is_err());
    }
}
