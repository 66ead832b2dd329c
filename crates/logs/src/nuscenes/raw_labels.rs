//! What raw point labels mean.

use std::collections::BTreeMap;

use occlabel_core::{Fault, Meaning};

use super::NuScenesLog;
use super::rows::Category;
use super::table::Row;

/// By raw label: its name, and what the taxonomy says that it means.
#[derive(Debug)]
pub(super) struct RawLabels<'a> {
    classes: BTreeMap<u16, (&'a str, Option<Meaning>)>,
}

impl<'a> RawLabels<'a> {
    /// The raw labels of category.json.
    ///
    /// # Errors
    /// If a category has no `index`, or that of another.
    pub(super) fn of_log(log: &'a NuScenesLog) -> Result<Self, Fault> {
        let taxonomy = &log.options.read.taxonomy;
        let mut rows: Vec<_> = log.tables.categories.values().collect();
        rows.sort_by_key(|row| row.offset);
        let mut classes = BTreeMap::new();
        for row in rows {
            let index = row.index.ok_or_else(|| without_index(row))?;
            let meaning = taxonomy.points.get(&row.name).copied();
            if let Some((other, _)) = classes.insert(index, (row.name.as_str(), meaning)) {
                let found = format!("{index}, which `{other}` has too");
                return Err(row.fault("category-index", "an `index` of its own", found));
            }
        }
        Ok(Self { classes })
    }

    /// What a raw label means, if that is known.
    pub(super) fn meaning(&self, raw: u16) -> Option<Meaning> {
        self.classes.get(&raw).and_then(|(_, meaning)| *meaning)
    }

    /// The labels of `raw` that have no meaning, each with its name and how many points are of it;
    /// `None` if all have one.
    pub(super) fn unknown(&self, raw: &[u16]) -> Option<String> {
        let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
        for &label in raw.iter().filter(|&&label| self.meaning(label).is_none()) {
            *counts.entry(label).or_default() += 1;
        }
        let told = |(label, count): (&u16, &usize)| {
            let name = self.classes.get(label).map_or("no category", |(name, _)| name);
            format!("{label} ({name}) of {count} points")
        };
        let list: Vec<String> = counts.iter().map(told).collect();
        (!list.is_empty()).then(|| list.join(", "))
    }
}

/// The category.json of nuScenes has no `index`, that of nuScenes-lidarseg has (nuscenes-devkit#547).
fn without_index(row: &Row<Category>) -> Fault {
    let hint = "unpack nuScenes-lidarseg last: its category.json replaces that of nuScenes";
    row.fault("category-index", "an `index`, as points are labelled", "none").hint(hint)
}
