//! `convert`: labels of one dialect as another's, keyframe by keyframe.

mod job;
mod output;
mod records;
mod report;
mod writer;

use occlabel_core::Fault;
use occlabel_labels::{LabelTree, RESUME_DIFFERS, Resume, RunFiles, begin};

use crate::args::ConvertArgs;
use crate::console::Console;
use crate::convert::job::Job;
use crate::convert::report::Report;
use crate::exit::{Outcome, Stop};
use crate::interrupt::Interrupt;
use crate::threads::start_threads;
use crate::urls::check_url;

pub(crate) fn run(args: &ConvertArgs, console: &Console) -> Result<Outcome, Stop> {
    let interrupt = Interrupt::listen();
    start_threads(args.jobs);
    check_url(&args.output)?;
    let job = Job::plan(args)?;
    let record = records::run_record(&job)?;
    let files = RunFiles::whole(LabelTree::new(&args.output));
    output::check(&files, &record).map_err(Stop::usage)?;
    let mut begun = begin(&files, &record, Resume::IfSame).map_err(other_labels)?;
    let entries = writer::write_all(&job, files.tree(), &mut begun, &interrupt)?;
    if interrupt.is_raised() {
        console.info("interrupted: the same command goes on from here");
        return Ok(Outcome::Interrupted);
    }
    let report = Report::of(&job, &entries);
    begun.end(&records::manifest(&job, &record, &entries, &report), report.json())?;
    report.print(console, args.json);
    Ok(Outcome::Complete)
}

/// The output holds what was made of other labels.
fn other_labels(fault: Fault) -> Stop {
    match fault.rule {
        RESUME_DIFFERS => Stop::usage(fault.hint("give another --output")),
        _ => fault.into(),
    }
}
