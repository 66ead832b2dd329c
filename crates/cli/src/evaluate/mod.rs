//! `evaluate`: the benchmarks' scores of predictions.

mod classes;
mod mask;
mod missing;
mod plan;
mod report;
mod stream;

use occlabel_core::Fault;
use occlabel_evaluate::scores::SceneAttributes;

use crate::args::EvaluateArgs;
use crate::console::Console;
use crate::evaluate::plan::Plan;
use crate::evaluate::report::Report;
use crate::exit::{Outcome, Stop};
use crate::label_pairs::LabelPairs;
use crate::threads::start_threads;

pub(crate) fn run(args: &EvaluateArgs, console: &Console) -> Result<Outcome, Stop> {
    let attributes = attributes(args).map_err(Stop::usage)?;
    let pairs = open(args).map_err(Stop::usage)?;
    let missing = missing::check(&pairs, args)?;
    let plan = Plan::new(args, &pairs)?;
    plan.left_out.iter().for_each(|why| console.info(why));
    tell_unknown(&pairs, &attributes, args, console);
    start_threads(args.jobs);
    let breakdown = stream::score(&plan, &pairs, &attributes)?;
    let report = Report { args, plan: &plan, pairs: &pairs, breakdown: &breakdown };
    console.result(&if args.json { report.json() } else { report.table() });
    match missing {
        Some(missing) => {
            console.warning("predictions", &missing);
            Ok(Outcome::Degraded)
        }
        None => Ok(Outcome::Complete),
    }
}

fn open(args: &EvaluateArgs) -> Result<LabelPairs, Fault> {
    let truth = (args.truth.as_path(), args.truth_dialect.as_deref());
    let prediction = (args.prediction.as_path(), args.prediction_dialect.as_deref());
    LabelPairs::open(truth, prediction, &args.scenes)
}

fn attributes(args: &EvaluateArgs) -> Result<SceneAttributes, Fault> {
    let Some(file) = &args.attributes else { return Ok(SceneAttributes::default()) };
    let place = file.display().to_string();
    let text = std::fs::read_to_string(file).map_err(|error| {
        Fault::new("attributes", &place, "a table of scenes", error.to_string())
    })?;
    SceneAttributes::parse(&text, &place)
}

/// Scenes that the table of attributes does not have.
fn tell_unknown(
    pairs: &LabelPairs,
    attributes: &SceneAttributes,
    args: &EvaluateArgs,
    console: &Console,
) {
    let mut unknown: Vec<&str> = pairs.both.iter().map(|(key, _)| key.scene.as_str()).collect();
    unknown.dedup();
    unknown.retain(|scene| !attributes.knows(scene));
    if let (Some(file), false) = (&args.attributes, unknown.is_empty()) {
        let file = file.display();
        let scenes = unknown.join(", ");
        console.info(&format!("{file} does not have {} scenes: {scenes}", unknown.len()));
    }
}
