//! Opening logs, and comparing numbers.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use occlabel_core::{ClassSet, McapSettings, Meaning, Pose, Taxonomy};
use occlabel_logs::{McapLog, McapOptions, ReadOptions, TimeSource};

/// One class, `thing`, that these box categories mean.
pub(crate) fn taxonomy(boxes: &[&str]) -> Taxonomy {
    let meaning = Meaning::Class(occlabel_core::ClassId(0));
    Taxonomy {
        names: vec!["thing".into()],
        free: 1,
        unknown: None,
        things: ClassSet::default(),
        movers: ClassSet::default(),
        deformable: ClassSet::default(),
        flat: ClassSet::default(),
        rank: vec![0],
        points: BTreeMap::from([("rock".to_owned(), meaning)]),
        boxes: boxes.iter().map(|name| ((*name).to_owned(), meaning)).collect(),
    }
}

pub(crate) fn options(boxes: &[&str], settings: McapSettings) -> McapOptions {
    let unknown_as = Some(occlabel_core::ClassId(0));
    let read = ReadOptions { unknown_as, ..ReadOptions::of(taxonomy(boxes)) };
    McapOptions { read, settings, time_source: TimeSource::Header, recover: false }
}

/// A folder with nothing but this file.
pub(crate) fn folder_of(file: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(file, folder.path().join(file.file_name().unwrap())).unwrap();
    folder
}

pub(crate) fn open(root: &Path, options: McapOptions) -> McapLog {
    McapLog::open(root, options).unwrap_or_else(|fault| panic!("{fault}"))
}

/// A file of the data beside the project; `None`, with a word, if it is not there.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("OCCLABEL_DATA").map(PathBuf::from);
    let root =
        root.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    let path = root.join(name);
    if !path.exists() {
        eprintln!("skipped: no {name} in the data folder");
        return None;
    }
    Some(path)
}

/// What a file's maker says of it.
pub(crate) fn expected(name: &str) -> serde_json::Value {
    let text = std::fs::read_to_string(shared(name).unwrap()).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The largest difference to a 4 x 4 matrix, rows first.
pub(crate) fn apart(pose: &Pose, matrix: &serde_json::Value) -> f64 {
    let found = pose.to_homogeneous();
    let cells = (0..4).flat_map(|row| (0..4).map(move |column| (row, column)));
    let off = |(row, column): (usize, usize)| {
        (found[(row, column)] - matrix[row][column].as_f64().unwrap()).abs()
    };
    cells.map(off).fold(0.0, f64::max)
}
