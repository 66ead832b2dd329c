//! Labels that are as they were written, opened: whether they are labels at all.

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, LabelSet, Wanted};
use occlabel_labels::{LabelTree, Manifest, read_evidence};
use rayon::prelude::*;

use crate::verify::verdict::Defect;

/// What is wrong inside the files of every set of a tree: the main one, and those below it that have
/// manifests of their own.
///
/// # Errors
/// If a set cannot be opened at all.
pub(crate) fn reopened(tree: &LabelTree, manifest: &Manifest) -> Result<Vec<Defect>, Fault> {
    let below = manifest.files.iter().filter_map(|file| {
        let (folder, name) = file.path.as_str().rsplit_once('/')?;
        (name.starts_with("manifest.") && name.ends_with(".json")).then_some(folder)
    });
    let mut folders: Vec<&str> = below.collect();
    folders.dedup();
    let mut defects = Vec::new();
    for folder in std::iter::once("").chain(folders) {
        let set = LabelSet::open(&tree.root().join(folder), None)?;
        defects.par_extend(set.keyframes().par_iter().filter_map(|key| open(&set, key)));
    }
    Ok(defects)
}

fn open(set: &LabelSet, key: &KeyframeKey) -> Option<Defect> {
    let labels = set.read_with(key, &Wanted::ALL).map(|_| ());
    let evidence = || match set.has_evidence(key) {
        true => read_evidence(&set.evidence(key), set.spec()).map(|_| ()),
        false => Ok(()),
    };
    let fault = labels.and_then(|()| evidence()).err()?;
    Some(Defect { fault, keyframe: Some((key.scene.clone(), key.token.clone())) })
}
