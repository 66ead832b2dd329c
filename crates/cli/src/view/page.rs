//! Labels as one HTML page.

use occlabel_core::Fault;
use occlabel_dialects::KeyframeKey;
use occlabel_labels::{Manifest, write_file};
use occlabel_view::{PageKeyframe, page};
use rayon::prelude::*;

use crate::args::ViewArgs;
use crate::console::Console;
use crate::exit::Stop;
use crate::shown_set::ShownSet;

/// A page larger than this is told: browsers take long to open it.
const LARGE_BYTES: usize = 100_000_000;

pub(crate) fn make(args: &ViewArgs, labels: &ShownSet, console: &Console) -> Result<(), Stop> {
    let scene = labels.scene(args.scene.as_deref()).map_err(Stop::usage)?;
    let keys = labels.keyframes(&scene.name, &args.keyframes).map_err(Stop::usage)?;
    let made = |key: &KeyframeKey| Ok(PageKeyframe::of(&labels.read(key)?, scene.free));
    let keyframes = keys.par_iter().map(made).collect::<Result<Vec<_>, Fault>>()?;
    let html = page(&scene, &about(labels), &keyframes);
    console.info(&told(&scene.name, &keyframes, html.len()));
    Ok(write_file(&args.output, html.as_bytes())?)
}

/// How large the page is, and of what.
fn told(scene: &str, keyframes: &[PageKeyframe], bytes: usize) -> String {
    let hint = match bytes > LARGE_BYTES {
        true => "; --keyframes TOKEN,... makes a smaller page",
        false => "",
    };
    let megabytes = bytes as f64 / 1e6;
    let (count, ending) = (keyframes.len(), if keyframes.len() == 1 { "" } else { "s" });
    format!("{scene}: {count} keyframe{ending}, {megabytes:.1} MB{hint}")
}

/// Who made the labels, and how, as far as the files tell.
fn about(labels: &ShownSet) -> Vec<(String, String)> {
    let mut rows = vec![("dialect".to_owned(), labels.set.dialect().title.clone())];
    rows.push(("grid frame".to_owned(), labels.set.frame().to_owned()));
    rows.extend(labels.manifest.as_ref().map_or_else(Vec::new, about_run));
    rows
}

fn about_run(manifest: &Manifest) -> Vec<(String, String)> {
    let program = format!("{} {}", manifest.program.name, manifest.program.version);
    let preset = manifest.preset.as_deref().unwrap_or("a configuration file");
    let rows = [
        ("program", program.as_str()),
        ("preset", preset),
        ("taxonomy", &manifest.taxonomy.name),
        ("configuration", &manifest.config_hash),
        ("inputs", &manifest.inputs_hash),
    ];
    let notes = manifest.notes.iter().map(|note| ("note", note.as_str()));
    rows.into_iter().chain(notes).map(|(name, value)| (name.to_owned(), value.to_owned())).collect()
}
