//! The beginning of a run: what it is, and what earlier ones finished of it.

use occlabel_core::Fault;
use occlabel_labels::{Begun, LabelTree, RESUME_DIFFERS, Resume, RunFiles, RunRecord, begin};

use crate::args::{LabelArgs, ResumeArg};
use crate::console::Console;
use crate::exit::Stop;
use crate::label::findings::Findings;
use crate::label::report::EarlierReport;
use crate::label::scene_run::Finished;

/// The run, and what earlier ones finished of it.
pub(crate) fn begin_run(
    args: &LabelArgs,
    record: &RunRecord,
    findings: &mut Findings,
    console: &Console,
) -> Result<(Begun, Finished), Stop> {
    let files = run_files(args);
    let earlier = EarlierReport::load(&files.report())?;
    let mut begun = begin(&files, record, resume(args.resume)).map_err(usage_if_differs)?;
    let mut finished = std::mem::take(&mut begun.finished);
    earlier.recall(&mut finished);
    if !begun.differences.is_empty() {
        findings.warn(console, "all scenes", &kept_others(args, &begun.differences));
    }
    Ok((begun, finished))
}

/// Keyframes are kept which this configuration or these inputs would not give.
fn kept_others(args: &LabelArgs, differences: &[String]) -> Fault {
    let place = args.output.display().to_string();
    let expected = "finished keyframes of this very run";
    Fault::new("kept-others", place, expected, differences.join("; "))
}

fn run_files(args: &LabelArgs) -> RunFiles {
    let tree = LabelTree::new(&args.output);
    match args.shard {
        None => RunFiles::whole(tree),
        Some(shard) => RunFiles::shard(tree, shard.index, shard.count),
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
