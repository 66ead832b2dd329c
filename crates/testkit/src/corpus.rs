//! What fuzzing found worth keeping, knocked with again.

use std::fs;
use std::path::{Path, PathBuf};

use crate::Door;

/// Knocks at every door with all files of its folder in `fuzz/corpus/`, by name: how many there were.
///
/// # Panics
/// If a door panics, its folder cannot be read, or is empty.
pub fn knock_with_corpus(doors: &[Door]) -> usize {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let knock = |door: &Door| {
        let files = files(&corpus.join(door.name));
        assert!(!files.is_empty(), "fuzz/corpus/{} is empty", door.name);
        for file in &files {
            println!("{}", file.display());
            (door.knock)(&fs::read(file).unwrap());
        }
        files.len()
    };
    doors.iter().map(knock).sum()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}
