//! The only file that writes: a log appears under its name once it is whole.
//!
//! ```text
//!   DIR/.part/samples/…, DIR/.part/v1.0-sim/…   while it is being written
//!   DIR/samples, …, then DIR/v1.0-sim           when it is done: the entry without which nothing
//!                                               is a log moves last
//! ```

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use occlabel_core::Fault;

/// Where files stand until the log is whole.
const PART: &str = ".part";

/// The folder of a log that is being written. Dropped before it is finished, it leaves nothing.
#[derive(Debug)]
pub struct Output {
    root: PathBuf,
    part: PathBuf,
    /// Whether the folder was made for the log.
    is_new: bool,
}

/// A file that grows.
#[derive(Debug)]
pub(crate) struct OutputFile {
    path: PathBuf,
    writer: BufWriter<File>,
}

impl Output {
    /// Begins a log in a folder that is absent, empty, or holds nothing but what a killed writer
    /// left behind.
    ///
    /// # Errors
    /// If the folder holds anything else (rule `output`), or cannot be made.
    pub fn create(root: &Path) -> Result<Self, Fault> {
        if root.to_str().is_some_and(|root| root.contains("://")) {
            let (place, found) = (root.display().to_string(), "a URL");
            return Err(Fault::new("output", place, "a folder of this machine", found));
        }
        let is_new = !root.exists();
        fs::create_dir_all(root).map_err(|error| refused(root, &error))?;
        if let Some(found) = names_in(root)?.iter().find(|name| *name != PART) {
            let (place, found) = (root.display().to_string(), format!("`{found}` in it"));
            return Err(Fault::new("output", place, "an empty folder", found));
        }
        let part = root.join(PART);
        match fs::remove_dir_all(&part) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(refused(&part, &error));
            }
            _ => fs::create_dir(&part).map_err(|error| refused(&part, &error))?,
        }
        Ok(Self { root: root.to_owned(), part, is_new })
    }

    /// Writes a file; `name` is relative to the log's root.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Fault> {
        let path = self.place(name)?;
        fs::write(&path, bytes).map_err(|error| refused(&path, &error))
    }

    /// Moves everything to its place, `last` after all else; tells how many files and bytes it is.
    ///
    /// # Errors
    /// If a file cannot be moved.
    pub fn finish(self, last: &str) -> Result<(usize, u64), Fault> {
        let size = size_of(&self.part)?;
        let mut names = names_in(&self.part)?;
        names.sort_by_key(|name| (name == last, name.clone()));
        for name in names {
            let (from, to) = (self.part.join(&name), self.root.join(&name));
            fs::rename(&from, &to).map_err(|error| refused(&to, &error))?;
        }
        Ok(size)
    }

    /// A file to be written bit by bit.
    pub(crate) fn stream(&self, name: &str) -> Result<OutputFile, Fault> {
        let path = self.place(name)?;
        let file = File::create(&path).map_err(|error| refused(&path, &error))?;
        Ok(OutputFile { path, writer: BufWriter::new(file) })
    }

    fn place(&self, name: &str) -> Result<PathBuf, Fault> {
        let path = self.part.join(name);
        let folder = path.parent().unwrap_or(&self.part);
        fs::create_dir_all(folder).map_err(|error| refused(folder, &error))?;
        Ok(path)
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        // What stays is taken away by the next writer.
        let _ = fs::remove_dir_all(&self.part);
        if self.is_new {
            // Only an empty folder goes.
            let _ = fs::remove_dir(&self.root);
        }
    }
}

impl OutputFile {
    /// Appends bytes.
    pub(crate) fn write(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.writer.write_all(bytes).map_err(|error| refused(&self.path, &error))
    }

    /// The path, and what writes there.
    pub(crate) fn into_parts(self) -> (PathBuf, BufWriter<File>) {
        (self.path, self.writer)
    }

    /// Writes what is still held back.
    pub(crate) fn finish(mut self) -> Result<(), Fault> {
        self.writer.flush().map_err(|error| refused(&self.path, &error))
    }
}

fn refused(path: &Path, error: &io::Error) -> Fault {
    Fault::new("write", path.display().to_string(), "to write here", error.to_string())
}

/// Names in a folder, sorted.
fn names_in(folder: &Path) -> Result<Vec<String>, Fault> {
    let listed = fs::read_dir(folder).and_then(|entries| {
        entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()
    });
    let mut names: Vec<String> = listed.map_err(|error| refused(folder, &error))?;
    names.sort_unstable();
    Ok(names)
}

/// Files below a folder, and their bytes.
fn size_of(folder: &Path) -> Result<(usize, u64), Fault> {
    let mut size = (0, 0);
    for name in names_in(folder)? {
        let path = folder.join(name);
        let found = fs::metadata(&path).map_err(|error| refused(&path, &error))?;
        let (files, bytes) = if found.is_dir() { size_of(&path)? } else { (1, found.len()) };
        size = (size.0 + files, size.1 + bytes);
    }
    Ok(size)
}
