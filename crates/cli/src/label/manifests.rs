//! The end of a run: the manifests of all that it wrote.

use std::collections::BTreeSet;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::{Begun, FileRecord, JournalEntry, LabelTree, Manifest, RunRecord, TreePath};

use crate::label::job::Job;
use crate::label::plan::Plan;
use crate::label::records;

/// The main set's manifest, which lists those of the others, and the lists of keyframes, all of them
/// written by now.
pub(crate) fn write_manifests(
    job: &Job,
    tree: &LabelTree,
    plan: &Plan,
    record: &RunRecord,
    entries: &[JournalEntry],
    begun: &Begun,
) -> Result<Manifest, Fault> {
    let mut manifests = Vec::new();
    let mut of_all = Vec::new();
    for target in job.targets.all() {
        let folder = target.1.folder.as_deref();
        let mut manifest = records::manifest(job, plan, record, entries, target);
        if let Some(stem) = target.1.list_stem() {
            let list = records::annotations(plan, entries);
            let file = begun.write_of_all(folder, stem, &list)?;
            manifest.files.extend(target.1.own_record(&file).filter(|_| folder.is_some()));
            of_all.push(file);
        }
        manifest.files.sort();
        if folder.is_some() {
            of_all.push(begun.write_of_all(folder, "manifest", &manifest)?);
        }
        manifests.push(manifest);
    }
    let mut main = manifests.swap_remove(0);
    main.files.extend(of_all);
    main.files.extend(earlier_manifests(tree, &main)?);
    main.files.sort();
    Ok(main)
}

/// The manifests of sets that an earlier run wrote below the tree, and this one does not.
fn earlier_manifests(tree: &LabelTree, main: &Manifest) -> Result<Vec<FileRecord>, Fault> {
    let listed = |path: &TreePath| main.files.iter().any(|file| file.path == *path);
    let folders: BTreeSet<&str> =
        main.files.iter().filter_map(|file| Some(file.path.as_str().split_once('/')?.0)).collect();
    let paths = folders.into_iter().map(|folder| TreePath::new(format!("{folder}/manifest.json")));
    let paths = paths.collect::<Result<Vec<_>, _>>()?.into_iter();
    let theirs = paths.filter(|path| !listed(path) && disk::is_file(&tree.place(path)));
    theirs.map(|path| FileRecord::of_file(tree, path)).collect()
}
