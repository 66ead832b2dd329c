//! What a log holds, for those who have to tell the reader what it is for.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use occlabel_core::{Fault, McapSettings};

use super::classes::label_names;
use super::container::{Container, Message};
use super::dispatch::{Decoded, decode};
use super::layout::{FrameRoles, lidar_names};
use super::options::{McapOptions, Purpose, purpose};
use super::points::Points;
use super::recording::Recording;
use super::sweeps::label_field;
use crate::notes::Notes;

/// A line for each topic, frame and cloud of a file; then `[reader.mcap]`, with every `"auto"` and
/// every empty table filled in as far as the file tells.
///
/// # Errors
/// If it cannot be read.
pub(super) fn survey(root: &Path, file: &str, options: &McapOptions) -> Result<Vec<String>, Fault> {
    let (contents, _) = Container::open(root, file, options.settings.max_record_bytes)?.contents();
    let mut lines: Vec<String> = Vec::new();
    for channel in contents.channels.values() {
        let read_as = purpose(&options.settings, channel).map_or("not read", |p| p.name());
        let (topic, schema) = (&channel.topic, &channel.schema.name);
        lines.push(format!("{topic}: {} {schema}, {read_as}", channel.encoding));
    }
    lines.sort();
    let mut notes = Notes::default();
    let recording = Recording::read(root, file, options, &mut notes)?;
    lines.extend(recording.frames.describe());
    let mut fields: BTreeMap<&str, &[String]> = BTreeMap::new();
    for cloud in &recording.clouds {
        fields.entry(&cloud.topic).or_insert(&cloud.fields);
    }
    let told =
        |(topic, fields): (&str, &[String])| format!("{topic}: points of {}", fields.join(", "));
    lines.extend(fields.into_iter().map(told));
    let mut filled = filled_in(&recording, &options.settings);
    for raw in raw_labels(root, &recording, &filled) {
        filled.classes.entry(raw.clone()).or_insert(raw);
    }
    lines.push("# as a file for --config:".into());
    lines.extend(table(&filled));
    Ok(lines)
}

/// The raw labels in the first cloud of each topic; a cloud that cannot be read tells of none.
fn raw_labels(root: &Path, recording: &Recording, settings: &McapSettings) -> BTreeSet<String> {
    let mut labels = BTreeSet::new();
    let mut takes = |message: &Message| {
        if let Ok(Some(Decoded::Cloud(cloud))) = decode(message, false)
            && let Ok(points) = Points::new(&cloud)
            && let Ok(raw) = points.numbers(&settings.label_field)
        {
            labels.extend(raw.map(|raw| (raw as i64).to_string()));
        }
        true
    };
    let wanted = |channel: &_| purpose(settings, channel) == Some(Purpose::Sweeps);
    if let Ok(mut container) = Container::open(root, &recording.file, settings.max_record_bytes) {
        let _ = container.first_of_each(&recording.contents, wanted, &mut takes);
    }
    labels
}

/// The settings as a file states them.
fn table(settings: &McapSettings) -> Vec<String> {
    let mcap = BTreeMap::from([("mcap", settings)]);
    let text = toml::to_string(&BTreeMap::from([("reader", mcap)])).unwrap_or_default();
    text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

fn filled_in(recording: &Recording, settings: &McapSettings) -> McapSettings {
    let mut filled = settings.clone();
    if let Ok(FrameRoles { world, ego }) = FrameRoles::find(recording, settings) {
        (filled.world_frame, filled.ego_frame) = (world, ego);
    }
    let label = recording.clouds.iter().find_map(|cloud| label_field(settings, &cloud.fields));
    filled.label_field = label.unwrap_or("none").to_owned();
    filled.lidars = lidar_names(&recording.clouds, settings);
    for (topic, optics) in &recording.optics {
        let own = || optics.header.frame.clone();
        filled.cameras.entry(topic.clone()).or_insert_with(own);
    }
    for cube in &recording.cubes {
        let own = || cube.category.clone();
        filled.categories.entry(cube.category.clone()).or_insert_with(own);
    }
    for (number, name) in label_names(recording).into_iter().flatten() {
        filled.classes.entry(number.clone()).or_insert_with(|| name.clone());
    }
    filled.boxes = box_topics(recording, settings);
    filled
}

fn box_topics(recording: &Recording, settings: &McapSettings) -> Vec<String> {
    let channels = recording.contents.channels.values();
    let boxes = channels.filter(|channel| purpose(settings, channel) == Some(Purpose::Boxes));
    let topics: BTreeSet<&String> = boxes.map(|channel| &channel.topic).collect();
    topics.into_iter().cloned().collect()
}
