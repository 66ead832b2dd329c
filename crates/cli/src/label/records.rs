//! What a run writes about itself: its record and the manifest.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use occlabel_core::{Fault, Taxonomy};
use occlabel_dialects::Annotations;
use occlabel_labels::{
    ClassRecord, FileRecord, GridRecord, InputHashes, InputRecord, JournalEntry, Manifest, Program,
    RunRecord, SceneRecord, TaxonomyRecord, json_hash,
};
use occlabel_logs::MeshFolder;
use occlabel_pipeline::Config;
use serde_json::Value;

use crate::label::job::Job;
use crate::label::plan::Plan;
use crate::label::planned_scene::PlannedScene;
use crate::label::targets::{LabelledGrid, Target};

/// What makes this run what it is.
pub(crate) fn run_record(job: &Job, plan: &Plan) -> Result<RunRecord, Fault> {
    let root = &job.args.log.input;
    let tables =
        job.opened.source.tables().into_iter().map(|path| InputRecord::of_table(root, path));
    let sweeps = plan.scenes.iter().flat_map(|scene| {
        let record = |(path, _): &(String, u64)| {
            Ok(InputRecord::of_sweep(root, path)?.of_scene(&scene.name))
        };
        scene.files.iter().map(record)
    });
    let masks = plan.scenes.iter().flat_map(|scene| scene.masks.iter().cloned().map(Ok));
    let meshes = mesh_records(job, plan);
    let inputs = tables.chain(sweeps).chain(masks).chain(meshes);
    let inputs = inputs.collect::<Result<Vec<_>, Fault>>()?;
    Ok(RunRecord::new(config_json(&job.opened.config), inputs))
}

/// The files of meshes, which need not stand below the log's root.
fn mesh_records<'a>(
    job: &'a Job,
    plan: &'a Plan,
) -> impl Iterator<Item = Result<InputRecord, Fault>> + 'a {
    let of_scene = |(root, scene): (&'a Path, &'a PlannedScene)| {
        let record = move |path| Ok(InputRecord::of_sweep(root, path)?.of_scene(&scene.name));
        scene.meshes.paths().map(record)
    };
    let folder = job.opened.meshes.iter().map(MeshFolder::root);
    folder.flat_map(|root| plan.scenes.iter().map(move |scene| (root, scene))).flat_map(of_scene)
}

fn config_json(config: &Config) -> Value {
    serde_json::to_value(config).expect("a configuration is JSON")
}

/// The manifest of what the run left of a label set. That of the main set lists the files of all.
pub(crate) fn manifest(
    job: &Job,
    plan: &Plan,
    record: &RunRecord,
    entries: &[JournalEntry],
    (grid, target): (&LabelledGrid, &Target),
) -> Manifest {
    let taxonomy = &grid.rules.taxonomy;
    let config = config_json(&grid.config);
    let input_hashes = InputHashes::of(&record.inputs);
    Manifest {
        program: Program::current(),
        preset: job.opened.preset.clone(),
        config_hash: json_hash(&config),
        config,
        inputs_hash: input_hashes.whole(),
        input_hashes,
        taxonomy: TaxonomyRecord {
            name: job.opened.config.taxonomy.file.clone(),
            hash: job.opened.taxonomy_hash.clone(),
        },
        dialect: target.dialect().map(|dialect| dialect.name.clone()),
        notes: target.notes.clone(),
        grid: GridRecord::new(grid.frame(), target.spec(grid)),
        classes: class_records(target, taxonomy),
        free: target.dialect().map_or(taxonomy.free.into(), |dialect| dialect.classes.free),
        scenes: scene_records(plan, entries),
        files: files_of(target, entries),
    }
}

/// The files of a set, by the paths they have in it.
fn files_of(target: &Target, entries: &[JournalEntry]) -> Vec<FileRecord> {
    let own = |entry: &JournalEntry, file: &FileRecord| {
        Some(target.own_record(file)?.of_keyframe(&entry.scene, &entry.keyframe))
    };
    let files = entries.iter().flat_map(|entry| entry.files.iter().map(move |file| (entry, file)));
    let mut files: Vec<_> = files.filter_map(|(entry, file)| own(entry, file)).collect();
    files.sort();
    files
}

/// The list of all keyframes that were finished.
pub(crate) fn annotations(plan: &Plan, entries: &[JournalEntry]) -> Annotations {
    let finished = finished(entries);
    let infos = |planned: &PlannedScene| {
        let mut infos = planned.infos.clone();
        infos.retain(|token, _| finished.contains(&(planned.name.as_str(), token.as_str())));
        (planned.name.clone(), infos)
    };
    Annotations::of_scenes(plan.scenes.iter().map(infos).collect())
}

fn finished(entries: &[JournalEntry]) -> BTreeSet<(&str, &str)> {
    entries.iter().map(|entry| (entry.scene.as_str(), entry.keyframe.as_str())).collect()
}

/// The planned scenes, with those keyframes that were finished.
fn scene_records(plan: &Plan, entries: &[JournalEntry]) -> BTreeMap<String, SceneRecord> {
    let finished = finished(entries);
    let record = |planned: &PlannedScene| {
        let mut record = planned.record.clone();
        record
            .keyframes
            .retain(|token| finished.contains(&(planned.name.as_str(), token.as_str())));
        (planned.name.clone(), record)
    };
    plan.scenes.iter().map(record).collect()
}

fn class_records(target: &Target, taxonomy: &Taxonomy) -> Vec<ClassRecord> {
    let record = |(id, name): (u16, &String)| ClassRecord { id, name: name.clone() };
    match target.dialect() {
        None => (0..).zip(&taxonomy.names).map(record).collect(),
        Some(dialect) => {
            let classes = dialect.classes.list.iter();
            classes.map(|class| record((class.id, &class.name))).collect()
        }
    }
}
