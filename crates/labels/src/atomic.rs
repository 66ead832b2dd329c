//! The only file that writes: whole files under their names, or nothing.
//!
//! ```text
//!   create .labels.npz.Ab12Cd.part -> write -> fsync -> rename to labels.npz -> fsync the folder
//! ```
//!
//! On any error the part is removed. What a killed process left behind goes when the same file is
//! written again.

use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use occlabel_core::Fault;
use occlabel_disk::{self as disk, File, Part};
use tempfile::Builder;

/// Ends the name of a file that is not whole yet.
const PART: &str = ".part";

/// Writes a file whole, in place of one that is there. Its folder must exist.
///
/// # Errors
/// If it cannot be written: the fault names the path and the bytes needed. If the path is a
/// symbolic link: a link could lead out of the tree. (A folder on the way may be one.)
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    refuse_symlink(path)?;
    remove_leftovers(path)
        .and_then(|()| write_part(path, bytes))
        .and_then(|part| part.rename(path))
        .and_then(|()| sync_folder_of(path))
        .map_err(|error| write_fault(path, bytes.len(), &error))
}

/// Writes a file piece by piece: `write` is given where to. It stands under its name once it is whole.
/// Its folder must exist.
///
/// # Errors
/// If it cannot be written, or `write` fails; then what was there before stays. If the path is a
/// symbolic link.
pub fn write_pieces<E: From<Fault>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> Result<(), E>,
) -> Result<(), E> {
    refuse_symlink(path)?;
    let begun = remove_leftovers(path).and_then(|()| begin_part(path));
    let mut part = begun.map_err(|error| write_fault(path, 0, &error))?;
    let mut pieces = BufWriter::new(part.file());
    write(&mut pieces)?;
    let flushed = pieces.flush();
    drop(pieces);
    let bytes = part.file().seek(SeekFrom::End(0)).unwrap_or(0) as usize;
    let whole = flushed.and_then(|()| disk::sync(part.file()));
    whole
        .and_then(|()| part.rename(path))
        .and_then(|()| sync_folder_of(path))
        .map_err(|error| write_fault(path, bytes, &error).into())
}

/// Creates a file with its contents, both at once. `false` if there is one already, or if another, who
/// has it now, removed our part as a leftover.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn create_exclusive(path: &Path, bytes: &[u8]) -> Result<bool, Fault> {
    let created = write_part(path, bytes).and_then(|part| match part.rename_new(path) {
        Ok(()) => sync_folder_of(path).map(|()| true),
        Err(error) if matches!(error.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound) => {
            Ok(false)
        }
        Err(error) => Err(error),
    });
    created.map_err(|error| write_fault(path, bytes.len(), &error))
}

/// Replaces a file, open and locked, by its new contents. `false` if another, who has it now, removed our
/// part as a leftover, or was the first to replace what is in a store.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn replace(path: &Path, open: &File, bytes: &[u8]) -> Result<bool, Fault> {
    let replaced = write_part(path, bytes).and_then(|part| match part.rename_over(path, open) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        renamed => renamed.and_then(|()| sync_folder_of(path)).map(|()| true),
    });
    replaced.map_err(|error| write_fault(path, bytes.len(), &error))
}

/// Creates a folder and those above it. One that is a symbolic link to a folder counts as there.
///
/// # Errors
/// If it cannot be created.
pub fn create_dir(path: &Path) -> Result<(), Fault> {
    if disk::is_stored(path) || disk::is_dir(path) {
        return Ok(());
    }
    if path.parent().is_some_and(|above| !above.as_os_str().is_empty()) {
        create_dir(folder_of(path))?;
    }
    match disk::create_dir(path) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists || !disk::is_dir(path) => Err(error),
        _ => sync_folder_of(path),
    }
    .map_err(|error| {
        Fault::new(
            "folder",
            path.display().to_string(),
            "a folder, or to create one",
            error.to_string(),
        )
    })
}

/// Removes a file. One that is not there is no error.
///
/// # Errors
/// If it is there and cannot be removed.
pub fn remove_file(path: &Path) -> Result<(), Fault> {
    match disk::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            let found = error.to_string();
            Err(Fault::new("remove", path.display().to_string(), "to remove this file", found))
        }
        _ => Ok(()),
    }
}

/// Removes a folder if it is empty, then those above it, up to `root`, which stays.
pub(crate) fn remove_empty_dirs(folder: &Path, root: &Path) {
    let inside = folder.ancestors().take_while(|above| *above != root && above.starts_with(root));
    for folder in inside {
        if disk::remove_dir(folder).is_err() {
            return;
        }
    }
}

/// A file that only grows, line by line, each safe on disk before the next.
#[derive(Debug)]
pub(crate) struct Appender {
    path: PathBuf,
    file: File,
    bytes: u64,
}

impl Appender {
    /// Opens a file that is there, to append to it.
    pub(crate) fn open(path: &Path) -> Result<Self, Fault> {
        refuse_symlink(path)?;
        let opened = disk::open_to_append(path).and_then(|file| Ok((file.size_bytes()?, file)));
        let (bytes, file) = opened.map_err(|error| write_fault(path, 0, &error))?;
        Ok(Self { path: path.to_owned(), file, bytes })
    }

    /// Appends a line. If that fails, what was written of it is cut off again.
    pub(crate) fn append(&mut self, line: &[u8]) -> Result<(), Fault> {
        match self.file.write_all(line).and_then(|()| disk::sync(&mut self.file)) {
            Ok(()) => {
                self.bytes += line.len() as u64;
                Ok(())
            }
            Err(error) => {
                let _ = self.file.set_len(self.bytes);
                Err(write_fault(&self.path, line.len(), &error))
            }
        }
    }
}

/// Refuses a path whose last part is a symbolic link.
pub(crate) fn refuse_symlink(path: &Path) -> Result<(), Fault> {
    if disk::is_stored(path) {
        return Ok(());
    }
    match disk::symlink_metadata(path) {
        Ok(meta) if meta.is_symlink() => {
            let place = path.display().to_string();
            let found = "a symbolic link";
            Err(Fault::new("output-symlink", place, "a file, or nothing yet", found)
                .hint("a folder of the tree may be a link, a file of it may not"))
        }
        Err(error) if !is_absent(&error) => Err(write_fault(path, 0, &error)),
        _ => Ok(()),
    }
}

fn is_absent(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Writes and syncs the bytes beside the path; dropped, the part is removed.
fn write_part(path: &Path, bytes: &[u8]) -> io::Result<Part> {
    let mut part = begin_part(path)?;
    part.file().write_all(bytes)?;
    disk::sync(part.file())?;
    Ok(part)
}

/// An empty file beside the path; dropped, it is removed.
fn begin_part(path: &Path) -> io::Result<Part> {
    let prefix = part_prefix(path);
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(PART);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    Part::create(&builder, folder_of(path))
}

/// Removes what a killed process left of the same file. A file has one writer at a time: the locks
/// see to that.
pub(crate) fn remove_leftovers(path: &Path) -> io::Result<()> {
    if disk::is_stored(path) {
        return Ok(());
    }
    let prefix = part_prefix(path);
    for entry in disk::list(folder_of(path))? {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(&prefix) && name.ends_with(PART) {
            match disk::remove_file(&entry.path()) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
    }
    Ok(())
}

fn part_prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    format!(".{}.", name.to_string_lossy())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(above) if !above.as_os_str().is_empty() => above,
        _ => Path::new("."),
    }
}

/// Makes the names in the folder safe, as fsync on the file makes its bytes. Some network file
/// systems cannot; there it is as safe as they are.
fn sync_folder_of(path: &Path) -> io::Result<()> {
    if disk::is_stored(path) {
        return Ok(());
    }
    match disk::open(folder_of(path)).and_then(|mut folder| disk::sync(&mut folder)) {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => {
            Ok(())
        }
        synced => synced,
    }
}

fn write_fault(path: &Path, bytes: usize, error: &io::Error) -> Fault {
    let expected = format!("to write {bytes} bytes");
    let fault = Fault::new("write", path.display().to_string(), expected, error.to_string());
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            fault.hint("make room, then give the same command again: finished keyframes are kept")
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            fault.hint("make the folder writable, or choose another --output")
        }
        _ => fault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_written_whole_in_place_of_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_file(&path, b"a long first text").unwrap();
        write_file(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_file_in_pieces_is_there_once_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_file(&path, b"old").unwrap();
        let broken = write_pieces(&path, |to| {
            to.write_all(b"half").unwrap();
            Err(Fault::new("test", "there", "a whole", "a half"))
        });
        assert_eq!(broken.unwrap_err().rule, "test");
        assert_eq!(
            (fs::read(&path).unwrap(), names(folder.path())),
            (b"old".to_vec(), vec!["a.txt".into()])
        );
        let whole = write_pieces::<Fault>(&path, |to| {
            to.write_all(b"whole ").unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"old");
            to.write_all(b"now").unwrap();
            Ok(())
        });
        assert!(whole.is_ok());
        assert_eq!(
            (fs::read(&path).unwrap(), names(folder.path())),
            (b"whole now".to_vec(), vec!["a.txt".into()])
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_written_file_may_be_read_by_others() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_file(&ours, b"x").unwrap();
        fs::write(&plain, b"x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn fault_37_a_link_as_the_file_is_refused_a_linked_folder_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let (outside, link) = (folder.path().join("outside"), folder.path().join("link"));
        fs::write(&outside, b"untouched").unwrap();
        std::os::unix::fs::symlink(&outside, &link).unwrap();
        assert_eq!(write_file(&link, b"x").unwrap_err().rule, "output-symlink");
        assert_eq!(fs::read(&outside).unwrap(), b"untouched");

        let (real, linked) = (folder.path().join("real"), folder.path().join("linked"));
        fs::create_dir(&real).unwrap();
        std::os::unix::fs::symlink(&real, &linked).unwrap();
        create_dir(&linked.join("deeper")).unwrap();
        write_file(&linked.join("deeper/a"), b"x").unwrap();
        assert_eq!(names(&real.join("deeper")), ["a"]);
    }

    #[test]
    fn fault_38_a_failed_write_names_path_and_bytes_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"x").unwrap();
        let below = write_file(&file.join("a"), &[0; 1234]).unwrap_err().to_string();
        assert!(below.contains("file/a") && below.contains("1234 bytes"), "{below}");

        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert_eq!(write_file(&taken, b"x").unwrap_err().rule, "write");
        assert_eq!(names(folder.path()), ["file", "taken"]);
        assert!(create_dir(&file.join("deeper")).is_err());
    }

    #[test]
    fn fault_38_a_full_disk_is_told_with_a_hint() {
        let error = io::Error::from(ErrorKind::StorageFull);
        let text = write_fault(Path::new("gts/a/b/labels.npz"), 69_234, &error).to_string();
        assert!(text.contains("gts/a/b/labels.npz: expected to write 69234 bytes"), "{text}");
        assert!(text.contains("hint: make room"), "{text}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn fault_38_a_line_that_does_not_fit_is_an_error() {
        let mut full = Appender::open(Path::new("/dev/full")).unwrap();
        let fault = full.append(b"a line\n").unwrap_err();
        assert!(fault.to_string().contains("/dev/full: expected to write 7 bytes"), "{fault}");
        assert!(fault.hint.is_some());
    }

    #[test]
    fn fault_39_what_a_killed_writer_left_goes_with_the_next_write() {
        let folder = tempfile::tempdir().unwrap();
        let others = folder.path().join(".b.npz.Zz99zz.part");
        fs::write(folder.path().join(".a.npz.Ab12Cd.part"), b"half").unwrap();
        fs::write(&others, b"half").unwrap();
        write_file(&folder.path().join("a.npz"), b"whole").unwrap();
        assert_eq!(names(folder.path()), [".b.npz.Zz99zz.part", "a.npz"]);
    }

    #[test]
    fn a_file_is_created_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("once");
        assert!(create_exclusive(&path, b"first").unwrap());
        assert!(!create_exclusive(&path, b"second").unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(names(folder.path()), ["once"]);
    }

    #[test]
    fn emptied_folders_go_up_to_the_root() {
        let folder = tempfile::tempdir().unwrap();
        let (empty, full) = (folder.path().join("gts/a/b"), folder.path().join("gts/c"));
        create_dir(&empty).unwrap();
        create_dir(&full).unwrap();
        fs::write(full.join("kept"), b"x").unwrap();
        remove_empty_dirs(&empty, folder.path());
        remove_empty_dirs(&full, folder.path());
        assert_eq!(names(&folder.path().join("gts")), ["c"]);
    }
}
