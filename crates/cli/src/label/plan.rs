//! What will be labelled, found out from the tables alone: before any sweep is read, every fault
//! that the tables and the folders show is known.

use std::collections::BTreeSet;
use std::fs;

use occlabel_core::{Fault, Keyframe, Scene};
use occlabel_labels::{ClassRecord, SceneRecord, TrackRecord};
use occlabel_logs::SceneSource;
use occlabel_pipeline::MemoryModel;

use crate::console::Console;
use crate::exit::Stop;
use crate::label::Job;
use crate::label::findings::Findings;

/// Bytes of a point in the largest of our formats' sweeps, to tell points from file sizes.
const BYTES_A_POINT: u64 = 16;

/// The scenes of a run.
pub(crate) struct Plan {
    pub(crate) scenes: Vec<PlannedScene>,
}

/// A scene that will be labelled.
pub(crate) struct PlannedScene {
    pub(crate) name: String,
    /// What the manifest says of it.
    pub(crate) record: SceneRecord,
    /// Files of its sweeps, relative to the log's root, with their sizes.
    pub(crate) files: Vec<(String, u64)>,
    /// How many keyframes at once, and in how many shards of rays each.
    pub(crate) at_once: (usize, usize),
    sweeps: usize,
}

/// Why a scene cannot be labelled.
enum Refused {
    /// It has no point labels, and no class for such points: a matter of configuration.
    NoLabels(Fault),
    /// The log would not have it.
    Broken(Vec<Fault>),
}

impl Plan {
    /// Looks at every wanted scene.
    pub(crate) fn make(job: &Job, findings: &mut Findings) -> Result<Self, Stop> {
        let names = wanted(job);
        let mut wanted_keyframes: BTreeSet<&str> =
            job.args.keyframes.iter().map(String::as_str).collect();
        let (mut scenes, mut unlabelled, mut faults) = (Vec::new(), Vec::new(), Vec::new());
        for name in &names {
            match plan_scene(job, name, &mut wanted_keyframes, findings) {
                Ok(scene) => scenes.extend(scene),
                Err(Refused::NoLabels(fault)) => unlabelled.push((name.clone(), fault)),
                Err(Refused::Broken(found)) => {
                    faults.extend(found.into_iter().map(|fault| (name.clone(), fault)));
                }
            }
        }
        if let Some(token) = wanted_keyframes.first() {
            return Err(Stop::usage(unknown_keyframe(token)));
        }
        if !unlabelled.is_empty() && scenes.is_empty() && faults.is_empty() {
            return Err(Stop::Usage(unlabelled.into_iter().map(|(_, fault)| fault).collect()));
        }
        faults.extend(unlabelled);
        if !faults.is_empty() && !job.skips() {
            return Err(Stop::Failed(faults.into_iter().map(|(_, fault)| fault).collect()));
        }
        for (scene, fault) in faults {
            job.console.warning(&scene, &fault);
            findings.lose(&scene, fault);
        }
        Ok(Self { scenes })
    }

    /// How many keyframes there are to label.
    pub(crate) fn keyframes(&self) -> usize {
        self.scenes.iter().map(|scene| scene.record.keyframes.len()).sum()
    }

    /// The files of all sweeps, with their sizes.
    pub(crate) fn files(&self) -> impl Iterator<Item = &(String, u64)> {
        self.scenes.iter().flat_map(|scene| &scene.files)
    }

    /// `--dry-run`.
    pub(crate) fn print(&self, console: &Console) {
        for scene in &self.scenes {
            console.result(&scene.line());
        }
        let bytes: u64 = self.files().map(|(_, bytes)| bytes).sum();
        console.result(&format!(
            "{} scenes, {} keyframes, {bytes} bytes of sweeps; nothing written",
            self.scenes.len(),
            self.keyframes(),
        ));
    }
}

impl PlannedScene {
    fn line(&self) -> String {
        let bytes: u64 = self.files.iter().map(|(_, bytes)| bytes).sum();
        let (keyframes, points) = (self.record.keyframes.len(), bytes / BYTES_A_POINT);
        format!(
            "{}: {keyframes} keyframes, {} sweeps, about {points} points, {} rays, {bytes} bytes",
            self.name,
            self.sweeps,
            points * keyframes as u64,
        )
    }
}

/// The scenes of this run's shard.
fn wanted(job: &Job) -> Vec<String> {
    let names = job.opened.source.scene_names();
    match job.args.shard {
        None => names,
        Some(shard) => names.into_iter().skip(shard.index).step_by(shard.count).collect(),
    }
}

/// Looks at a scene; none if no wanted keyframe is in it.
fn plan_scene(
    job: &Job,
    name: &str,
    wanted: &mut BTreeSet<&str>,
    findings: &mut Findings,
) -> Result<Option<PlannedScene>, Refused> {
    let scene = job.opened.source.load(name).map_err(|fault| Refused::Broken(vec![fault]))?;
    let keyframes = chosen_keyframes(job, &scene, wanted);
    if keyframes.is_empty() && !job.args.keyframes.is_empty() {
        return Ok(None);
    }
    job.opened.rules.check_labels(&scene).map_err(Refused::NoLabels)?;
    for fault in &scene.warnings {
        job.console.warning(name, fault);
        findings.warn(name, fault.clone());
    }
    refuse_losses(job, &scene, findings)?;
    let files = present_files(job, &scene, findings)?;
    let at_once = fit(job, &scene, &files)?;
    let record = scene_record(job, &scene, keyframes);
    let name = name.to_owned();
    Ok(Some(PlannedScene { name, record, files, at_once, sweeps: scene.sweeps.len() }))
}

fn chosen_keyframes(job: &Job, scene: &Scene, wanted: &mut BTreeSet<&str>) -> Vec<String> {
    let all = job.args.keyframes.is_empty();
    let is_chosen = |keyframe: &&Keyframe| {
        wanted.remove(keyframe.token.as_str())
            || all
            || job.args.keyframes.contains(&keyframe.token)
    };
    scene.keyframes.iter().filter(is_chosen).map(|keyframe| keyframe.token.clone()).collect()
}

/// Records that the reader refused.
fn refuse_losses(job: &Job, scene: &Scene, findings: &mut Findings) -> Result<(), Refused> {
    let faults = scene.refused.iter().map(|refusal| refusal.fault.clone());
    if !job.skips() && !scene.refused.is_empty() {
        return Err(Refused::Broken(faults.collect()));
    }
    for fault in faults {
        job.console.warning(&scene.name, &fault);
        findings.lose(&scene.name, fault);
    }
    Ok(())
}

/// The files of the scene's sweeps that are there. Those that are not are all told at once.
fn present_files(
    job: &Job,
    scene: &Scene,
    findings: &mut Findings,
) -> Result<Vec<(String, u64)>, Refused> {
    let root = &job.args.log.input;
    let (mut present, mut missing) = (Vec::new(), Vec::new());
    for (at, sweep) in scene.sweeps.iter().enumerate() {
        for file in job.opened.source.sweep_files(sweep) {
            match fs::metadata(root.join(&file)) {
                Ok(meta) => present.push((file, meta.len())),
                Err(error) => missing.push((at, file, error)),
            }
        }
    }
    if missing.is_empty() {
        return Ok(present);
    }
    let is_reference = |at: usize| scene.keyframes.iter().any(|keyframe| keyframe.sweep == at);
    let is_allowed = |at| job.skips() || (job.args.allow_missing_sweeps && !is_reference(at));
    let about =
        about_missing(&missing.iter().map(|(_, file, _)| file).collect::<Vec<_>>(), &present);
    let faults = missing.iter().map(|(at, file, error)| {
        let fault = Fault::new("missing-file", file.clone(), "a sweep's file", error.to_string());
        if is_reference(*at) { fault.record("reference sweep of a keyframe") } else { fault }
    });
    if !missing.iter().all(|(at, ..)| is_allowed(*at)) {
        return Err(Refused::Broken(std::iter::once(about).chain(faults).collect()));
    }
    for fault in std::iter::once(about).chain(faults) {
        job.console.warning(&scene.name, &fault);
        findings.lose(&scene.name, fault);
    }
    Ok(present)
}

/// One line about all that is missing: how many, and about how many bytes.
fn about_missing(missing: &[&String], present: &[(String, u64)]) -> Fault {
    let mut sizes: Vec<u64> = present.iter().map(|(_, bytes)| *bytes).collect();
    sizes.sort_unstable();
    let typical = sizes.get(sizes.len() / 2).copied().unwrap_or(0);
    let files = missing.len() + present.len();
    let found = format!(
        "{} of them missing, about {} bytes",
        missing.len(),
        typical * missing.len() as u64
    );
    Fault::new(
        "missing-files",
        missing[0].clone(),
        format!("all {files} files of the scene"),
        found,
    )
    .hint("--allow-missing-sweeps labels without them, as far as keyframes keep theirs")
}

/// How many keyframes fit into memory at once.
fn fit(job: &Job, scene: &Scene, files: &[(String, u64)]) -> Result<(usize, usize), Refused> {
    let bytes: u64 = files.iter().map(|(_, bytes)| bytes).sum();
    let model = MemoryModel::new(bytes / BYTES_A_POINT, &job.opened.rules.spec);
    model.plan(job.threads, job.args.memory).map_err(|needed| {
        let limit = job.args.memory.unwrap_or(u64::MAX);
        let (expected, found) =
            (format!("a scene within {limit} bytes"), format!("{needed} bytes needed"));
        Refused::Broken(vec![
            Fault::new("memory", &scene.name, expected, found)
                .hint("raise --memory or coarsen the grid"),
        ])
    })
}

fn scene_record(job: &Job, scene: &Scene, keyframes: Vec<String>) -> SceneRecord {
    let names = &job.opened.rules.taxonomy.names;
    let track = |track: &occlabel_core::BoxTrack| TrackRecord {
        index: track.id.0,
        id: track.source_id.clone(),
        class: track.class().map(|class| names[class.index()].clone()),
        category: track.category.clone(),
    };
    SceneRecord {
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        tracks: scene.tracks.iter().map(track).collect(),
        keyframes,
    }
}

/// The classes as the manifest lists them.
pub(crate) fn class_records(names: &[String]) -> Vec<ClassRecord> {
    let record = |(id, name): (usize, &String)| ClassRecord { id: id as u8, name: name.clone() };
    names.iter().enumerate().map(record).collect()
}

fn unknown_keyframe(token: &str) -> Fault {
    Fault::new(
        "keyframes",
        "--keyframes",
        "tokens of keyframes of the wanted scenes",
        format!("`{token}`"),
    )
    .hint("`occlabel inspect` lists them")
}
