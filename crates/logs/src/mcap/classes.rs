//! What raw point labels mean: numbers by their names, names by the taxonomy.

use std::collections::BTreeMap;

use occlabel_core::{Fault, McapSettings, PointLabel};

use super::recording::Recording;
use crate::ReadOptions;

/// The metadata record that names the numbers.
const POINT_LABELS: &str = "point_labels";

/// The names of numbers that the log itself gives.
pub(super) fn label_names(recording: &Recording) -> Option<&BTreeMap<String, String>> {
    let metadata = recording.contents.metadata.iter();
    let names = metadata.rev().find(|record| record.name == POINT_LABELS);
    names.map(|record| &record.metadata)
}

/// The labels of a sweep's points, as they come up.
pub(super) struct PointClasses<'a> {
    read: &'a ReadOptions,
    settings: &'a McapSettings,
    names: Option<&'a BTreeMap<String, String>>,
    /// By raw number: its name, what it means, how many points have it.
    seen: BTreeMap<i64, (String, PointLabel, usize)>,
}

impl<'a> PointClasses<'a> {
    /// None yet.
    pub(super) fn new(
        read: &'a ReadOptions,
        settings: &'a McapSettings,
        recording: &'a Recording,
    ) -> Self {
        Self { read, settings, names: label_names(recording), seen: BTreeMap::new() }
    }

    /// What a raw number means; nobody labelled a point whose number means nothing.
    pub(super) fn label(&mut self, raw: f64) -> PointLabel {
        let raw = raw as i64;
        if let Some((_, label, count)) = self.seen.get_mut(&raw) {
            *count += 1;
            return *label;
        }
        let name = self.name(raw);
        let label = self.read.point_label(&name).unwrap_or(PointLabel::Unlabelled);
        self.seen.insert(raw, (name, label, 1));
        label
    }

    /// As the settings say, else as the log says, else the number itself.
    fn name(&self, raw: i64) -> String {
        let number = raw.to_string();
        let named = self.settings.classes.get(&number);
        let named = named.or_else(|| self.names.and_then(|names| names.get(&number)));
        named.cloned().unwrap_or(number)
    }

    /// What to say of labels that mean nothing, if a class stands in for them.
    ///
    /// # Errors
    /// If there are such, and none does.
    pub(super) fn finish(self, file: &str, record: &str) -> Result<Option<Fault>, Fault> {
        let is_unknown = |name: &String| !self.read.taxonomy.points.contains_key(name);
        let unknown = self.seen.iter().filter(|(_, (name, ..))| is_unknown(name));
        let told = |(raw, (name, _, count)): (&i64, &(String, PointLabel, usize))| {
            format!("{raw} (`{name}`) of {count} points")
        };
        let found: Vec<String> = unknown.map(told).collect();
        if found.is_empty() {
            return Ok(None);
        }
        let expected = "point labels that the taxonomy names";
        let fault = Fault::new("unknown-label", file, expected, found.join(", ")).record(record);
        self.read.unknown(fault).map(Some)
    }
}
