//! Raw labels: the names that a log gives to its points and boxes, numbered.

use std::collections::BTreeSet;

use occlabel_core::{Fault, Taxonomy};

/// Every raw name of a taxonomy, points' and boxes', in byte order.
#[derive(Debug)]
pub(crate) struct RawNames<'a>(Vec<&'a str>);

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
        Ok(Self(names))
    }

    /// All names; a name's place is its number.
    pub(crate) fn all(&self) -> &[&'a str] {
        &self.0
    }

    /// The number of a name of the taxonomy.
    pub(crate) fn number(&self, name: &str) -> u8 {
        self.0.binary_search(&name).unwrap_or_default() as u8
    }
}
