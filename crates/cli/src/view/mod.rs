//! `view`: labels as one can look at them, by the ending of the file that is made.

mod pictures;

use occlabel_core::Fault;

use crate::args::ViewArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::shown_set::ShownSet;

pub(crate) fn run(args: &ViewArgs, console: &Console) -> Result<Outcome, Stop> {
    let ending = args.output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let make = match ending {
        "png" => pictures::make,
        _ => return Err(Stop::usage(unknown_ending(args))),
    };
    let labels = ShownSet::open(&args.labels, args.dialect.as_deref()).map_err(Stop::usage)?;
    let labels = labels.colored(args.colors.into());
    make(args, &labels, console)?;
    console.result(&args.output.display().to_string());
    Ok(Outcome::Complete)
}

fn unknown_ending(args: &ViewArgs) -> Fault {
    let place = args.output.display().to_string();
    Fault::new("output", place, "a file that ends in .png", "another ending")
}
