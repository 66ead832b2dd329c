//! Operations on paths.

use std::fs::{self, DirEntry, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use crate::Operation::{CreateFolder, List, Look, Open, Remove, RemoveFolder, Sync};
use crate::{File, before, from_std};

/// Opens a file to be read.
pub fn open(path: &Path) -> io::Result<File> {
    before(Open)?;
    fs::File::open(path).map(from_std)
}

/// Opens a file as the options say.
pub fn open_by(options: &OpenOptions, path: &Path) -> io::Result<File> {
    before(Open)?;
    options.open(path).map(from_std)
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

/// What the system says of a file or folder, through symbolic links.
pub fn metadata(path: &Path) -> io::Result<Metadata> {
    before(Look)?;
    fs::metadata(path)
}

/// What the system says of a file, folder or symbolic link.
pub fn symlink_metadata(path: &Path) -> io::Result<Metadata> {
    before(Look)?;
    fs::symlink_metadata(path)
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
    fs::canonicalize(path)
}

/// What stands in a folder, in no order.
pub fn list(folder: &Path) -> io::Result<Vec<DirEntry>> {
    before(List)?;
    fs::read_dir(folder)?.collect()
}

/// Creates a folder in one that is there.
pub fn create_dir(path: &Path) -> io::Result<()> {
    before(CreateFolder)?;
    fs::create_dir(path)
}

/// Removes a file.
pub fn remove_file(path: &Path) -> io::Result<()> {
    before(Remove)?;
    fs::remove_file(path)
}

/// Removes an empty folder.
pub fn remove_dir(path: &Path) -> io::Result<()> {
    before(RemoveFolder)?;
    fs::remove_dir(path)
}

/// Waits until a file's bytes, or a folder's names, are safe on disk.
pub fn sync(file: &File) -> io::Result<()> {
    before(Sync)?;
    file.sync_all()
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
