//! The log that stands in `tests/fixtures/nano` is the one that the program writes today.

use occlabel_testkit::{LogSpec, write_log};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// All files under `directory`, by their path in it.
fn files_under(directory: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![directory.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(directory).expect("a path inside").to_owned();
                files.insert(name, std::fs::read(&path).expect("a file"));
            }
        }
    }
    files
}

fn written_now() -> BTreeMap<PathBuf, Vec<u8>> {
    let directory = tempfile::tempdir().expect("a temporary directory");
    write_log(directory.path(), &LogSpec::nano()).expect("a log");
    files_under(directory.path())
}

#[test]
fn the_fixture_is_what_the_program_writes() {
    let fixture =
        files_under(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/nano"));
    let written = written_now();
    let hint = "make-log nano --output tests/fixtures/nano (remove the old files first)";
    assert!(fixture.keys().eq(written.keys()), "other files; {hint}");
    for (name, bytes) in &written {
        assert!(fixture[name] == *bytes, "{} differs; {hint}", name.display());
    }
}

#[test]
fn the_fixture_is_small() {
    let bytes: usize = written_now().values().map(Vec::len).sum();
    assert!(bytes < 400_000, "{bytes} bytes");
}

#[test]
fn two_runs_write_the_same_bytes() {
    assert!(written_now() == written_now());
}
