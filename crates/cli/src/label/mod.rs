//! `label`: the main job, scene after scene.

mod beginning;
mod clock;
pub(crate) mod findings;
pub(crate) mod job;
mod manifests;
mod meshes;
mod plan;
pub(crate) mod planned_scene;
mod read_ahead;
mod records;
mod redo;
mod report;
mod scene_run;
mod sweep_reader;
mod tally;
mod target_dialect;
mod targets;
mod usage;
mod workers;

use occlabel_labels::LabelTree;

use crate::args::LabelArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::interrupt::Interrupt;
use crate::label::beginning::begin_run;
use crate::label::findings::Findings;
use crate::label::job::Job;
use crate::label::manifests::write_manifests;
use crate::label::plan::Plan;
use crate::label::read_ahead::while_reading;
use crate::label::redo::Redo;
use crate::label::report::Report;
use crate::label::scene_run::SceneRun;
use crate::progress::Progress;
use crate::urls::check_url;

pub(crate) fn run(args: &LabelArgs, console: &Console) -> Result<Outcome, Stop> {
    let interrupt = Interrupt::listen();
    check_url(&args.output)?;
    let job = Job::open(&args.work, console)?;
    let mut findings = Findings::default();
    let plan = Plan::make(&job, args.shard, &mut findings, &interrupt)?;
    if interrupt.is_raised() {
        return Ok(interrupted(console));
    }
    let redo = redo::read(args.redo.as_deref(), &plan).map_err(Stop::usage)?;
    if args.dry_run {
        plan.print(console);
        return Ok(findings.outcome());
    }
    label_scenes(args, &job, &plan, &redo, findings, &interrupt)
}

fn label_scenes(
    args: &LabelArgs,
    job: &Job,
    plan: &Plan,
    redo: &Redo,
    mut findings: Findings,
    interrupt: &Interrupt,
) -> Result<Outcome, Stop> {
    let record = records::run_record(job, plan)?;
    tell_notes(job);
    let (mut begun, mut finished) = begin_run(args, &record, &mut findings, job.console)?;
    finished.retain(|keyframe, _| !redo.contains(keyframe));
    let tree = &LabelTree::new(&args.output);
    let progress = Progress::new(args.progress, job.console, plan.scenes.len(), plan.keyframes());
    let mut report = Report::new();
    let mut entries = Vec::new();
    for (at, planned) in plan.scenes.iter().enumerate() {
        let run = SceneRun { job, tree, planned, progress: &progress, interrupt };
        let next = plan.files_after(at, &finished);
        let done = while_reading(&job.args.log.input, &planned.files, next, || {
            run.label(&finished, &mut begun.journal, &mut findings)
        })?;
        if interrupt.is_raised() {
            return Ok(interrupted(job.console));
        }
        report.add(&planned.name, &done);
        entries.extend(done.entries);
        progress.scene_done(&planned.name, || done.tally.json(), findings.losses.len());
        job.console.result(&done.tally.line(&planned.name));
    }
    drop(progress);
    let outcome = findings.outcome();
    let manifest = write_manifests(job, tree, plan, &record, &entries, &begun)?;
    begun.end(&manifest, report.json(outcome, &findings, job.threads))?;
    if plan.scenes.len() != 1 {
        job.console.result(&report.total_line());
    }
    Ok(outcome)
}

fn interrupted(console: &Console) -> Outcome {
    console.info("interrupted: the same command goes on from here");
    Outcome::Interrupted
}

/// What the label sets do not say as our own would.
fn tell_notes(job: &Job) {
    for (_, target) in job.targets.all() {
        let name = target.folder.as_deref().unwrap_or("labels");
        target.notes.iter().for_each(|note| job.console.info(&format!("{name}: {note}")));
    }
}
