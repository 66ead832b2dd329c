//! `label`: the main job, scene after scene.

mod clock;
mod findings;
mod plan;
mod planned_scene;
mod read_ahead;
mod records;
mod redo;
mod report;
mod scene_run;
mod sweep_reader;
mod tally;
mod target_dialect;
mod targets;
mod workers;

use std::collections::BTreeSet;

use occlabel_core::Fault;
use occlabel_dialects::Dialect;
use occlabel_disk as disk;
use occlabel_labels::{
    Begun, FileRecord, JournalEntry, LabelTree, Manifest, RESUME_DIFFERS, Resume, RunFiles,
    RunRecord, TreePath, begin,
};

use crate::args::{LabelArgs, OnError, ResumeArg};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::input::{Opened, Stead, open_with, published_grid};
use crate::interrupt::Interrupt;
use crate::label::findings::Findings;
use crate::label::plan::Plan;
use crate::label::read_ahead::while_reading;
use crate::label::redo::Redo;
use crate::label::report::{EarlierReport, Report};
use crate::label::scene_run::{Finished, SceneRun};
use crate::label::targets::Targets;
use crate::progress::Progress;
use crate::threads::start_threads;

/// What every part of the run needs.
pub(crate) struct Job<'a> {
    args: &'a LabelArgs,
    opened: &'a Opened,
    targets: &'a Targets,
    console: &'a Console,
    tree: LabelTree,
    threads: usize,
}

impl Job<'_> {
    /// Whether what cannot be used is left out, rather than ending the run.
    fn skips(&self) -> bool {
        self.args.on_error == OnError::Skip
    }
}

pub(crate) fn run(args: &LabelArgs, console: &Console) -> Result<Outcome, Stop> {
    let interrupt = Interrupt::listen();
    let threads = start_threads(args.jobs);
    let dialect = args.dialect.as_deref().map(Dialect::named).transpose().map_err(Stop::usage)?;
    let grid = dialect.as_ref().map(published_grid).transpose()?;
    let opened = open_with(&args.log, &args.config, &Stead { grid, ..Stead::default() })?;
    let tree = LabelTree::new(&args.output);
    let targets = Targets::new(&opened, dialect.as_ref(), &args.also).map_err(Stop::usage)?;
    let job = Job { args, opened: &opened, targets: &targets, console, tree, threads };
    let mut findings = Findings::default();
    let plan = Plan::make(&job, &mut findings)?;
    let redo = redo::read(args.redo.as_deref(), &plan).map_err(Stop::usage)?;
    if args.dry_run {
        plan.print(console);
        return Ok(findings.outcome());
    }
    label_scenes(&job, &plan, &redo, findings, &interrupt)
}

fn label_scenes(
    job: &Job,
    plan: &Plan,
    redo: &Redo,
    mut findings: Findings,
    interrupt: &Interrupt,
) -> Result<Outcome, Stop> {
    let record = records::run_record(job, plan)?;
    tell_notes(job);
    let (mut begun, mut finished) = begin_run(job, &record, &mut findings)?;
    finished.retain(|keyframe, _| !redo.contains(keyframe));
    let progress =
        Progress::new(job.args.progress, job.console, plan.scenes.len(), plan.keyframes());
    let mut report = Report::new();
    let mut entries = Vec::new();
    for (at, planned) in plan.scenes.iter().enumerate() {
        let run = SceneRun { job, planned, progress: &progress, interrupt };
        let next = plan.files_after(at, &finished);
        let done = while_reading(&job.args.log.input, next, || {
            run.label(&finished, &mut begun.journal, &mut findings)
        })?;
        report.add(&planned.name, &done);
        entries.extend(done.entries);
        if interrupt.is_raised() {
            job.console.info("interrupted: the same command goes on from here");
            return Ok(Outcome::Interrupted);
        }
        progress.suspend(|| job.console.result(&done.tally.line(&planned.name)));
    }
    progress.finish();
    let outcome = findings.outcome();
    let manifest = write_manifests(job, plan, &record, &entries, &begun)?;
    begun.end(&manifest, report.json(outcome, &findings, job.threads))?;
    if plan.scenes.len() != 1 {
        job.console.result(&report.total_line());
    }
    Ok(outcome)
}

/// What the label sets do not say as our own would.
fn tell_notes(job: &Job) {
    for (_, target) in job.targets.all() {
        let name = target.folder.as_deref().unwrap_or("labels");
        target.notes.iter().for_each(|note| job.console.info(&format!("{name}: {note}")));
    }
}

/// The main set's manifest, which lists those of the others, and the lists of keyframes, all of them
/// written by now.
fn write_manifests(
    job: &Job,
    plan: &Plan,
    record: &RunRecord,
    entries: &[JournalEntry],
    begun: &Begun,
) -> Result<Manifest, Fault> {
    let mut manifests = Vec::new();
    let mut of_all = Vec::new();
    for target in job.targets.all() {
        let folder = target.1.folder.as_deref();
        let mut manifest = records::manifest(job, plan, record, entries, target);
        if let Some(stem) = target.1.list_stem() {
            let list = records::annotations(plan, entries);
            let file = begun.write_of_all(folder, stem, &list)?;
            manifest.files.extend(target.1.own_record(&file).filter(|_| folder.is_some()));
            of_all.push(file);
        }
        manifest.files.sort();
        if folder.is_some() {
            of_all.push(begun.write_of_all(folder, "manifest", &manifest)?);
        }
        manifests.push(manifest);
    }
    let mut main = manifests.swap_remove(0);
    main.files.extend(of_all);
    main.files.extend(earlier_manifests(job, &main)?);
    main.files.sort();
    Ok(main)
}

/// The manifests of sets that an earlier run wrote below the tree, and this one does not.
fn earlier_manifests(job: &Job, main: &Manifest) -> Result<Vec<FileRecord>, Fault> {
    let listed = |path: &TreePath| main.files.iter().any(|file| file.path == *path);
    let folders: BTreeSet<&str> =
        main.files.iter().filter_map(|file| Some(file.path.as_str().split_once('/')?.0)).collect();
    let paths = folders.into_iter().map(|folder| TreePath::new(format!("{folder}/manifest.json")));
    let paths = paths.collect::<Result<Vec<_>, _>>()?.into_iter();
    let theirs = paths.filter(|path| !listed(path) && disk::is_file(&job.tree.place(path)));
    theirs.map(|path| FileRecord::of_file(&job.tree, path)).collect()
}

/// The run, and what earlier ones finished of it.
fn begin_run(
    job: &Job,
    record: &RunRecord,
    findings: &mut Findings,
) -> Result<(Begun, Finished), Stop> {
    let files = run_files(job);
    let earlier = EarlierReport::load(&files.report())?;
    let mut begun = begin(&files, record, resume(job.args.resume)).map_err(usage_if_differs)?;
    let mut finished = std::mem::take(&mut begun.finished);
    earlier.recall(&mut finished);
    warn_of_others(job, &begun.differences, findings);
    Ok((begun, finished))
}

/// Tells that keyframes are kept which this configuration or these inputs would not give.
fn warn_of_others(job: &Job, differences: &[String], findings: &mut Findings) {
    if !differences.is_empty() {
        let place = job.args.output.display().to_string();
        let expected = "finished keyframes of this very run";
        let fault = Fault::new("kept-others", place, expected, differences.join("; "));
        findings.warn(job.console, "all scenes", &fault);
    }
}

fn run_files(job: &Job) -> RunFiles {
    match job.args.shard {
        None => RunFiles::whole(job.tree.clone()),
        Some(shard) => RunFiles::shard(job.tree.clone(), shard.index, shard.count),
    }
}

fn resume(arg: ResumeArg) -> Resume {
    match arg {
        ResumeArg::IfSame => Resume::IfSame,
        ResumeArg::Never => Resume::Never,
        ResumeArg::Always => Resume::Always,
    }
}

fn usage_if_differs(fault: Fault) -> Stop {
    if fault.rule == RESUME_DIFFERS { Stop::usage(fault) } else { fault.into() }
}
