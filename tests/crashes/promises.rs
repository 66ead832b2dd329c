//! What is promised of an output folder, however the program ended.

use std::path::{Path, PathBuf};

use occlabel_labels::{LabelTree, Manifest, verify_file};

use crate::line::Line;
use crate::support::files_under;

/// A final name means a complete file; what a manifest lists is as it says. What stood there before,
/// broken or not, may still stand.
pub(crate) fn check(line: &Line, output: &Path, why: &str) {
    for (path, bytes) in files_under(output) {
        let is_whole = line.expected.get(&path) == Some(&bytes);
        let was_there = line.before.get(&path) == Some(&bytes);
        assert!(!is_final(&path) || is_whole || was_there, "{why}: {path} is not whole");
    }
    for path in manifests(line, output) {
        let tree = LabelTree::new(path.parent().expect("a folder"));
        let manifest = Manifest::load(&path).expect("a whole manifest").expect("a manifest");
        for file in &manifest.files {
            let below = tree.place(&file.path);
            let below = below.strip_prefix(output).expect("below").to_str().expect("UTF-8");
            let stays =
                line.before.get(below) == std::fs::read(tree.place(&file.path)).ok().as_ref();
            let verified = verify_file(&tree, file);
            assert!(stays || verified.is_ok(), "{why}: {}", verified.unwrap_err());
        }
    }
}

/// Whether the file is of those that are the same each time: not a part, a lock, a record of a run that
/// goes on, a report, or a list of what `verify` could not read.
fn is_final(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or(path);
    ["npz", "npy", "html"].iter().any(|ending| name.ends_with(ending))
}

/// The manifests that the line wrote: of the tree, and of those below it.
fn manifests(line: &Line, output: &Path) -> Vec<PathBuf> {
    let files = files_under(output).into_iter();
    let written = files.filter(|(path, bytes)| {
        let name = path.rsplit('/').next().unwrap_or(path);
        let is_manifest = name.starts_with("manifest.") && name.ends_with(".json");
        is_manifest && line.before.get(path) != Some(bytes)
    });
    written.map(|(path, _)| output.join(path)).collect()
}
