//! `presets`: what ships, and where each number is from.

use occlabel_core::Fault;
use occlabel_pipeline::{
    MASK_TABLES, PRESETS, TAXONOMIES, preset, shipped_masks, shipped_taxonomy,
};

use crate::console::Console;
use crate::exit::{Outcome, Stop};

pub(crate) fn run(name: Option<&str>, console: &Console) -> Result<Outcome, Stop> {
    match name {
        None => list(console),
        Some(name) => console.result(text(name)?.trim_end()),
    }
    Ok(Outcome::Complete)
}

fn list(console: &Console) {
    for (name, text) in PRESETS {
        console.result(&format!("{name:18} {}", first_sentence(text)));
    }
    for (name, text) in TAXONOMIES {
        console.result(&format!("taxonomies/{name:18} {}", first_sentence(text)));
    }
    for (name, text) in MASK_TABLES {
        console.result(&format!("masks/{name:18} {}", first_sentence(text)));
    }
}

/// The first sentence of the comment that heads a file.
fn first_sentence(text: &str) -> String {
    let head: Vec<&str> =
        text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect();
    let head = head.join(" ");
    match head.split_once(". ") {
        Some((first, _)) => format!("{first}."),
        None => head,
    }
}

fn text(name: &str) -> Result<&'static str, Stop> {
    let found = match name.split_once('/') {
        Some(("taxonomies", name)) => shipped_taxonomy(name),
        Some(("masks", name)) => shipped_masks(name),
        _ => preset(name),
    };
    found.ok_or_else(|| Stop::usage(unknown_preset(name)))
}

/// A fault that lists the presets.
pub(crate) fn unknown_preset(name: &str) -> Fault {
    let known: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
    Fault::new("preset", "preset", format!("one of {}", known.join(", ")), format!("`{name}`"))
}
