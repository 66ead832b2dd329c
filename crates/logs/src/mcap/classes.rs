//! What raw point labels are called.

use std::collections::BTreeMap;

use occlabel_core::McapSettings;

use super::recording::Recording;

/// The metadata record that names the numbers.
const POINT_LABELS: &str = "point_labels";

/// The names of numbers that the log itself gives.
pub(super) fn label_names(recording: &Recording) -> Option<&BTreeMap<String, String>> {
    let metadata = recording.contents.metadata.iter();
    let names = metadata.rev().find(|record| record.name == POINT_LABELS);
    names.map(|record| &record.metadata)
}

/// What a number is called: as the settings say, else as the log says, else the number itself.
pub(super) fn label_name(raw: i64, settings: &McapSettings, recording: &Recording) -> String {
    let number = raw.to_string();
    let named = settings.classes.get(&number);
    let named = named.or_else(|| label_names(recording)?.get(&number));
    named.cloned().unwrap_or(number)
}
