//! What made the labels, of what, and how long it took.

use occlabel_core::Fault;
use occlabel_labels::Manifest;
use occlabel_view::RunClass;

use crate::report::run_report::RunReport;
use crate::shown_set::ShownSet;

/// Names and values in the order in which they are told.
type Facts = Vec<(String, String)>;

/// The classes as they are named and coloured.
pub(crate) fn classes(labels: &ShownSet) -> Result<Vec<RunClass>, Fault> {
    let palette = labels.scene(None)?.palette;
    let class = |id| RunClass { name: palette.label(id), color: palette.color(id) };
    Ok((0..labels.set.classes().free_index()).map(class).collect())
}

/// The configuration as a file states it.
pub(crate) fn config(manifest: &Manifest) -> String {
    toml::to_string_pretty(&manifest.config).unwrap_or_else(|_| manifest.config.to_string())
}

/// All that manifest and report tell.
pub(crate) fn facts(labels: &ShownSet, told: &RunReport) -> Facts {
    let mut facts = Facts::new();
    facts.extend(labels.manifest.iter().flat_map(of_manifest));
    facts.push(fact("Dialect", &labels.set.dialect().title));
    facts.push(fact("Grid", grid(labels)));
    facts.extend(of_report(told));
    facts
}

fn fact(name: &str, value: impl ToString) -> (String, String) {
    (name.to_owned(), value.to_string())
}

fn of_manifest(manifest: &Manifest) -> Facts {
    let Manifest { program, preset, taxonomy, .. } = manifest;
    let own = || "a file of its own".to_owned();
    vec![
        fact("Program", format!("{} {}", program.name, program.version)),
        fact("Preset", preset.clone().unwrap_or_else(own)),
        fact("Configuration, BLAKE3", &manifest.config_hash),
        fact("Input, BLAKE3", &manifest.inputs_hash),
        fact("Taxonomy", format!("{}, BLAKE3 {}", taxonomy.name, taxonomy.hash)),
        fact("Files", files(manifest)),
    ]
}

fn files(manifest: &Manifest) -> String {
    let bytes: u64 = manifest.files.iter().map(|file| file.bytes).sum();
    format!("{}, {} in all", manifest.files.len(), megabytes(bytes))
}

fn grid(labels: &ShownSet) -> String {
    let (spec, frame) = (labels.set.spec(), labels.set.frame());
    let [nx, ny, nz] = spec.shape();
    let text = |m: nalgebra::Vector3<f64>| format!("({}, {}, {})", m.x, m.y, m.z);
    let (size, min, max) =
        (text(spec.size_m()), text(spec.min_m().coords), text(spec.max_m().coords));
    format!("{nx} x {ny} x {nz} voxels of {size} m from {min} to {max} m in the {frame} frame")
}

fn of_report(told: &RunReport) -> Facts {
    let mut facts = Facts::new();
    facts.extend(told.outcome.as_ref().map(|outcome| fact("Outcome", outcome)));
    facts.extend(told.seconds.map(|s| fact("Time", format!("{s:.1} s"))));
    facts.extend(told.threads.map(|threads| fact("Threads", threads)));
    facts.extend(told.peak_memory_bytes.map(|bytes| fact("Peak memory", megabytes(bytes))));
    if told.parts > 1 {
        facts.push(fact(
            "Parts",
            format!("{}; time and memory are those of the largest", told.parts),
        ));
    }
    if told.parts > 0 {
        facts.push(fact("Points", told.total.points));
        facts.push(fact("Rays", told.total.rays));
        facts.push(fact("Boxes without points", told.total.boxes_without_points));
    }
    let host: Vec<&str> = told.host.values().map(String::as_str).collect();
    facts.extend((!host.is_empty()).then(|| fact("Machine", host.join(", "))));
    facts
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}
