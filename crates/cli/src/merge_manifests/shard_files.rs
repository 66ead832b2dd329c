//! The shards' own files, once they are merged.

use occlabel_core::Fault;
use occlabel_labels::{LabelTree, Manifest, name_of_whole, remove_file};

/// Removes the shards' own files, now that the whole run's manifest says all that theirs do.
pub(super) fn remove_merged(tree: &LabelTree, merged: &Manifest) -> Result<(), Fault> {
    let is_replaced = |whole: &str| {
        let listed = merged.files.iter().any(|file| file.path.as_str() == whole);
        listed || ["manifest.json", "report.json"].contains(&whole)
    };
    let of_shards = |path: &String| name_of_whole(path).is_some_and(|whole| is_replaced(&whole));
    let parts: Vec<String> = tree.files()?.into_iter().filter(of_shards).collect();
    parts.iter().try_for_each(|part| remove_file(&tree.root().join(part)))
}
