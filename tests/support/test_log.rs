//! A log in a temporary folder that a test may break.

use std::fs;
use std::path::{Path, PathBuf};

use occlabel_testkit::{LogSpec, write_log};
use serde_json::Value;
use tempfile::TempDir;

/// The name of the first scene of simulated logs.
pub(crate) const SCENE: &str = "scene-0001";

/// The folder of the tables.
pub(crate) const VERSION: &str = occlabel_testkit::VERSION;

/// Bytes of a point in a sweep's file.
const POINT_BYTES: usize = 20;

/// Put into a table, it is written as the bare `NaN` that Python writes.
pub(crate) const NAN: &str = "<NaN>";

/// x, y, z, intensity, ring.
pub(crate) type Point = [f32; 5];

/// A log and room for outputs beside it.
pub(crate) struct TestLog {
    folder: TempDir,
}

/// The specification of the committed log, to be varied.
pub(crate) fn nano_spec() -> LogSpec {
    LogSpec::nano()
}

impl TestLog {
    /// A copy of the committed log: one scene of 3 keyframes and 9 sweeps.
    pub(crate) fn nano() -> Self {
        let log = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/nano"), &log.root());
        log
    }

    /// A simulated log.
    pub(crate) fn simulated(spec: &LogSpec) -> Self {
        let log = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        write_log(&log.root(), spec).expect("a log");
        log
    }

    /// The log's root folder.
    pub(crate) fn root(&self) -> PathBuf {
        self.folder.path().join("log")
    }

    /// A place beside the log.
    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The path of a file of the log.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    /// The rows of a table.
    pub(crate) fn rows(&self, table: &str) -> Vec<Value> {
        let bytes = fs::read(self.table(table)).expect("a table");
        serde_json::from_slice(&bytes).expect("rows")
    }

    /// Rewrites a table.
    pub(crate) fn edit(&self, table: &str, edit: impl FnOnce(&mut Vec<Value>)) {
        let mut rows = self.rows(table);
        edit(&mut rows);
        let json = serde_json::to_string(&rows).expect("JSON");
        fs::write(self.table(table), json.replace(&format!("\"{NAN}\""), "NaN")).expect("written");
    }

    fn table(&self, table: &str) -> PathBuf {
        self.root().join(VERSION).join(format!("{table}.json"))
    }

    /// The rows of the lidar's sweeps, in the order of time.
    pub(crate) fn sweeps(&self) -> Vec<Value> {
        let mut rows = self.rows("sample_data");
        rows.retain(|row| row["fileformat"] == "pcd");
        rows.sort_by_key(|row| row["timestamp"].as_i64());
        rows
    }

    /// The files of the key sweeps, in the order of time.
    pub(crate) fn key_files(&self) -> Vec<String> {
        self.sweep_files(true)
    }

    /// The files of the other sweeps, in the order of time.
    pub(crate) fn other_files(&self) -> Vec<String> {
        self.sweep_files(false)
    }

    fn sweep_files(&self, is_key: bool) -> Vec<String> {
        let mut rows = self.sweeps();
        rows.retain(|row| row["is_key_frame"] == is_key);
        rows.iter().map(|row| string(&row["filename"])).collect()
    }

    /// The tokens of the keyframes, in the order of time.
    pub(crate) fn keyframes(&self) -> Vec<String> {
        let mut rows = self.rows("sample");
        rows.sort_by_key(|row| row["timestamp"].as_i64());
        rows.iter().map(|row| string(&row["token"])).collect()
    }

    /// The points of a sweep's file.
    pub(crate) fn points(&self, file: &str) -> Vec<Point> {
        let bytes = fs::read(self.file(file)).expect("a sweep");
        let number = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("4 bytes"));
        let point = |bytes: &[u8]| -> Point {
            let numbers: Vec<f32> = bytes.chunks_exact(4).map(number).collect();
            numbers.try_into().expect("5 numbers")
        };
        bytes.chunks_exact(POINT_BYTES).map(point).collect()
    }

    /// Rewrites the points of a sweep's file.
    pub(crate) fn edit_points(&self, file: &str, edit: impl FnOnce(&mut Vec<Point>)) {
        let mut points = self.points(file);
        edit(&mut points);
        let bytes: Vec<u8> = points.into_iter().flatten().flat_map(f32::to_le_bytes).collect();
        fs::write(self.file(file), bytes).expect("written");
    }

    /// Cuts bytes off the end of a file.
    pub(crate) fn truncate(&self, file: &str, bytes: usize) {
        let mut content = fs::read(self.file(file)).expect("a file");
        content.truncate(content.len() - bytes);
        fs::write(self.file(file), content).expect("written");
    }

    /// Leaves a file without a byte.
    pub(crate) fn empty(&self, file: &str) {
        fs::write(self.file(file), []).expect("written");
    }

    /// Removes a file.
    pub(crate) fn remove(&self, file: &str) {
        fs::remove_file(self.file(file)).expect("removed");
    }
}

/// The text of a JSON string.
fn string(value: &Value) -> String {
    value.as_str().expect("a string").to_owned()
}

/// Copies a folder with all that is in it.
pub(crate) fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let place = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy(&path, &place);
        } else {
            fs::copy(&path, &place).expect("copied");
        }
    }
}
