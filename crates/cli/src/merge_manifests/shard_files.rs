//! The shards' own files, once they are merged.

use std::collections::BTreeSet;

use occlabel_core::Fault;
use occlabel_labels::{LabelTree, Manifest, name_of_whole, remove_file};

/// Removes the shards' own files, now that the whole run's manifest says all that theirs do.
pub(super) fn remove_merged(tree: &LabelTree, merged: &Manifest) -> Result<(), Fault> {
    let listed = merged.files.iter().map(|file| file.path.as_str());
    let replaced: BTreeSet<&str> = listed.chain(["manifest.json", "report.json"]).collect();
    let of_shards =
        |path: &String| name_of_whole(path).is_some_and(|whole| replaced.contains(whole.as_str()));
    let parts: Vec<String> = tree.files()?.into_iter().filter(of_shards).collect();
    parts.iter().try_for_each(|part| remove_file(&tree.root().join(part)))
}
