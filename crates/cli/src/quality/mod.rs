//! `quality`: how right labels are.

mod held_out;
mod held_out_scene;
mod judged_tree;
mod known_worlds;
mod painted;
mod verdict;
mod world_truth;

use crate::args::QualityArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};

pub(crate) fn run(args: &QualityArgs, console: &Console) -> Result<Outcome, Stop> {
    match (&args.world_truth, &args.log) {
        (Some(truth), _) => world_truth::run(args, truth, console),
        (None, Some(log)) if args.painted => painted::run(args, log, console),
        _ => held_out::run(args, console),
    }
}
