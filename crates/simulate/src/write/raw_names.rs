//! Raw labels: the names that a log gives to its points and boxes, numbered.

use std::collections::BTreeSet;

use occlabel_core::{Fault, Meaning, PointLabel, Taxonomy};

/// Every raw name of a taxonomy, points' and boxes', in byte order.
#[derive(Debug)]
pub(crate) struct RawNames<'a> {
    taxonomy: &'a Taxonomy,
    names: Vec<&'a str>,
}

impl<'a> RawNames<'a> {
    /// The names of a taxonomy.
    ///
    /// # Errors
    /// If a byte cannot number them.
    pub(crate) fn new(taxonomy: &'a Taxonomy) -> Result<Self, Fault> {
        let all = taxonomy.points.keys().chain(taxonomy.boxes.keys());
        let names: Vec<_> = all.map(String::as_str).collect::<BTreeSet<_>>().into_iter().collect();
        if names.len() > 256 {
            let found = names.len().to_string();
            return Err(Fault::new("taxonomy", "points, boxes", "at most 256 names", found));
        }
        Ok(Self { taxonomy, names })
    }

    /// All names; a name's place is its number.
    pub(crate) fn names(&self) -> &[&'a str] {
        &self.names
    }

    /// The name of a number.
    pub(crate) fn name(&self, raw: u8) -> &'a str {
        self.names[usize::from(raw)]
    }

    /// What a point is called that belongs to a thing called `own` and is labelled so: the thing's
    /// own name, or, for an annotator who is wrong, the first name of what he takes it for.
    pub(crate) fn raw(&self, own: &str, label: PointLabel) -> u8 {
        let points = &self.taxonomy.points;
        let called = match meaning(label) {
            Some(taken_for) if points.get(own) != Some(&taken_for) => {
                points.iter().find(|(_, meaning)| **meaning == taken_for)
            }
            _ => None,
        };
        let name = called.map_or(own, |(name, _)| name.as_str());
        self.names.binary_search(&name).unwrap_or_default() as u8
    }
}

fn meaning(label: PointLabel) -> Option<Meaning> {
    match label {
        PointLabel::Class(class) => Some(Meaning::Class(class)),
        PointLabel::Ignored => Some(Meaning::Ignore),
        PointLabel::Unlabelled => None,
    }
}
