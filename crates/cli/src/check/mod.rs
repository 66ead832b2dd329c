//! `check`: every fault of a log at once, and nothing written.

mod report;
mod scene;

use occlabel_core::{ClassId, Fault};
use occlabel_logs::{Finding, NuScenesLog, Severity};

use crate::args::{CheckArgs, Format};
use crate::check::report::Report;
use crate::check::scene::SceneCheck;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::input::{Opened, Stead, open_with};
use crate::threads::start_threads;

pub(crate) fn run(args: &CheckArgs, console: &Console) -> Result<Outcome, Stop> {
    start_threads(args.jobs);
    let mut report = Report::default();
    // A class stands in for what the taxonomy does not name, so that all of it comes to light.
    match open_with(&args.log, &args.config, &Stead { class: Some(ClassId(0)), ..Stead::default() })
    {
        Ok(opened) => check_scenes(args, &opened, console, &mut report),
        Err(Stop::Failed(faults)) => faults.into_iter().for_each(|fault| report.add_error(fault)),
        Err(usage) => {
            // Whoever reads JSON gets its one object, whatever the exit code.
            if args.json {
                usage.faults().iter().for_each(|fault| report.add_error(fault.clone()));
                report.print(args.json, console);
            }
            return Err(usage);
        }
    }
    if report.has_errors() && args.log.format == Format::Nuscenes {
        let references =
            NuScenesLog::reference_faults(&args.log.input, args.log.version.as_deref());
        references.into_iter().for_each(|fault| report.add_error(fault));
    }
    report.print(args.json, console);
    report.outcome()
}

fn check_scenes(args: &CheckArgs, opened: &Opened, console: &Console, report: &mut Report) {
    let takes_unknown = args.log.unknown_as.is_some();
    for name in opened.source.scene_names() {
        console.info(&format!("checking {name}"));
        let check = SceneCheck { opened, root: &args.log.input, name: &name, takes_unknown };
        let (findings, figures) = check.run();
        report.add_scene(&name, findings, figures);
    }
}

/// A finding about the log as a whole.
fn error(fault: Fault) -> Finding {
    Finding { scene: None, severity: Severity::Error, fault }
}
