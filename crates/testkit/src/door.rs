//! Where bytes come in.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A parser, or a stage fed from bytes, behind one signature: what tests with damage and fuzzing
/// knock at.
#[derive(Clone, Copy, Debug)]
pub struct Door {
    /// For people, and of its folder in `fuzz/corpus/`.
    pub name: &'static str,
    /// Reads bytes; whether they were what it expects.
    ///
    /// It panics if what was read breaks a promise.
    pub knock: fn(&[u8]) -> bool,
    /// Bytes that it expects.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// Hands bytes on as files in a folder of their own, in memory where there is such a place.
///
/// # Panics
/// If they cannot be written.
pub fn in_folder(files: &[(&str, &[u8])], read: impl FnOnce(&Path) -> bool) -> bool {
    static FOLDERS: AtomicUsize = AtomicUsize::new(0);
    let (process, number) = (std::process::id(), FOLDERS.fetch_add(1, Ordering::Relaxed));
    let memory = Path::new("/dev/shm");
    let root = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
    let folder: PathBuf = root.join(format!("occlabel-door-{process}-{number}"));
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).and_then(|()| fs::write(path, bytes)).unwrap();
    }
    let read = read(&folder);
    fs::remove_dir_all(&folder).unwrap();
    read
}
