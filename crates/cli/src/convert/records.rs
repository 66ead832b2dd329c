//! What a conversion writes about itself.

use std::collections::{BTreeMap, BTreeSet};

use occlabel_core::Fault;
use occlabel_dialects::{Class, ClassTable, KeyframeKey};
use occlabel_disk as disk;
use occlabel_labels::{
    ClassRecord, GridRecord, InputHashes, InputRecord, JournalEntry, Manifest, Program, RunRecord,
    SceneRecord, TaxonomyRecord, json_hash,
};
use serde_json::{Map, Value, json};

use crate::convert::job::{Job, NO_SCENE};
use crate::convert::report::Report;

/// What makes this conversion what it is.
pub(crate) fn run_record(job: &Job) -> Result<RunRecord, Fault> {
    let files: BTreeSet<String> = job.keys.iter().flat_map(|key| files_of(job, key)).collect();
    let record = |path: String| InputRecord::of_sweep(&job.args.input, path);
    let inputs = files.into_iter().map(record).collect::<Result<Vec<_>, Fault>>()?;
    Ok(RunRecord::new(config(job), inputs))
}

/// The files of a keyframe that are there, from the folder that was given.
fn files_of(job: &Job, key: &KeyframeKey) -> Vec<String> {
    let arrays = job.set.dialect().layout.arrays().iter().map(|array| array.name.as_str());
    let places = arrays.chain([""]).map(|name| job.set.place(key, name));
    let inside = |place: std::path::PathBuf| {
        let path = place.strip_prefix(&job.args.input).ok()?;
        disk::is_file(&place).then(|| path.display().to_string())
    };
    places.filter_map(inside).collect()
}

/// Both dialects, and what each class becomes.
fn config(job: &Job) -> Value {
    let (from, to) = (job.set.classes(), &job.to.classes);
    let becomes = |(at, class): (usize, &Class)| {
        (class.name.clone(), json!(name_of(to, job.map.table()[at])))
    };
    let classes: Map<String, Value> = from.list.iter().enumerate().map(becomes).collect();
    json!({ "convert": {
        "from": job.set.dialect().name,
        "to": job.to.name,
        "classes": classes,
        "scenes": job.args.scenes,
    }})
}

/// The name of a class by its index, `free`, or null for no label.
fn name_of(table: &ClassTable, index: u8) -> Option<&str> {
    match table.list.get(usize::from(index)) {
        Some(class) => Some(&class.name),
        None => (index == table.free_index()).then_some("free"),
    }
}

/// The manifest of what was written.
pub(crate) fn manifest(
    job: &Job,
    record: &RunRecord,
    entries: &[JournalEntry],
    report: &Report,
) -> Manifest {
    let classes = &job.to.classes;
    let mut files: Vec<_> = entries.iter().flat_map(|entry| entry.files.clone()).collect();
    files.sort_by(|a, b| a.path.cmp(&b.path));
    let input_hashes = InputHashes::of(&record.inputs);
    Manifest {
        program: Program::current(),
        preset: None,
        config: record.config.clone(),
        config_hash: record.config_hash.clone(),
        inputs_hash: input_hashes.whole(),
        input_hashes,
        dialect: Some(job.to.name.clone()),
        taxonomy: TaxonomyRecord { name: job.to.name.clone(), hash: json_hash(classes) },
        grid: GridRecord::new(job.set.frame(), job.set.spec()),
        classes: classes.list.iter().map(class_record).collect(),
        free: classes.free,
        notes: report.lines(),
        scenes: scenes(job),
        files,
    }
}

fn class_record(class: &Class) -> ClassRecord {
    ClassRecord { id: class.id, name: class.name.clone() }
}

/// The scenes with what was converted of them; in order of time where the labels' own manifest tells it,
/// with what else that says.
fn scenes(job: &Job) -> BTreeMap<String, SceneRecord> {
    let mut tokens: BTreeMap<&str, Vec<&String>> = BTreeMap::new();
    for key in &job.keys {
        tokens.entry(&key.scene).or_default().push(&key.token);
    }
    let record = |scene: &str, tokens: Vec<&String>| match job.scenes.get(scene) {
        Some(known) => {
            let mut record = mapped(job, known);
            record.keyframes.retain(|token| tokens.contains(&token));
            record
        }
        None => {
            let keyframes = tokens.into_iter().cloned().collect();
            SceneRecord { keyframes, ..SceneRecord::default() }
        }
    };
    let named = |scene: &str| if scene.is_empty() { NO_SCENE } else { scene }.to_owned();
    tokens.into_iter().map(|(scene, tokens)| (named(scene), record(scene, tokens))).collect()
}

/// A scene, the classes of its tracks as they are now called.
fn mapped(job: &Job, scene: &SceneRecord) -> SceneRecord {
    let mut scene = scene.clone();
    let from = job.set.classes();
    for track in &mut scene.tracks {
        let at = track.class.as_ref().and_then(|name| from.names().iter().position(|n| n == name));
        let becomes = at.and_then(|at| name_of(&job.to.classes, job.map.table()[at]));
        track.class = becomes.map(str::to_owned);
    }
    scene
}
