//! What a conversion loses or changes, printed and in the manifest.

use std::collections::BTreeSet;

use occlabel_labels::JournalEntry;
use serde_json::{Value, json};

use crate::console::Console;
use crate::convert::job::{Job, NO_SCENE};
use crate::convert::writer::Summary;

/// What became of it.
pub(crate) struct Report {
    from: String,
    to: String,
    keyframes: usize,
    bytes: u64,
    /// What classes lose.
    classes: Vec<occlabel_dialects::Remark>,
    /// What else the files do not say as the labels did.
    notes: Vec<String>,
}

impl Report {
    pub(crate) fn of(job: &Job, entries: &[JournalEntry]) -> Self {
        Self {
            from: job.set.dialect().name.clone(),
            to: job.to.name.clone(),
            keyframes: entries.len(),
            bytes: entries.iter().flat_map(|entry| &entry.files).map(|file| file.bytes).sum(),
            classes: job.map.remarks().to_vec(),
            notes: notes(job, entries),
        }
    }

    /// What is lost or changed, line by line.
    pub(crate) fn lines(&self) -> Vec<String> {
        let classes = self.classes.iter().map(ToString::to_string);
        classes.chain(self.notes.iter().cloned()).collect()
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "from": self.from,
            "to": self.to,
            "keyframes": self.keyframes,
            "bytes": self.bytes,
            "classes": self.classes,
            "notes": self.notes,
        })
    }

    pub(crate) fn print(&self, console: &Console, as_json: bool) {
        if as_json {
            return console.result(&self.json().to_string());
        }
        let Self { from, to, keyframes, bytes, .. } = self;
        console.result(&format!("{keyframes} keyframes from {from} to {to}, {bytes} bytes"));
        self.lines().iter().for_each(|line| console.result(&format!("  {line}")));
    }
}

fn notes(job: &Job, entries: &[JournalEntry]) -> Vec<String> {
    let summary = |entry: &JournalEntry| serde_json::from_value(entry.summary.clone()).ok();
    let summaries: Vec<Summary> = entries.iter().filter_map(summary).collect();
    let unobserved: u64 = summaries.iter().map(|summary| summary.unobserved_as_free).sum();
    let told: BTreeSet<String> = summaries.into_iter().flat_map(|summary| summary.notes).collect();
    let mut notes: Vec<String> = told.into_iter().collect();
    if unobserved > 0 {
        notes.push(format!("unobserved: {unobserved} voxels that nobody observed are free here"));
    }
    notes.extend(job.to.grid_notes(job.set.frame(), job.set.spec()));
    if !job.to.layout.path().contains("{scene}") {
        notes.push("scenes: the files do not tell them".to_owned());
    }
    if job.keys.iter().any(|key| key.scene.is_empty()) {
        notes.push(format!("scenes: not known, all keyframes are of the scene `{NO_SCENE}`"));
    }
    notes
}
