//! Keyframe after keyframe: read, mapped, written, noted.

use std::collections::BTreeMap;
use std::sync::Mutex;

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, KeyframeLabels, Wanted};
use occlabel_labels::{Begun, Journal, JournalEntry, LabelTree, TreePath};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::convert::job::Job;
use crate::interrupt::Interrupt;

/// What the journal keeps of a keyframe.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Summary {
    /// What the files do not say as the labels did.
    pub(crate) notes: Vec<String>,
    /// Voxels that nobody observed, and that are free in the files.
    pub(crate) unobserved_as_free: u64,
}

/// Converts the keyframes that are not finished, and gives the entries of all, in order.
pub(crate) fn write_all(
    job: &Job,
    tree: &LabelTree,
    begun: &mut Begun,
    interrupt: &Interrupt,
) -> Result<Vec<JournalEntry>, Fault> {
    let mut entries = std::mem::take(&mut begun.finished);
    entries.retain(|_, entry| !entry.summary.is_null());
    let name = |key: &KeyframeKey| (job.scene_of(key).to_owned(), key.token.clone());
    let open: Vec<_> = job.keys.iter().filter(|key| !entries.contains_key(&name(key))).collect();
    let sink = Mutex::new((&mut begun.journal, &mut entries));
    open.into_par_iter().try_for_each(|key| {
        if interrupt.is_raised() {
            return Ok(());
        }
        let entry = convert(job, tree, key)?;
        note(&sink, name(key), entry)
    })?;
    Ok(entries.into_values().collect())
}

type Entries = BTreeMap<(String, String), JournalEntry>;

fn note(
    sink: &Mutex<(&mut Journal, &mut Entries)>,
    name: (String, String),
    entry: JournalEntry,
) -> Result<(), Fault> {
    let mut sink = sink.lock().expect("no thread panics while it notes");
    sink.0.append(&entry)?;
    sink.1.insert(name, entry);
    Ok(())
}

/// Reads a keyframe and writes it in the other dialect.
fn convert(job: &Job, tree: &LabelTree, key: &KeyframeKey) -> Result<JournalEntry, Fault> {
    let mut labels = job.set.read_with(key, &Wanted::ALL)?;
    job.map.apply(labels.semantics.values_mut());
    let scene = job.scene_of(key);
    let encoded = job.to.encode(&labels, scene, &key.token)?;
    let write = |(path, bytes): &(TreePath, Vec<u8>)| {
        Ok(tree.write(path, bytes)?.of_keyframe(scene, &key.token))
    };
    let files = encoded.files.iter().map(write).collect::<Result<Vec<_>, Fault>>()?;
    let summary = Summary {
        notes: encoded.notes.iter().map(ToString::to_string).collect(),
        unobserved_as_free: unobserved_as_free(job, &labels),
    };
    let summary = serde_json::to_value(summary).expect("a summary is JSON");
    Ok(JournalEntry { scene: scene.to_owned(), keyframe: key.token.clone(), files, summary })
}

/// Voxels that nobody observed, where the other dialect has no way to say so.
fn unobserved_as_free(job: &Job, labels: &KeyframeLabels) -> u64 {
    let free = job.to.classes.free_index();
    match &labels.mask_lidar {
        Some(mask) if job.to.unobserved == "none" => {
            let pairs = labels.semantics.values().iter().zip(mask.values());
            pairs.filter(|(class, seen)| **class == free && **seen == 0).count() as u64
        }
        _ => 0,
    }
}
