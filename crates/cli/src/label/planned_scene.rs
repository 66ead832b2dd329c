//! A scene that will be labelled, and why one will not.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use occlabel_core::{BoxTrack, Exposure, Fault, Keyframe, Loss, Scene};
use occlabel_dialects::KeyframeInfo;
use occlabel_disk as disk;
use occlabel_labels::{InputRecord, PoseRecord, SceneRecord, TrackRecord};
use occlabel_logs::{Inventory, MissingFile, check_poses};
use occlabel_pipeline::{Cost, MemoryModel, SceneWork};
use occlabel_simulate::World;

use crate::label::findings::Findings;
use crate::label::job::Job;
use crate::label::meshes::PlannedMeshes;
use crate::label::scene_run::Finished;
use crate::label::targets::LabelledGrid;
use crate::lacks::lacks;

/// A scene that will be labelled.
pub(crate) struct PlannedScene {
    pub(crate) name: String,
    /// What the manifest says of it, all its keyframes included.
    pub(crate) record: SceneRecord,
    /// What lists of keyframes say of it, where a target has one.
    pub(crate) infos: BTreeMap<String, KeyframeInfo>,
    /// The keyframes that are asked for.
    pub(crate) wanted: BTreeSet<String>,
    /// Files of its sweeps, relative to the log's root, with their sizes.
    pub(crate) files: Vec<(String, u64)>,
    /// The masks that paint its points.
    pub(crate) masks: Vec<InputRecord>,
    /// Who is known by their surface.
    pub(crate) meshes: PlannedMeshes,
    /// How many keyframes at once, and in how many shards of rays each.
    pub(crate) at_once: (usize, usize),
    /// An upper estimate of the memory that takes.
    pub(crate) memory_bytes: u64,
    pub(crate) sweeps: usize,
    /// What was told of it.
    told: Vec<Fault>,
    /// An upper estimate of its points.
    pub(crate) points: u64,
    /// What there is to do, by the grids that are labelled.
    pub(crate) work: Vec<SceneWork>,
}

/// Why a scene cannot be labelled.
pub(crate) enum Refused {
    /// The configuration asks for what it does not have: a lidar, or point labels.
    Configuration(Fault),
    /// The log or the machine would not have it.
    Broken(Vec<Fault>),
}

impl PlannedScene {
    /// Looks at a scene, and takes its keyframes from the wanted `tokens`; none if it has none of
    /// them.
    pub(crate) fn plan(
        job: &Job,
        name: &str,
        tokens: &mut BTreeSet<&str>,
        findings: &mut Findings,
    ) -> Result<Option<Self>, Refused> {
        let scene = job.opened.source.load(name).map_err(|fault| refused_load(job, fault))?;
        let wanted = chosen_keyframes(job, &scene, tokens);
        if wanted.is_empty() && !job.args.keyframes.is_empty() {
            return Ok(None);
        }
        if wanted.is_empty() {
            let fault = Fault::new("no-keyframes", "the scene", "keyframes to label", "none");
            findings.warn(job.console, name, &fault);
        }
        job.opened.rules.check(&scene).map_err(Refused::Configuration)?;
        warn_of(job, &scene, findings);
        lose_refused(job, &scene, findings)?;
        let inventory = Inventory::take(&*job.opened.source, &job.args.log.input, &scene);
        lose_missing(job, &scene, &inventory, findings)?;
        let masks = masks(job, &scene, findings).map_err(|fault| Refused::Broken(vec![fault]))?;
        let meshes = PlannedMeshes::plan(job, &scene, findings);
        let meshes = meshes.map_err(|fault| Refused::Broken(vec![fault]))?;
        let points = job.opened.source.scene_points(&scene);
        let model = memory_model(job, &scene, points, &meshes);
        let at_once = fit(job, &scene, &model)?;
        Ok(Some(Self {
            work: work(job, &scene, points, &wanted),
            name: name.to_owned(),
            record: scene_record(job, &scene, &meshes)
                .map_err(|fault| Refused::Broken(vec![fault]))?,
            infos: job.targets.infos(&scene).map_err(|fault| Refused::Broken(vec![fault]))?,
            wanted,
            meshes,
            at_once,
            memory_bytes: model.bytes(at_once.0, at_once.1),
            files: inventory.present,
            masks,
            sweeps: scene.sweeps.len(),
            told: told_by(&scene),
            points,
        }))
    }

    /// Refuses the scene, read again to be labelled, if less of it can be read than when it was planned:
    /// what it loses has been told by then.
    pub(crate) fn check_same(&self, scene: &Scene) -> Result<(), Fault> {
        let told = told_by(scene);
        if let Some(fault) = told.into_iter().find(|fault| !self.told.contains(fault)) {
            return Err(fault);
        }
        if scene.sweeps.len() == self.sweeps {
            return Ok(());
        }
        let expected = format!("{} sweeps, as when the run began", self.sweeps);
        Err(Fault::new("log-changed", &self.name, expected, scene.sweeps.len().to_string()))
    }

    /// Whether earlier runs labelled all that is asked for.
    pub(crate) fn is_finished(&self, finished: &Finished) -> bool {
        self.wanted.iter().all(|token| finished.contains_key(&(self.name.clone(), token.clone())))
    }

    /// How many rays will be cast at most: every point, for every keyframe.
    pub(crate) fn rays(&self) -> u64 {
        self.points * self.wanted.len() as u64
    }

    /// The bytes of its sweeps' files.
    pub(crate) fn bytes(&self) -> u64 {
        self.files.iter().map(|(_, bytes)| bytes).sum()
    }

    /// What labelling it is expected to cost.
    pub(crate) fn cost(&self) -> Cost {
        Cost::new(&self.work, self.memory_bytes)
    }

    /// One line for `--dry-run`.
    pub(crate) fn line(&self) -> String {
        let (keyframes, points, sweeps) = (self.wanted.len(), self.points, self.sweeps);
        let (name, bytes, rays) = (&self.name, self.bytes(), self.rays());
        let (memory_bytes, cost) = (self.memory_bytes, self.cost());
        let (seconds, output_bytes) = (cost.cpu_seconds, cost.output_bytes);
        format!(
            "{name}: {keyframes} keyframes, {sweeps} sweeps, {bytes} bytes; at most {points} points, \
             {rays} rays, {memory_bytes} bytes of memory; expected time {seconds:.1} CPU-seconds, \
             {output_bytes:.0} bytes of labels"
        )
    }
}

/// What is odd about a scene, in its records and its poses, and what it lacks.
fn warn_of(job: &Job, scene: &Scene, findings: &mut Findings) {
    let lacks = lacks(scene, &job.opened.config);
    let odd = check_poses(scene, None);
    let faults = scene.warnings.iter().chain(&lacks).chain(&odd);
    faults.for_each(|fault| findings.warn(job.console, &scene.name, fault));
}

/// The masks of a scene. If masks are asked for, and it has none, that is told.
fn masks(job: &Job, scene: &Scene, findings: &mut Findings) -> Result<Vec<InputRecord>, Fault> {
    let Some(masks) = &job.opened.masks else { return Ok(Vec::new()) };
    let record = |file: &String| {
        let record = InputRecord::of_sweep(masks.folder(), file)?.of_scene(&scene.name);
        Ok(InputRecord { path: format!("{}/{file}", job.opened.config.paint.masks), ..record })
    };
    let found = masks.of_scene(scene)?;
    let records: Vec<_> = found.files().map(record).collect::<Result<_, Fault>>()?;
    if records.is_empty() {
        let place = masks.folder().display().to_string();
        let expected = "masks of the scene's exposures";
        let fault = Fault::new("no-masks", place, expected, "none: nothing is painted");
        findings.warn(job.console, &scene.name, &fault);
    }
    if !records.is_empty() {
        tell_unpainted(job, scene, &found.exposures(), findings);
    }
    Ok(records)
}

/// Cameras none of whose exposures has a mask, where others have some: their folder may be named wrongly.
fn tell_unpainted(job: &Job, scene: &Scene, masked: &[Vec<Exposure>], findings: &mut Findings) {
    let cameras = scene.cameras.iter().zip(&scene.exposures).zip(masked);
    for ((camera, exposures), _) in
        cameras.filter(|((_, exposures), masked)| masked.is_empty() && !exposures.is_empty())
    {
        let expected = "masks, as of the other cameras";
        let found = format!("none of its {} exposures has one", exposures.len());
        let fault = Fault::new("no-masks", &camera.name, expected, found);
        findings.warn(job.console, &scene.name, &fault);
    }
}

fn refused_load(job: &Job, fault: Fault) -> Refused {
    match fault.rule {
        "reference-lidar" if job.opened.names_lidar => Refused::Configuration(fault),
        _ => Refused::Broken(vec![fault]),
    }
}

fn chosen_keyframes(job: &Job, scene: &Scene, tokens: &mut BTreeSet<&str>) -> BTreeSet<String> {
    let all = job.args.keyframes.is_empty();
    let is_chosen = |keyframe: &&Keyframe| tokens.remove(keyframe.token.as_str()) || all;
    scene.keyframes.iter().filter(is_chosen).map(|keyframe| keyframe.token.clone()).collect()
}

/// All that reading a scene's tables told.
fn told_by(scene: &Scene) -> Vec<Fault> {
    let refused = scene.refused.iter().map(|refusal| &refusal.fault);
    scene.warnings.iter().chain(refused).cloned().collect()
}

/// Records that the reader refused.
fn lose_refused(job: &Job, scene: &Scene, findings: &mut Findings) -> Result<(), Refused> {
    let faults: Vec<Fault> = scene.refused.iter().map(|refusal| refusal.fault.clone()).collect();
    let is_asked_for = scene.refused.iter().all(|refusal| refusal.loss == Loss::Remainder);
    lose(job, scene, faults, job.skips() || is_asked_for, findings)
}

/// Files that are not there, all told at once.
fn lose_missing(
    job: &Job,
    scene: &Scene,
    inventory: &Inventory,
    findings: &mut Findings,
) -> Result<(), Refused> {
    let may_miss = |file: &MissingFile| job.args.allow_missing_sweeps && !file.is_reference;
    let is_allowed = job.skips() || inventory.missing.iter().all(may_miss);
    let about = inventory.summary().map(|fault| with_hint(job, fault));
    let faults =
        about.into_iter().chain(inventory.missing.iter().map(MissingFile::fault)).collect();
    lose(job, scene, faults, is_allowed, findings)
}

fn lose(
    job: &Job,
    scene: &Scene,
    faults: Vec<Fault>,
    is_allowed: bool,
    findings: &mut Findings,
) -> Result<(), Refused> {
    if !is_allowed && !faults.is_empty() {
        return Err(Refused::Broken(faults));
    }
    faults.iter().for_each(|fault| findings.lose(job.console, &scene.name, fault));
    Ok(())
}

/// How one could do without what is missing.
fn with_hint(job: &Job, fault: Fault) -> Fault {
    match (job.skips(), job.args.allow_missing_sweeps) {
        (true, _) => fault,
        (false, true) => fault.hint("a keyframe needs its own: --on-error skip leaves it out"),
        (false, false) => {
            fault.hint("--allow-missing-sweeps labels without those that no keyframe needs")
        }
    }
}

/// What there is to do for a scene in each grid.
fn work(job: &Job, scene: &Scene, points: u64, wanted: &BTreeSet<String>) -> Vec<SceneWork> {
    let is_wanted = |keyframe: &&Keyframe| wanted.contains(&keyframe.token);
    let keyframes: Vec<_> = scene.keyframes.iter().filter(is_wanted).collect();
    let of_grid = |grid: &LabelledGrid| {
        let evidence = job.args.evidence || grid.needs_evidence();
        SceneWork::new(scene, points, &keyframes, &grid.rules, evidence)
    };
    job.targets.grids.iter().map(of_grid).collect()
}

/// What memory labelling takes, reading included.
fn memory_model(job: &Job, scene: &Scene, points: u64, meshes: &PlannedMeshes) -> MemoryModel {
    let evidence = job.args.evidence || job.targets.need_evidence();
    let reading_bytes = disk::reading_bytes(&job.args.log.input, job.threads);
    let model = MemoryModel::new(points, job.targets.largest(), scene.cameras.len(), evidence)
        .beside(reading_bytes + meshes.memory_bytes());
    if job.opened.rules.window.radius_m.is_some() { model.cutting() } else { model }
}

/// How many keyframes fit into memory at once: into `--memory`, else into what the machine has left.
fn fit(job: &Job, scene: &Scene, model: &MemoryModel) -> Result<(usize, usize), Refused> {
    let limit = job.args.memory.or_else(available_memory_bytes);
    model.plan(job.threads, limit).map_err(|needed| {
        let expected = format!("a scene that fits into {} bytes", limit.unwrap_or(u64::MAX));
        let fault = Fault::new("memory", &scene.name, expected, format!("{needed} bytes needed"));
        Refused::Broken(vec![fault.hint("raise --memory, or take a coarser or smaller grid")])
    })
}

/// Memory that the machine can still give, where the system tells it.
fn available_memory_bytes() -> Option<u64> {
    let info = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

fn scene_record(job: &Job, scene: &Scene, meshes: &PlannedMeshes) -> Result<SceneRecord, Fault> {
    let names = &job.opened.rules.taxonomy.names;
    let track = |track: &BoxTrack| TrackRecord {
        index: track.id.0,
        id: track.source_id.clone(),
        class: track.class().map(|class| names[class.index()].clone()),
        category: track.category.clone(),
    };
    let tracks = scene.tracks.iter().map(track);
    Ok(SceneRecord {
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        tracks: tracks.chain(meshes.own_tracks(scene, names, job)).collect(),
        keyframes: scene.keyframes.iter().map(|keyframe| keyframe.token.clone()).collect(),
        poses: scene.keyframes.iter().map(|keyframe| pose_record(scene, keyframe)).collect(),
        world: world_hash(&job.args.log.input, &scene.name)?,
    })
}

fn pose_record(scene: &Scene, keyframe: &Keyframe) -> PoseRecord {
    PoseRecord::new(&keyframe.token, scene.reference_sweep(keyframe))
}

/// The hash of the world that lies beside a simulated log; none beside a real one.
fn world_hash(root: &Path, scene: &str) -> Result<Option<String>, Fault> {
    for file in [format!("{scene}.toml"), "world.toml".to_owned()] {
        let path = root.join("truth").join(&file);
        if !disk::is_file(&path) {
            continue;
        }
        let text = disk::read(&path).map_err(|error| {
            Fault::new("read", path.display().to_string(), "to read this file", error.to_string())
        })?;
        let world = World::parse(&String::from_utf8_lossy(&text), &file);
        if let Some(world) = world.ok().filter(|world| world.name == scene) {
            return Ok(Some(world.hash));
        }
    }
    Ok(None)
}
