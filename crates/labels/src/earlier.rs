//! What an earlier run left in the tree.

use std::collections::{BTreeMap, BTreeSet};

use occlabel_core::Fault;
use serde_json::{Map, Value, json};

use crate::atomic::{remove_empty_dirs, remove_file};
use crate::differences::differences;
use crate::{
    FileRecord, InputHashes, InputRecord, JournalEntry, LabelTree, Manifest, RunFiles, RunRecord,
    TreePath, WriterLock, journal, json,
};

/// The records of an earlier run: of one that was interrupted, of one that ended, or of both.
pub(crate) struct Earlier {
    run: Option<RunRecord>,
    journal: Vec<JournalEntry>,
    manifest: Option<Manifest>,
    /// What the report says of the inputs, their times included.
    inputs_mark: Option<String>,
}

impl Earlier {
    /// Reads what is there.
    pub(crate) fn load(files: &RunFiles) -> Result<Self, Fault> {
        Ok(Self {
            run: json::read(&files.run())?,
            journal: journal::read(&files.journal())?,
            manifest: Manifest::load(&files.manifest())?,
            inputs_mark: reported_mark(files)?,
        })
    }

    /// In what the earlier run differs from this one. An unfinished run knows its inputs one by
    /// one; a finished one only their hash.
    pub(crate) fn differences(&self, now: &RunRecord) -> Vec<String> {
        match (&self.run, &self.manifest) {
            (Some(run), _) => differences(&by_key(run), &by_key(now)),
            (None, Some(manifest)) => self.differences_of_finished(manifest, now),
            (None, None) => Vec::new(),
        }
    }

    /// The same of a run over other scenes, perhaps: of what all its scenes share.
    pub(crate) fn differences_in_kind(&self, now: &RunRecord) -> Vec<String> {
        let before = match (&self.run, &self.manifest) {
            (Some(run), _) => kind(run),
            (None, Some(manifest)) => json!({
                "program": manifest.program, "config": manifest.config,
                "inputs": manifest.input_hashes.shared,
            }),
            (None, None) => return Vec::new(),
        };
        differences(&before, &kind(now))
    }

    /// The manifest knows no times of sweeps, the report beside it does.
    fn differences_of_finished(&self, manifest: &Manifest, now: &RunRecord) -> Vec<String> {
        let mut found = differences(&manifest_identity(manifest), &identity(now));
        let is_touched = self.inputs_mark.as_ref().is_some_and(|mark| *mark != inputs_mark(now));
        if found.is_empty() && is_touched {
            found.push("inputs: sweeps were changed since".to_owned());
        }
        found
    }

    /// Whether there is a manifest, and a run of this record would write the same.
    pub(crate) fn manifest_is_of(&self, now: &RunRecord) -> bool {
        let manifest = self.manifest.as_ref();
        manifest.is_some_and(|manifest| manifest_identity(manifest) == identity(now))
    }

    /// The keyframes whose files stand, by scene and token.
    pub(crate) fn finished(&self, tree: &LabelTree) -> BTreeMap<(String, String), JournalEntry> {
        let listed = self.manifest.iter().flat_map(entries_of);
        let entries = listed.chain(self.journal.iter().cloned());
        entries
            .filter(|entry| entry.stands(tree))
            .map(|entry| ((entry.scene.clone(), entry.keyframe.clone()), entry))
            .collect()
    }

    /// The keyframes that a shard's scenes have in the whole run that it was merged into, if they were made
    /// of the same inputs and their files stand. Its own records left then.
    pub(crate) fn merged(
        files: &RunFiles,
        now: &RunRecord,
    ) -> Result<BTreeMap<(String, String), JournalEntry>, Fault> {
        let whole = match files.as_shard() {
            Some(_) => Self::load(&RunFiles::whole(files.tree().clone()))?,
            None => return Ok(BTreeMap::new()),
        };
        let before = whole.manifest.as_ref().map(|manifest| &manifest.input_hashes.scenes);
        let now = InputHashes::of(&now.inputs).scenes;
        let is_same = |scene: &String| {
            let before = before.and_then(|scenes| scenes.get(scene));
            before.is_some() && before == now.get(scene)
        };
        let finished = whole.finished(files.tree()).into_iter();
        Ok(finished.filter(|((scene, _), _)| is_same(scene)).collect())
    }

    /// Removes all files of the earlier run, its records last, and the folders that this empties.
    pub(crate) fn remove(&self, files: &RunFiles) -> Result<(), Fault> {
        let (tree, paths) = (files.tree(), self.paths());
        let scenes: BTreeSet<_> = paths.iter().filter_map(|path| path.scene()).collect();
        let locks = scenes.into_iter().map(|scene| WriterLock::of_scene(tree, scene));
        let locks = locks.collect::<Result<Vec<_>, Fault>>()?;
        for path in &paths {
            remove_file(&tree.place(path))?;
        }
        for record in [files.manifest(), files.report(), files.journal(), files.run()] {
            remove_file(&record)?;
        }
        drop(locks);
        for path in &paths {
            remove_empty_dirs(tree.place(path).parent().unwrap_or(tree.root()), tree.root());
        }
        Ok(())
    }

    /// Removes what tells of all keyframes: such as the manifests of label sets below the tree.
    pub(crate) fn remove_files_of_all(&self, tree: &LabelTree) -> Result<(), Fault> {
        let listed = self.manifest.iter().flat_map(|manifest| &manifest.files);
        let mut of_all = listed.filter(|file| file.keyframe().is_none());
        of_all.try_for_each(|file| remove_file(&tree.place(&file.path)))
    }

    fn paths(&self) -> BTreeSet<&TreePath> {
        let noted = self.journal.iter().flat_map(|entry| &entry.files);
        let listed = self.manifest.iter().flat_map(|manifest| &manifest.files);
        noted.chain(listed).map(|file| &file.path).collect()
    }
}

/// The key of a report under which the mark of the inputs stands.
const INPUTS_MARK: &str = "inputs_mark";

/// A mark of a run's inputs, sizes and times of sweeps included.
fn inputs_mark(run: &RunRecord) -> String {
    json::json_hash(&run.inputs)
}

/// Puts the mark of a run's inputs into its report.
pub(crate) fn mark_report(report: &mut Value, run: &RunRecord) {
    if let Some(report) = report.as_object_mut() {
        report.insert(INPUTS_MARK.to_owned(), json!(inputs_mark(run)));
    }
}

/// None if there is no report, or none of ours.
fn reported_mark(files: &RunFiles) -> Result<Option<String>, Fault> {
    let bytes = json::read_bounded(&files.report())?.unwrap_or_default();
    let report: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    Ok(report.get(INPUTS_MARK).and_then(Value::as_str).map(str::to_owned))
}

/// The keyframes of a manifest, each with its files.
fn entries_of(manifest: &Manifest) -> Vec<JournalEntry> {
    let mut files: BTreeMap<(&str, &str), Vec<FileRecord>> = BTreeMap::new();
    for file in &manifest.files {
        let Some(keyframe) = file.keyframe() else { continue };
        files.entry(keyframe).or_default().push(file.clone());
    }
    let keyframes = manifest.scenes.iter().flat_map(|(scene, record)| {
        record.keyframes.iter().map(move |keyframe| (scene.as_str(), keyframe.as_str()))
    });
    let with_files = |keyframe| Some((keyframe, files.remove(&keyframe)?));
    let entry = |((scene, keyframe), files): ((&str, &str), Vec<FileRecord>)| {
        let (scene, keyframe) = (scene.to_owned(), keyframe.to_owned());
        JournalEntry { scene, keyframe, files, summary: Value::Null }
    };
    keyframes.filter_map(with_files).map(entry).collect()
}

/// A run's record with its inputs by path.
fn by_key(run: &RunRecord) -> Value {
    let inputs: Map<_, _> = run.inputs.iter().map(input_by_key).collect();
    json!({"program": run.program, "config": run.config, "inputs": inputs})
}

fn input_by_key(input: &InputRecord) -> (String, Value) {
    let mut value = json!(input);
    if let Some(fields) = value.as_object_mut() {
        fields.remove("path");
    }
    (input.path.clone(), value)
}

/// What all shards of a run have alike.
fn kind(run: &RunRecord) -> Value {
    let shared = InputHashes::of(&run.inputs).shared;
    json!({"program": run.program, "config": run.config, "inputs": shared})
}

/// What of a run's record stands in its manifest.
fn identity(run: &RunRecord) -> Value {
    let inputs = InputHashes::of(&run.inputs).whole();
    json!({"program": run.program, "config": run.config, "inputs_hash": inputs})
}

fn manifest_identity(manifest: &Manifest) -> Value {
    let inputs = &manifest.inputs_hash;
    json!({"program": manifest.program, "config": manifest.config, "inputs_hash": inputs})
}
