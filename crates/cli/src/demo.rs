//! `demo`: a small street is simulated, labelled, judged against its exact truth, and drawn.

use std::path::Path;

use clap::{Parser, ValueEnum};
use occlabel_core::{Fault, Palette};
use occlabel_labels::{LabelTree, Manifest, TreePath, create_dir, read_labels, write_file};
use occlabel_simulate::shipped_world;
use occlabel_view::{BirdsEye, Orbit, Painted, birds_eye, perspective, png};

use crate::args::{Cli, DemoArgs, Format};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::format_flags::name;

/// The world that is driven through.
const WORLD: &str = "street";
/// Longer side of the map from above, pixels: a whole number a voxel.
const MAP_PX: u32 = 800;
/// Size of the picture in perspective, pixels.
const PERSPECTIVE_PX: (u32, u32) = (1600, 900);

pub(crate) fn run(args: &DemoArgs, console: &Console) -> Result<Outcome, Stop> {
    let [log, labels, pictures] =
        ["log", "labels", "pictures"].map(|name| args.output.join(name).display().to_string());
    let simulate =
        ["occlabel", "simulate", "--world", WORLD, "--format", "nuscenes", "--output", &log];
    let label = ["occlabel", "label", "--format", "nuscenes", "--input", &log, "--output", &labels];
    let judge = ["occlabel", "quality", &labels, "--world-truth", &log];
    if !has_log(Path::new(&log)) {
        step(&simulate, console)?;
    }
    let outcome = step(&[&label[..], &["--evidence"]].concat(), console)?;
    step(&judge, console)?;
    draw(Path::new(&labels), Path::new(&pictures), console)?;
    tell_next(console);
    Ok(outcome)
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

/// Draws the keyframe in the middle of the drive.
fn draw(labels: &Path, pictures: &Path, console: &Console) -> Result<(), Stop> {
    let Some(manifest) = Manifest::load(&labels.join("manifest.json"))? else { return Ok(()) };
    let Some((scene, record)) = manifest.scenes.first_key_value() else { return Ok(()) };
    let Some(token) = record.keyframes.get(record.keyframes.len() / 2) else { return Ok(()) };
    let spec = manifest.grid.spec()?;
    let file = LabelTree::new(labels).place(&TreePath::labels(scene, token)?);
    let arrays = read_labels(&file, &spec)?;
    let names: Vec<&str> = manifest.classes.iter().map(|class| class.name.as_str()).collect();
    let painted = Painted {
        spec: &spec,
        semantics: &arrays.semantics,
        mask_lidar: Some(&arrays.mask_lidar),
        mask_camera: Some(&arrays.mask_camera),
        free: u8::try_from(manifest.free).unwrap_or(u8::MAX),
        palette: &Palette::of(&names),
    };
    write_pictures(&painted, pictures)?;
    let look = pictures.display();
    console.result(&format!("Look at     {look}/birds_eye.png and {look}/perspective.png"));
    console.result(&format!("Read        numpy.load(\"{}\")[\"semantics\"]", file.display()));
    Ok(())
}

fn write_pictures(labels: &Painted, pictures: &Path) -> Result<(), Fault> {
    let (width, height) = PERSPECTIVE_PX;
    create_dir(pictures)?;
    let above = birds_eye(labels, &BirdsEye { map_px: MAP_PX });
    write_file(&pictures.join("birds_eye.png"), &png(&above))?;
    let behind = perspective(labels, &Orbit::behind(labels.spec, width, height));
    write_file(&pictures.join("perspective.png"), &png(&behind))
}

/// Formats are named by the list that the program takes.
fn tell_next(console: &Console) {
    let formats: Vec<String> =
        Format::value_variants().iter().map(|format| name(*format)).collect();
    let formats = formats.join("|");
    console.result(&format!("Your log    occlabel check --format {formats} --input DIR"));
    console.result("            occlabel label --format FORMAT --input DIR --output LABELS");
    console.result("Its quality occlabel quality --held-out 5 --format FORMAT --input DIR");
}
