//! `report`: one page about a whole run.

mod facts;
mod figures;
mod keyframes;
mod run_report;

use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::write_file;
use occlabel_view::{Remark, Run, RunScene, report_page};

use crate::args::ReportArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::report::run_report::RunReport;
use crate::shown_set::ShownSet;
use crate::threads::start_threads;

pub(crate) fn run(args: &ReportArgs, console: &Console) -> Result<Outcome, Stop> {
    check_ending(&args.output).map_err(Stop::usage)?;
    let quality = args.quality.iter().map(|file| figures::tables(file));
    let quality = quality.collect::<Result<Vec<_>, _>>().map_err(Stop::usage)?.concat();
    let labels = ShownSet::open(&args.labels, args.dialect.as_deref()).map_err(Stop::usage)?;
    let labels = labels.colored(args.colors.into());
    start_threads(args.jobs);
    let (told, notes) = run_report::read(&args.labels)?;
    let scenes = keyframes::scenes(&labels, &told, console)?;
    let run = Run { quality, ..describe(args, &labels, &told, scenes, notes)? };
    let thumbnails = keyframes::thumbnails(&labels, &run)?;
    write_file(&args.output, report_page(&run, &thumbnails).as_bytes())?;
    console.result(&args.output.display().to_string());
    let is_whole = run.scenes.iter().all(|scene| scene.unreadable.is_empty());
    Ok(if is_whole { Outcome::Complete } else { Outcome::Degraded })
}

fn check_ending(output: &Path) -> Result<(), Fault> {
    if output.extension().is_some_and(|ending| ending == "html") {
        return Ok(());
    }
    let place = output.display().to_string();
    Err(Fault::new("output", place, "a file that ends in .html", "another ending"))
}

/// All that labels, manifest and report tell.
fn describe(
    args: &ReportArgs,
    labels: &ShownSet,
    told: &RunReport,
    scenes: Vec<RunScene>,
    mut notes: Vec<String>,
) -> Result<Run, Fault> {
    notes.extend(unfinished(&args.labels, labels));
    notes.extend(labels.manifest.iter().flat_map(|manifest| manifest.notes.clone()));
    let mut remarks: Vec<Remark> = told.remarks();
    remarks.sort();
    Ok(Run {
        name: folder_name(&args.labels),
        classes: facts::classes(labels)?,
        facts: facts::facts(labels, told),
        config: labels.manifest.as_ref().map(facts::config),
        stages: told.stages(),
        drops: told.drops(),
        quality: Vec::new(),
        scenes,
        remarks,
        notes,
    })
}

/// What is missing of a finished run.
fn unfinished(folder: &Path, labels: &ShownSet) -> Option<String> {
    if labels.manifest.is_some() {
        return None;
    }
    let is_begun = disk::is_file(&folder.join("run.json"));
    Some(match is_begun {
        true => "This run is not finished: it has no manifest yet. What stands so far is shown; the same \
            `label` command goes on from there."
            .to_owned(),
        false => "These labels have no manifest: what made them is not known.".to_owned(),
    })
}

/// The folder's own name, however it is written.
fn folder_name(folder: &Path) -> String {
    let full = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    full.file_name().map_or_else(|| "labels".to_owned(), |name| name.to_string_lossy().into_owned())
}
