//! `quality`: how right labels are.

mod held_out;
mod held_out_scene;

use crate::args::QualityArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};

pub(crate) fn run(args: &QualityArgs, console: &Console) -> Result<Outcome, Stop> {
    held_out::run(args, console)
}
