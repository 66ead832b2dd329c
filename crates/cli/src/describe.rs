//! `describe`: what label files look like, what they hold, and what is odd about it.

use std::path::Path;

use occlabel_core::{Fault, printable};
use occlabel_dialects::LabelSet;
use occlabel_dialects::describe::{Description, Examined};
use occlabel_disk as disk;
use rayon::prelude::*;

use crate::args::DescribeArgs;
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::threads::start_threads;

pub(crate) fn run(args: &DescribeArgs, console: &Console) -> Result<Outcome, Stop> {
    start_threads(args.jobs);
    let description = match disk::is_dir(&args.input) {
        true => describe_folder(&args.input, args.dialect.as_deref())?,
        false => Description::of_file(&args.input, args.dialect.as_deref())?,
    };
    if args.json {
        console.result(&serde_json::to_string(&description).expect("a description is JSON"));
    } else {
        description.to_string().lines().for_each(|line| console.result(&printable(line)));
    }
    match args.strict && !description.suspicions.is_empty() {
        true => Err(suspicious(&args.input, &description).into()),
        false => Ok(Outcome::Complete),
    }
}

fn describe_folder(folder: &Path, dialect: Option<&str>) -> Result<Description, Fault> {
    let set = LabelSet::open(folder, dialect)?;
    let keyframes = (0..set.keyframes().len()).into_par_iter();
    let examined = keyframes.map(|at| Examined::of_keyframe(&set, at));
    let add = |mut sum: Examined, more| {
        sum += more;
        Ok(sum)
    };
    let examined = examined.try_reduce(Examined::default, add)?;
    Ok(Description::of_set(folder.display().to_string(), &set, &examined))
}

fn suspicious(place: &Path, description: &Description) -> Fault {
    let rules: Vec<_> = description.suspicions.iter().map(|suspicion| suspicion.rule).collect();
    let place = place.display().to_string();
    Fault::new("suspicious", place, "nothing suspicious", rules.join(", "))
}
