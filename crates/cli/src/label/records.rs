//! What a run writes about itself: its record and the manifest.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_labels::{
    ClassRecord, GridRecord, InputMark, InputRecord, JournalEntry, Manifest, Program, RunRecord,
    SceneRecord, TaxonomyRecord, inputs_hash,
};
use occlabel_pipeline::{Config, GridFrame};
use serde_json::Value;

use crate::label::Job;
use crate::label::plan::Plan;
use crate::label::planned_scene::PlannedScene;

/// What makes this run what it is.
pub(crate) fn run_record(job: &Job, plan: &Plan) -> Result<RunRecord, Fault> {
    let root = &job.args.log.input;
    let tables =
        job.opened.source.tables().into_iter().map(|path| InputRecord::of_table(root, path));
    let sweeps = plan.files().map(|(path, _)| Ok(sweep_record(root, path)));
    let inputs = tables.chain(sweeps).collect::<Result<Vec<_>, Fault>>()?;
    Ok(RunRecord::new(config_json(&job.opened.config), inputs))
}

/// The record of a sweep. One that cannot even be looked at counts as empty: reading it will tell.
fn sweep_record(root: &Path, path: &str) -> InputRecord {
    InputRecord::of_sweep(root, path).unwrap_or_else(|_| InputRecord {
        path: path.to_owned(),
        bytes: 0,
        mark: InputMark::MtimeNs(0),
    })
}

fn config_json(config: &Config) -> Value {
    serde_json::to_value(config).expect("a configuration is JSON")
}

/// The manifest of what the run left.
pub(crate) fn manifest(
    job: &Job,
    plan: &Plan,
    record: &RunRecord,
    entries: &[JournalEntry],
) -> Manifest {
    let rules = &job.opened.rules;
    let frame = match rules.frame {
        GridFrame::Ego => "ego",
        GridFrame::Lidar => "lidar",
    };
    let mut files: Vec<_> = entries.iter().flat_map(|entry| entry.files.clone()).collect();
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Manifest {
        program: Program::current(),
        preset: job.opened.preset.clone(),
        config: record.config.clone(),
        config_hash: record.config_hash.clone(),
        inputs_hash: inputs_hash(&record.inputs),
        dialect: None,
        taxonomy: TaxonomyRecord {
            name: job.opened.config.taxonomy.file.clone(),
            hash: job.opened.taxonomy_hash.clone(),
        },
        grid: GridRecord::new(frame, &rules.spec),
        classes: class_records(&rules.taxonomy.names),
        free: u16::from(rules.taxonomy.free),
        notes: Vec::new(),
        scenes: scene_records(plan, entries),
        files,
    }
}

/// The planned scenes, with those keyframes that were finished.
fn scene_records(plan: &Plan, entries: &[JournalEntry]) -> BTreeMap<String, SceneRecord> {
    let is_finished = |scene: &str, token: &str| {
        entries.iter().any(|entry| entry.scene == scene && entry.keyframe == token)
    };
    let record = |planned: &PlannedScene| {
        let mut record = planned.record.clone();
        record.keyframes.retain(|token| is_finished(&planned.name, token));
        (planned.name.clone(), record)
    };
    plan.scenes.iter().map(record).collect()
}

fn class_records(names: &[String]) -> Vec<ClassRecord> {
    let record = |(id, name): (usize, &String)| ClassRecord { id: id as u16, name: name.clone() };
    names.iter().enumerate().map(record).collect()
}
