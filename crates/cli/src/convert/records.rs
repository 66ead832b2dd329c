//! What a conversion writes about itself.

use std::collections::BTreeMap;

use occlabel_core::Fault;
use occlabel_dialects::ClassTable;
use occlabel_labels::{
    ClassRecord, GridRecord, InputRecord, JournalEntry, Manifest, Program, RunRecord, SceneRecord,
    TaxonomyRecord, inputs_hash, json_hash,
};
use serde_json::{Map, Value, json};

use crate::convert::job::Job;
use crate::convert::report::Report;

/// What makes this conversion what it is.
pub(crate) fn run_record(job: &Job) -> Result<RunRecord, Fault> {
    let mut inputs = Vec::new();
    for path in job.keys.iter().flat_map(|key| job.set.files(key)) {
        inputs.push(InputRecord::of_sweep(&job.args.input, path)?);
    }
    Ok(RunRecord::new(config(job), inputs))
}

/// Both dialects, and what each class becomes.
fn config(job: &Job) -> Value {
    let (from, to) = (job.set.classes(), &job.to.classes);
    let becomes = |(at, class): (usize, &occlabel_dialects::Class)| {
        (class.name.clone(), json!(name_of(to, job.map.table()[at])))
    };
    let classes: Map<String, Value> = from.list.iter().enumerate().map(becomes).collect();
    json!({ "convert": {
        "from": job.set.dialect(),
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
    Manifest {
        program: Program::current(),
        preset: None,
        config: record.config.clone(),
        config_hash: record.config_hash.clone(),
        inputs_hash: inputs_hash(&record.inputs),
        dialect: Some(job.to.name.clone()),
        taxonomy: TaxonomyRecord { name: job.to.name.clone(), hash: json_hash(classes) },
        grid: GridRecord::new(job.set.frame(), job.set.spec()),
        classes: classes.list.iter().map(class_record).collect(),
        free: classes.free,
        notes: report.lines(),
        scenes: scenes(job, entries),
        files,
    }
}

fn class_record(class: &occlabel_dialects::Class) -> ClassRecord {
    ClassRecord { id: class.id, name: class.name.clone() }
}

/// The scenes: what the labels' own manifest says of them, with what was converted.
fn scenes(job: &Job, entries: &[JournalEntry]) -> BTreeMap<String, SceneRecord> {
    let mut scenes: BTreeMap<String, SceneRecord> = BTreeMap::new();
    for key in &job.keys {
        let known = || job.set.scene(&key.scene).map(|scene| mapped(job, scene));
        let scene = scenes.entry(job.scene_of(key).to_owned());
        let scene = scene.or_insert_with(|| known().unwrap_or_default());
        scene.keyframes.push(key.token.clone());
    }
    debug_assert_eq!(entries.len(), job.keys.len());
    scenes
}

/// A scene without its keyframes, the classes of its tracks as they are now called.
fn mapped(job: &Job, scene: &SceneRecord) -> SceneRecord {
    let mut scene = SceneRecord { keyframes: Vec::new(), ..scene.clone() };
    let from = job.set.classes();
    for track in &mut scene.tracks {
        let at = track.class.as_ref().and_then(|name| from.names().iter().position(|n| n == name));
        let becomes = at.and_then(|at| name_of(&job.to.classes, job.map.table()[at]));
        track.class = becomes.map(str::to_owned);
    }
    scene
}
