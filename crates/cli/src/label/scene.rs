//! One scene of a run: read, aggregate, label keyframe by keyframe, write.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use occlabel_core::{
    AggregatedScene, ClassId, Fault, Keyframe, OccupancyLabels, PointCloud, PointLabel, Scene,
    SweepHeader,
};
use occlabel_labels::{
    FileRecord, Journal, JournalEntry, TreePath, WriterLock, evidence_npz, labels_npz,
};
use occlabel_logs::SceneSource;
use occlabel_pipeline::{aggregate_scene, label_keyframe};

use crate::exit::Stop;
use crate::interrupt::Interrupt;
use crate::label::clock::{StageClock, StageTimes};
use crate::label::findings::Findings;
use crate::label::plan::PlannedScene;
use crate::label::tally::{Tally, VoxelCounts};
use crate::label::{Job, workers};
use crate::progress::Progress;

/// A scene to label.
pub(crate) struct SceneRun<'a> {
    pub(crate) job: &'a Job<'a>,
    pub(crate) planned: &'a PlannedScene,
    pub(crate) progress: &'a Progress,
    pub(crate) interrupt: &'a Interrupt,
}

/// What came of it.
#[derive(Default)]
pub(crate) struct SceneDone {
    pub(crate) tally: Tally,
    /// The finished keyframes, by this run or an earlier one.
    pub(crate) entries: Vec<JournalEntry>,
}

/// What reading the sweeps brought to light.
#[derive(Default)]
struct Reading {
    warnings: Vec<Fault>,
    /// Sweeps that were left out, by their file.
    lost: BTreeMap<String, Fault>,
}

/// What the keyframes have in common, and what they add up to.
struct Shared<'a> {
    scene: &'a Scene,
    aggregated: &'a AggregatedScene<ClassId>,
    journal: Mutex<&'a mut Journal>,
    done: Mutex<SceneDone>,
}

impl SceneRun<'_> {
    /// Labels what no earlier run finished.
    pub(crate) fn label(
        &self,
        finished: &BTreeMap<(String, String), JournalEntry>,
        journal: &mut Journal,
        findings: &mut Findings,
    ) -> Result<SceneDone, Stop> {
        let name = &self.planned.name;
        let mut done = SceneDone::default();
        for token in &self.planned.record.keyframes {
            let entry = finished.get(&(name.clone(), token.clone()));
            entry
                .filter(|entry| self.is_complete(entry))
                .into_iter()
                .for_each(|entry| done.keep(entry));
        }
        let _lock = WriterLock::of_scene(&self.job.tree, name)?;
        let scene = self.job.opened.source.load(name)?;
        let (mut todo, is_done) = (Vec::new(), done.tokens());
        let is_wanted = |keyframe: &&Keyframe| {
            self.planned.record.keyframes.contains(&keyframe.token)
                && !is_done.contains(&keyframe.token)
        };
        todo.extend(scene.keyframes.iter().filter(is_wanted));
        if todo.is_empty() {
            return Ok(done);
        }
        self.progress.scene(name);
        let (aggregated, reading, times) = self.aggregate(&scene)?;
        self.report_reading(&scene, &reading, findings);
        done.tally.times.add(&times);
        done.tally.points = aggregated.point_count() as u64;
        done.tally.dropped = aggregated.dropped;
        done.tally.boxes_without_points = boxes_without_points(&scene, &aggregated);
        todo.retain(|keyframe| self.keeps_its_sweep(&scene, keyframe, &reading, findings));
        let shared = Shared {
            scene: &scene,
            aggregated: &aggregated,
            journal: Mutex::new(journal),
            done: Mutex::new(done),
        };
        let (at_once, shards) = self.planned.at_once;
        let is_over = || self.interrupt.is_raised();
        workers::for_each(&todo, at_once, is_over, |keyframe| {
            self.finish(keyframe, shards, &shared)
        })?;
        Ok(shared.done.into_inner().expect("no worker panicked"))
    }

    /// Whether an earlier run wrote all that this one would.
    fn is_complete(&self, entry: &JournalEntry) -> bool {
        let path = TreePath::evidence(&entry.scene, &entry.keyframe);
        !self.job.args.evidence || path.is_ok_and(|path| entry.has(&path))
    }

    fn aggregate(
        &self,
        scene: &Scene,
    ) -> Result<(AggregatedScene<ClassId>, Reading, StageTimes), Stop> {
        let reading = Mutex::new(Reading::default());
        let mut clock = StageClock::start();
        let read = |header: &SweepHeader| self.read(header, &reading);
        let aggregated =
            aggregate_scene(scene, &self.job.opened.rules, read, |stage| clock.enter(stage))?;
        let mut reading = reading.into_inner().expect("no reader panicked");
        reading.warnings.sort_by(|a, b| (&a.place, a.rule).cmp(&(&b.place, b.rule)));
        Ok((aggregated, reading, clock.stop()))
    }

    /// The points of a sweep; none if it is left out.
    fn read(
        &self,
        header: &SweepHeader,
        reading: &Mutex<Reading>,
    ) -> Result<Option<PointCloud<PointLabel>>, Fault> {
        let is_allowed = |fault: &Fault| {
            self.job.skips() || (fault.rule == "missing-file" && self.job.args.allow_missing_sweeps)
        };
        let read = self.job.opened.source.read_sweep(header);
        let mut reading = reading.lock().expect("no reader panicked");
        match read {
            Ok(points) => {
                reading.warnings.extend(points.warnings);
                Ok(Some(points.cloud))
            }
            Err(fault) if is_allowed(&fault) => {
                reading.lost.insert(header.file.clone(), fault);
                Ok(None)
            }
            Err(fault) => Err(fault),
        }
    }

    fn report_reading(&self, scene: &Scene, reading: &Reading, findings: &mut Findings) {
        for fault in &reading.warnings {
            self.progress.suspend(|| self.job.console.warning(&scene.name, fault));
            findings.warn(&scene.name, fault.clone());
        }
        // Absent files were told of before any sweep was read.
        for fault in reading.lost.values().filter(|fault| fault.rule != "missing-file") {
            self.progress.suspend(|| self.job.console.warning(&scene.name, fault));
            findings.lose(&scene.name, fault.clone());
        }
    }

    /// A keyframe whose reference sweep was left out is left out too.
    fn keeps_its_sweep(
        &self,
        scene: &Scene,
        keyframe: &Keyframe,
        reading: &Reading,
        findings: &mut Findings,
    ) -> bool {
        let Some(cause) = reading.lost.get(&scene.reference_sweep(keyframe).file) else {
            return true;
        };
        let fault =
            Fault::new("keyframe", &cause.place, "the reference sweep of a keyframe", &cause.found)
                .record(format!("keyframe {}", keyframe.token));
        self.progress.suspend(|| self.job.console.warning(&scene.name, &fault));
        findings.lose(&scene.name, fault);
        false
    }

    /// Labels a keyframe, writes it, and notes that it is finished.
    fn finish(&self, keyframe: &Keyframe, shards: usize, shared: &Shared) -> Result<(), Fault> {
        let rules = &self.job.opened.rules;
        let mut clock = StageClock::start();
        let labels =
            label_keyframe(shared.scene, shared.aggregated, keyframe, rules, shards, |stage| {
                clock.enter(stage);
            });
        let files = self.write(keyframe, &labels)?;
        let voxels = VoxelCounts::of(&labels);
        let entry = JournalEntry {
            scene: shared.scene.name.clone(),
            keyframe: keyframe.token.clone(),
            files,
            summary: serde_json::to_value(voxels).expect("counts are JSON"),
        };
        shared.journal.lock().expect("no worker panicked").append(&entry)?;
        let rays = shared.aggregated.point_count() as u64;
        let mut done = shared.done.lock().expect("no worker panicked");
        done.keep(&entry);
        done.tally.rays += rays;
        done.tally.times.add(&clock.stop());
        self.progress.keyframe(&shared.scene.name, &keyframe.token, rays);
        Ok(())
    }

    fn write(
        &self,
        keyframe: &Keyframe,
        labels: &OccupancyLabels,
    ) -> Result<Vec<FileRecord>, Fault> {
        let (tree, scene, token) = (&self.job.tree, &self.planned.name, &keyframe.token);
        let mut files = Vec::new();
        if self.job.args.evidence {
            let bytes = evidence_npz(&labels.evidence);
            files.push(tree.write(&TreePath::evidence(scene, token)?, &bytes)?);
        }
        files.push(tree.write(&TreePath::labels(scene, token)?, &labels_npz(labels))?);
        Ok(files)
    }
}

impl SceneDone {
    /// Counts a finished keyframe.
    fn keep(&mut self, entry: &JournalEntry) {
        self.tally.keyframes += 1;
        let counts = serde_json::from_value(entry.summary.clone()).unwrap_or_default();
        self.tally.voxels.add(&counts);
        self.entries.push(entry.clone());
    }

    fn tokens(&self) -> BTreeSet<String> {
        self.entries.iter().map(|entry| entry.keyframe.clone()).collect()
    }
}

/// Annotated boxes at the time of a sweep that hold no point of it.
fn boxes_without_points(scene: &Scene, aggregated: &AggregatedScene<ClassId>) -> usize {
    let sweeps: BTreeSet<_> = scene.sweeps.iter().map(|sweep| sweep.time).collect();
    let held: BTreeSet<_> =
        aggregated.objects.iter().map(|object| (object.track, object.time)).collect();
    let annotated = scene.tracks.iter().flat_map(|track| {
        let times = track.boxes.iter().map(|(time, _)| *time);
        times.filter(|time| sweeps.contains(time)).map(|time| (track.id, time))
    });
    annotated.filter(|annotation| !held.contains(annotation)).count()
}
