//! `demo`: a small street is simulated, labelled, judged against its exact truth, and shown.

use std::path::{Path, PathBuf};

use clap::{Parser, ValueEnum};
use occlabel_labels::{Manifest, create_dir};
use occlabel_simulate::shipped_world;

use crate::args::{Cli, DemoArgs, Format};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::format_flags::name;

/// The world that is driven through.
const WORLD: &str = "street";

pub(crate) fn run(args: &DemoArgs, console: &Console) -> Result<Outcome, Stop> {
    let [log, labels] = ["log", "labels"].map(|name| args.output.join(name).display().to_string());
    let simulate =
        ["occlabel", "simulate", "--world", WORLD, "--format", "nuscenes", "--output", &log];
    let label = ["occlabel", "label", "--format", "nuscenes", "--input", &log, "--output", &labels];
    let judge = ["occlabel", "quality", &labels, "--world-truth", &log];
    if !has_log(Path::new(&log)) {
        step(&simulate, console)?;
    }
    let outcome = step(&[&label[..], &["--evidence"]].concat(), console)?;
    step(&judge, console)?;
    let shown = show(&args.output, &log, &labels, console)?;
    tell_next(&shown, Path::new(&labels), console)?;
    Ok(outcome)
}

/// Shows the labels as pictures and pages: the files that were made.
fn show(output: &Path, log: &str, labels: &str, console: &Console) -> Result<Vec<PathBuf>, Stop> {
    create_dir(&output.join("pictures"))?;
    let with_log = ["--format", "nuscenes", "--input", log];
    let cubes = ["--picture", "perspective"];
    let over_images = [&["--picture", "overlay"][..], &with_log].concat();
    let shown: [(&str, &str, &[&str]); 5] = [
        ("view", "pictures/sheet.png", &[]),
        ("view", "pictures/perspective.png", &cubes),
        ("view", "pictures/overlay.png", &over_images),
        ("view", "labels.html", &[]),
        ("report", "report.html", &[]),
    ];
    let make = |(command, name, flags): (&str, &str, &[&str])| {
        let file = output.join(name);
        let to = file.display().to_string();
        let line = [&["occlabel", command, labels, "--output", &to], flags].concat();
        step(&line, console).map(|_| file)
    };
    shown.into_iter().map(make).collect()
}

/// Whether an earlier demo drove through the same world: then its labels are found done.
fn has_log(log: &Path) -> bool {
    let driven = std::fs::read_to_string(log.join("truth/world.toml"));
    driven.ok().as_deref() == shipped_world(WORLD)
}

/// Runs a command line and shows it, so that it can be repeated.
fn step(line: &[&str], console: &Console) -> Result<Outcome, Stop> {
    console.result(&format!("$ {}", line.join(" ")));
    let cli = Cli::try_parse_from(line).expect("a line that the program takes");
    let outcome = crate::dispatch(&cli.command, console)?;
    console.result("");
    Ok(outcome)
}

/// How to open what was made, and what to do next. Formats are named by the list that the program takes.
fn tell_next(shown: &[PathBuf], labels: &Path, console: &Console) -> Result<(), Stop> {
    console.result("Open these with any browser; they need neither server nor network:");
    for file in shown {
        let full = std::fs::canonicalize(file).unwrap_or_else(|_| file.clone());
        console.result(&format!("            file://{}", full.display()));
    }
    if let Some(arrays) = first_arrays(labels)? {
        console.result(&format!("Read        numpy.load(\"{}\")[\"semantics\"]", arrays.display()));
    }
    let formats: Vec<String> =
        Format::value_variants().iter().map(|format| name(*format)).collect();
    let formats = formats.join("|");
    console.result(&format!("Your log    occlabel check --format {formats} --input DIR"));
    console.result("            occlabel label --format FORMAT --input DIR --output LABELS");
    console.result("Its quality occlabel quality --held-out 5 --format FORMAT --input DIR");
    console.result("Its looks   occlabel view LABELS --output labels.html");
    console.result(
        "            occlabel view LABELS --output labels.mcap --format FORMAT --input DIR",
    );
    Ok(())
}

/// The first keyframe's arrays.
fn first_arrays(labels: &Path) -> Result<Option<PathBuf>, Stop> {
    let manifest = Manifest::load(&labels.join("manifest.json"))?;
    let files = manifest.into_iter().flat_map(|manifest| manifest.files);
    let mut files = files.map(|file| labels.join(file.path.as_str()));
    Ok(files.find(|file| file.ends_with("labels.npz")))
}
