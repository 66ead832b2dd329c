//! `view`: labels as one can look at them, by the ending of the file that is made.

mod cameras;
mod mesh;
mod page;
mod picture_flags;
mod pictures;
mod recording;

use occlabel_core::Fault;

use crate::args::ViewArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::shown_set::ShownSet;

pub(crate) fn run(args: &ViewArgs, console: &Console) -> Result<Outcome, Stop> {
    let ending = args.output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let make = match ending {
        "html" => page::make,
        "png" => pictures::make,
        "mcap" => recording::make,
        "ply" => mesh::make_ply,
        "glb" => mesh::make_glb,
        _ => return Err(Stop::usage(unknown_ending(args))),
    };
    if ending != "png" {
        args.picture.check_unused().map_err(Stop::usage)?;
    }
    refuse_unused(args, ending).map_err(Stop::usage)?;
    let labels = ShownSet::open(&args.labels, args.dialect.as_deref()).map_err(Stop::usage)?;
    let labels = labels.colored(args.colors.into());
    make(args, &labels, console)?;
    console.result(&args.output.display().to_string());
    Ok(Outcome::Complete)
}

fn unknown_ending(args: &ViewArgs) -> Fault {
    let place = args.output.display().to_string();
    Fault::new(
        "output",
        place,
        "a file that ends in .png, .html, .mcap, .ply or .glb",
        "another ending",
    )
}

/// Refuses flags that this kind of output has no use for.
fn refuse_unused(args: &ViewArgs, ending: &str) -> Result<(), Fault> {
    let flags = [
        ("--all-sweeps", args.all_sweeps, &["mcap"][..]),
        ("--mesh", args.mesh.is_some(), &["ply"]),
        ("--input", args.log.is_some(), &["mcap", "png"]),
    ];
    if args.log.is_none() && !args.config.is_empty() {
        let expected = "--format and --input: a log to be read by it";
        return Err(Fault::new("flags", "--preset, --config, --set", expected, "no log"));
    }
    let unused = flags.iter().find(|(_, given, used_by)| *given && !used_by.contains(&ending));
    let Some((flag, _, used_by)) = unused else { return Ok(()) };
    let expected = format!("an output that ends in .{}", used_by.join(" or ."));
    Err(Fault::new("flags", *flag, expected, format!("one that ends in .{ending}")))
}
