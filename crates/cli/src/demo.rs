//! `demo`: the main job on a small drive that ships with the program.

use std::path::Path;

use clap::Parser;
use include_dir::{Dir, include_dir};
use occlabel_core::Fault;
use occlabel_labels::{
    LabelArrays, LabelTree, Manifest, TreePath, create_dir, read_labels, write_file,
};

use crate::args::{Cli, Command, DemoArgs};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::label;

/// A simulated street, 3 keyframes and 9 sweeps, in nuScenes format.
static DRIVE: Dir = include_dir!("$CARGO_MANIFEST_DIR/../../tests/fixtures/nano");

pub(crate) fn run(args: &DemoArgs, console: &Console) -> Result<Outcome, Stop> {
    let (log, labels) = (args.output.join("log"), args.output.join("labels"));
    unpack(&DRIVE, &log)?;
    let line = label_line(&log, &labels);
    console.result(&format!("$ {}", line.join(" ")));
    let outcome = label(&line, console)?;
    show(&labels, console)?;
    Ok(outcome)
}

/// Writes the drive's files, those alone that are not there yet: a second demo finds its labels done.
fn unpack(folder: &Dir, log: &Path) -> Result<(), Fault> {
    create_dir(&log.join(folder.path()))?;
    for file in folder.files() {
        let path = log.join(file.path());
        if std::fs::read(&path).ok().as_deref() != Some(file.contents()) {
            write_file(&path, file.contents())?;
        }
    }
    folder.dirs().try_for_each(|inner| unpack(inner, log))
}

fn label_line(log: &Path, labels: &Path) -> Vec<String> {
    let (log, labels) = (log.display().to_string(), labels.display().to_string());
    let words = [
        "occlabel",
        "label",
        "--format",
        "nuscenes",
        "--input",
        &log,
        "--output",
        &labels,
        "--evidence",
    ];
    words.map(str::to_owned).to_vec()
}

fn label(line: &[String], console: &Console) -> Result<Outcome, Stop> {
    let cli = Cli::try_parse_from(line).expect("a line that the program takes");
    match cli.command {
        Command::Label(args) => label::run(&args, console),
        _ => unreachable!("the line says label"),
    }
}

/// Draws the first keyframe, and says how to go on.
fn show(labels: &Path, console: &Console) -> Result<(), Stop> {
    let tree = LabelTree::new(labels);
    let Some(manifest) = Manifest::load(&labels.join("manifest.json"))? else { return Ok(()) };
    let Some((scene, record)) = manifest.scenes.first_key_value() else { return Ok(()) };
    let Some(token) = record.keyframes.first() else { return Ok(()) };
    let file = tree.place(&TreePath::labels(scene, token)?);
    let arrays = read_labels(&file, &manifest.grid.spec()?)?;
    console.result("");
    picture(&arrays, &manifest).iter().for_each(|row| console.result(row));
    console.result("");
    console.result(
        "Read a keyframe:  import numpy; labels = numpy.load(FILE); labels['semantics'][x, y, z]",
    );
    console.result(&format!("FILE              {}", file.display()));
    console.result("Your own log:     occlabel label --format nuscenes --input DIR --output DIR");
    Ok(())
}

/// Voxels a side that one character of the picture stands for.
const BLOCK: usize = 4;

/// A bird's-eye view: the class of the topmost occupied voxel of each block, x up, y left.
fn picture(arrays: &LabelArrays, manifest: &Manifest) -> Vec<String> {
    let [nx, ny, _] = arrays.semantics.shape();
    let row = |x: usize| (0..ny / BLOCK).rev().map(|y| block(arrays, manifest, x, y)).collect();
    let mut rows: Vec<String> = (0..nx / BLOCK).rev().map(row).collect();
    rows.push(
        "# manmade  Y vegetation  = road  - sidewalk  , terrain  C vehicle  P pedestrian".into(),
    );
    rows.push("| barrier  . free or unobserved; x up, y left, ego in the middle".into());
    rows
}

fn block(arrays: &LabelArrays, manifest: &Manifest, x: usize, y: usize) -> char {
    let (nz, free) = (arrays.semantics.shape()[2], manifest.free);
    for z in (0..nz).rev() {
        for (i, j) in (0..BLOCK * BLOCK).map(|at| (at / BLOCK, at % BLOCK)) {
            let class = *arrays.semantics.at([x * BLOCK + i, y * BLOCK + j, z]);
            if class != free {
                return glyph(&manifest.classes[usize::from(class)].name);
            }
        }
    }
    '.'
}

fn glyph(class: &str) -> char {
    match class {
        "manmade" => '#',
        "vegetation" => 'Y',
        "driveable_surface" => '=',
        "sidewalk" => '-',
        "terrain" | "other_flat" => ',',
        "pedestrian" => 'P',
        "barrier" => '|',
        "others" => 'o',
        _ => 'C',
    }
}
