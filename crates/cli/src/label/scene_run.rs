//! One scene of a run: aggregate, label keyframe by keyframe, write.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::Instant;

use occlabel_core::{AggregatedScene, ClassId, Fault, Keyframe, OccupancyLabels, Scene, Timestamp};
use occlabel_labels::{FileRecord, Journal, JournalEntry, LabelTree, TreePath, WriterLock};
use occlabel_pipeline::{
    LabelOptions, LabelledKeyframe, Lenses, MaskedExposures, aggregate_painted_scene,
    label_keyframe,
};
use serde_json::Value;

use crate::exit::Stop;
use crate::interrupt::Interrupt;
use crate::label::clock::{StageClock, StageMeter};
use crate::label::findings::Findings;
use crate::label::job::Job;
use crate::label::planned_scene::PlannedScene;
use crate::label::sweep_reader::{Book, SweepReader};
use crate::label::tally::{EmptyBox, Summary, Tally, VoxelCounts};
use crate::label::target_dialect::Source;
use crate::label::targets::{KeyframeFiles, LabelledGrid};
use crate::label::workers;
use crate::mask_reader::MaskReader;
use crate::progress::Progress;

/// A scene to label.
pub(crate) struct SceneRun<'a> {
    pub(crate) job: &'a Job<'a>,
    pub(crate) tree: &'a LabelTree,
    pub(crate) planned: &'a PlannedScene,
    pub(crate) progress: &'a Progress<'a>,
    pub(crate) interrupt: &'a Interrupt,
}

/// Keyframes that earlier runs finished, by scene and token.
pub(crate) type Finished = BTreeMap<(String, String), JournalEntry>;

/// What came of it.
#[derive(Default)]
pub(crate) struct SceneDone {
    pub(crate) tally: Tally,
    /// The finished keyframes, by this run or an earlier one.
    pub(crate) entries: Vec<JournalEntry>,
}

/// What the keyframes of a scene share while they are worked on.
struct Bench<'a> {
    scene: &'a Scene,
    aggregated: &'a AggregatedScene<ClassId>,
    lenses: Lenses,
    meter: &'a StageMeter,
    finished: &'a Finished,
    /// What was lost of the scene.
    losses: Vec<Value>,
    journal: Mutex<&'a mut Journal>,
    done: Mutex<SceneDone>,
}

/// A labelled keyframe that is not on disk yet.
struct MadeKeyframe {
    /// In the order of writing.
    files: Result<KeyframeFiles, Fault>,
    /// What the journal and the report say of it.
    summary: Value,
    rays: u64,
}

impl SceneRun<'_> {
    /// Labels what no earlier run finished.
    pub(crate) fn label(
        &self,
        finished: &Finished,
        journal: &mut Journal,
        findings: &mut Findings,
    ) -> Result<SceneDone, Stop> {
        let started = Instant::now();
        let mut done = self.finished_before(finished, findings);
        let _lock = WriterLock::of_scene(self.tree, &self.planned.name)?;
        let scene = self.job.opened.source.load(&self.planned.name)?;
        self.planned.check_same(&scene)?;
        let todo = self.keyframes_to_label(&scene, &done);
        let kept = self.planned.wanted.len() - todo.len();
        self.progress.scene(&scene.name, todo.len(), kept);
        if !todo.is_empty() {
            done = self.label_keyframes(&scene, todo, done, finished, journal, findings)?;
        }
        done.tally.seconds = started.elapsed().as_secs_f64();
        Ok(done)
    }

    fn label_keyframes(
        &self,
        scene: &Scene,
        mut todo: Vec<&Keyframe>,
        mut done: SceneDone,
        finished: &Finished,
        journal: &mut Journal,
        findings: &mut Findings,
    ) -> Result<SceneDone, Stop> {
        let (meter, lenses) = (&StageMeter::new(), Lenses::default());
        let (mut aggregated, book) = self.aggregate(scene, meter, &mut done.tally)?;
        if self.interrupt.is_raised() {
            return Ok(done);
        }
        let meshes = &self.planned.meshes;
        done.tally.meshes = meshes.embody(self.job, scene, &mut aggregated, findings)?;
        self.tell(&book, &done.tally, findings);
        if let Some(fault) = far_cloud(scene, &aggregated, self.job.opened.rules.window.radius_m) {
            findings.warn(self.job.console, &scene.name, &fault);
        }
        todo.retain(|keyframe| self.is_readable(scene, keyframe, &book, findings));
        let (losses, aggregated) = (findings.losses_of(&scene.name), &aggregated);
        let (journal, done) = (Mutex::new(journal), Mutex::new(done));
        let bench = Bench { scene, aggregated, lenses, meter, finished, losses, journal, done };
        let is_over = || self.interrupt.is_raised();
        let (at_once, _) = self.planned.at_once;
        let make = |keyframe: &&Keyframe| self.make(keyframe, &bench);
        let write = |keyframe: &&Keyframe, made| self.finish(keyframe, made, &bench);
        workers::for_each(&todo, at_once, is_over, make, write)?;
        let mut done = bench.done.into_inner().expect("no worker panicked");
        done.tally.costs = meter.costs();
        Ok(done)
    }

    /// Tells what reading the sweeps brought to light.
    fn tell(&self, book: &Book, tally: &Tally, findings: &mut Findings) {
        book.tell(self.job, &self.planned.name, findings);
        if tally.points == 0 {
            findings.warn(self.job.console, &self.planned.name, &no_points());
        }
    }

    /// Whether a keyframe's own sweep could be read; if not, the keyframe is lost.
    fn is_readable(
        &self,
        scene: &Scene,
        keyframe: &Keyframe,
        book: &Book,
        findings: &mut Findings,
    ) -> bool {
        let refusal = book.refusal_of(scene, keyframe);
        if let Some(fault) = &refusal {
            findings.lose(self.job.console, &scene.name, fault);
        }
        refusal.is_none()
    }

    /// The keyframes of which an earlier run wrote all that this one would, and what it lost then.
    fn finished_before(&self, finished: &Finished, findings: &mut Findings) -> SceneDone {
        let mut done = SceneDone::default();
        for token in &self.planned.record.keyframes {
            let Some(entry) = finished.get(&(self.planned.name.clone(), token.clone())) else {
                continue;
            };
            if self.planned.wanted.contains(token) && !self.has_all_files(entry) {
                continue;
            }
            let losses = entry.summary["losses"].as_array().into_iter().flatten();
            losses.for_each(|loss| findings.remember(loss.clone()));
            done.keep(entry);
            done.tally.kept += 1;
        }
        done
    }

    fn has_all_files(&self, entry: &JournalEntry) -> bool {
        let JournalEntry { scene, keyframe, .. } = entry;
        let paths = self.job.targets.paths(scene, keyframe, self.job.args.evidence);
        paths.is_ok_and(|paths| paths.iter().all(|path| entry.has(path)))
    }

    fn keyframes_to_label<'s>(&self, scene: &'s Scene, done: &SceneDone) -> Vec<&'s Keyframe> {
        let finished: BTreeSet<&String> =
            done.entries.iter().map(|entry| &entry.keyframe).collect();
        let is_due = |token| self.planned.wanted.contains(token) && !finished.contains(token);
        scene.keyframes.iter().filter(|keyframe| is_due(&keyframe.token)).collect()
    }

    fn aggregate(
        &self,
        scene: &Scene,
        meter: &StageMeter,
        tally: &mut Tally,
    ) -> Result<(AggregatedScene<ClassId>, Book), Fault> {
        let (mut clock, rules) = (meter.clock(), &self.job.opened.rules);
        let reader = SweepReader::new(self.job, self.interrupt);
        let masks = MaskReader::new(self.job.opened.masks.as_ref(), scene)?;
        let (numbered, skips) = (self.planned.meshes.numbered(scene), self.job.skips());
        let masks = masks.map(|masks| masks.after(numbered).of_run(skips, self.interrupt));
        let masked = masks.as_ref().map_or_else(MaskedExposures::none, MaskReader::exposures);
        let (read, enter) = (|sweep: &_| reader.read(sweep), |stage| clock.enter(stage));
        let aggregated = aggregate_painted_scene(scene, rules, read, &masked, enter)?;
        drop(masked);
        let book = reader.close(masks.map(MaskReader::lost).unwrap_or_default());
        tally.sweeps = book.sweeps(self.planned.files.iter().map(|(_, bytes)| bytes).sum());
        tally.points_read = book.points;
        tally.not_finite = book.not_finite();
        tally.points = aggregated.point_count() as u64;
        (tally.dropped, tally.class_from) = (aggregated.dropped, aggregated.class_from);
        tally.boxes_without_points = boxes_without_points(scene, &aggregated);
        Ok((aggregated, book))
    }

    /// Labels a keyframe, in one grid after the other; what is told of it is of the main one.
    fn make(&self, keyframe: &Keyframe, bench: &Bench) -> MadeKeyframe {
        let mut clock = bench.meter.clock();
        let [main, others @ ..] = &self.job.targets.grids[..] else { unreachable!("a main grid") };
        let LabelledKeyframe { labels, rays } = self.label_in(main, keyframe, bench, &mut clock);
        let mut files = self.files(main, &labels, keyframe, bench);
        let summary = bench.summary(&labels, &main.rules.taxonomy.names);
        for grid in others {
            let labelled = self.label_in(grid, keyframe, bench, &mut clock);
            let more = self.files(grid, &labelled.labels, keyframe, bench);
            files = files.and_then(|files| Ok([files, more?].concat()));
        }
        MadeKeyframe { files, summary, rays }
    }

    fn label_in(
        &self,
        grid: &LabelledGrid,
        keyframe: &Keyframe,
        bench: &Bench,
        clock: &mut StageClock,
    ) -> LabelledKeyframe {
        let (_, shards) = self.planned.at_once;
        let evidence = self.job.args.evidence || grid.needs_evidence();
        let options = LabelOptions { evidence, shards };
        let (enter, rules) = (|stage| clock.enter(stage), &grid.rules);
        let Bench { scene, aggregated, lenses, .. } = bench;
        label_keyframe(scene, aggregated, lenses, keyframe, rules, &options, enter)
    }

    fn files(
        &self,
        grid: &LabelledGrid,
        labels: &OccupancyLabels,
        keyframe: &Keyframe,
        bench: &Bench,
    ) -> Result<KeyframeFiles, Fault> {
        let Bench { scene, aggregated, .. } = *bench;
        let source = Source { scene, aggregated, keyframe, rules: &grid.rules };
        let evidence = self.job.args.evidence;
        let files = grid.targets.iter().map(|target| target.files(&source, labels, evidence));
        Ok(files.collect::<Result<Vec<_>, Fault>>()?.concat())
    }

    /// The files of a keyframe with those that an earlier run wrote of it, for sets that this one does
    /// not write.
    fn with_earlier(
        &self,
        mut files: Vec<FileRecord>,
        keyframe: &Keyframe,
        bench: &Bench,
    ) -> Vec<FileRecord> {
        let key = (self.planned.name.clone(), keyframe.token.clone());
        let earlier = bench.finished.get(&key).into_iter().flat_map(|entry| &entry.files);
        let is_kept = |earlier: &&FileRecord| !files.iter().any(|file| file.path == earlier.path);
        let kept: Vec<FileRecord> = earlier.filter(is_kept).cloned().collect();
        files.extend(kept);
        files
    }

    /// Writes a keyframe, and notes that it is finished.
    fn finish(&self, keyframe: &Keyframe, made: MadeKeyframe, bench: &Bench) -> Result<(), Fault> {
        let (scene, token) = (&self.planned.name, &keyframe.token);
        let write = |(path, bytes): (TreePath, Vec<u8>)| {
            Ok(self.tree.write(&path, &bytes)?.of_keyframe(scene, token))
        };
        let files = made.files?.into_iter().map(write).collect::<Result<_, Fault>>()?;
        let entry = JournalEntry {
            scene: scene.clone(),
            keyframe: token.clone(),
            files: self.with_earlier(files, keyframe, bench),
            summary: made.summary,
        };
        bench.journal.lock().expect("no worker panicked").append(&entry)?;
        let mut done = bench.done.lock().expect("no worker panicked");
        done.keep(&entry);
        done.tally.rays += made.rays;
        self.progress.keyframe(scene, token, made.rays);
        Ok(())
    }
}

impl Bench<'_> {
    fn summary(&self, labels: &OccupancyLabels, names: &[String]) -> Value {
        let voxels = VoxelCounts::of(labels, names);
        let summary = Summary { voxels, losses: self.losses.clone() };
        serde_json::to_value(summary).expect("counts are JSON")
    }
}

impl SceneDone {
    /// Counts a finished keyframe.
    fn keep(&mut self, entry: &JournalEntry) {
        self.tally.keyframes += 1;
        let summary: Summary = serde_json::from_value(entry.summary.clone()).unwrap_or_default();
        self.tally.voxels.add(&summary.voxels);
        self.entries.push(entry.clone());
    }
}

/// What becomes of a scene whose points of no time all lie far from its keyframes: they may be in
/// another frame than the poses, such as that of a map.
fn far_cloud(
    scene: &Scene,
    aggregated: &AggregatedScene<ClassId>,
    radius_m: Option<f64>,
) -> Option<Fault> {
    let radius_m = radius_m?;
    let ego = |keyframe: &Keyframe| scene.reference_sweep(keyframe).world_from_ego.translation;
    let egos: Vec<_> = scene.keyframes.iter().map(|keyframe| ego(keyframe).vector).collect();
    let timeless = aggregated.background.iter().filter(|sweep| sweep.time.is_none());
    let mut points = timeless.flat_map(|sweep| &sweep.cloud.positions).peekable();
    points.peek()?;
    let is_near = |point: &nalgebra::Point3<f64>| {
        egos.iter().any(|ego| (point.coords - ego).norm() <= radius_m)
    };
    let is_far = !points.any(is_near);
    is_far.then(|| {
        let expected = format!("points within {radius_m} m of a pose (aggregate.radius_m)");
        Fault::new("cloud-far", "the cloud", expected, "none: is it in the frame of the poses?")
    })
}

/// What becomes of a scene in which no lidar saw anything.
fn no_points() -> Fault {
    let found = "none: nothing is observed in any voxel";
    Fault::new("no-points", "all sweeps", "points that count", found)
}

/// Annotated boxes at the time of a sweep that hold no point of it.
fn boxes_without_points(scene: &Scene, aggregated: &AggregatedScene<ClassId>) -> Vec<EmptyBox> {
    let sweeps: BTreeSet<_> = scene.sweeps.iter().map(|sweep| sweep.time).collect();
    let held: BTreeSet<_> =
        aggregated.objects.iter().map(|object| (object.track, object.time)).collect();
    let mut empty = Vec::new();
    for track in &scene.tracks {
        let times = track.boxes.iter().map(|(time, _)| *time);
        let is_empty = |time: &Timestamp| {
            sweeps.contains(time)
                && ![None, Some(*time)].iter().any(|at| held.contains(&(track.id, *at)))
        };
        empty.extend(
            times
                .filter(is_empty)
                .map(|time| EmptyBox { track: track.source_id.clone(), time_ns: time.0 }),
        );
    }
    empty
}
