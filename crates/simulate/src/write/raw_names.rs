//! Raw labels: the names that a log gives to its points and boxes, numbered.

use std::collections::{BTreeMap, BTreeSet};

use occlabel_core::{Fault, Taxonomy};

use crate::{Drive, World};

/// The categories of nuScenes in the order of their lidarseg index, a line each.
const NUSCENES: &str = include_str!("nuscenes/categories.txt");

/// The raw names of a log: nuScenes' own, numbered as there, if they name everything in its worlds;
/// else all names of the taxonomy, points' and boxes', in byte order.
#[derive(Debug)]
pub(crate) struct RawNames<'a> {
    names: Vec<&'a str>,
    /// Of every name of the taxonomy; of one that is not listed, the number of a listed one that
    /// means the same.
    numbers: BTreeMap<&'a str, u8>,
}

impl<'a> RawNames<'a> {
    /// The names of a log of these drives; the taxonomy is theirs.
    ///
    /// # Errors
    /// If a byte cannot number them.
    pub(crate) fn new(drives: &[Drive], taxonomy: &'a Taxonomy) -> Result<Self, Fault> {
        let mut used = drives.iter().flat_map(|drive| used(drive.world()));
        let nuscenes: Vec<&str> = NUSCENES.lines().collect();
        let names = match used.all(|name| nuscenes.contains(&name)) {
            true => nuscenes,
            false => all(taxonomy).into_iter().collect(),
        };
        if names.len() > 256 {
            let found = names.len().to_string();
            return Err(Fault::new("taxonomy", "points, boxes", "at most 256 names", found));
        }
        let number = |name| number(&names, name, taxonomy).map(|number| (name, number as u8));
        Ok(Self { numbers: all(taxonomy).into_iter().filter_map(number).collect(), names })
    }

    /// All names; a name's place is its number.
    pub(crate) fn all(&self) -> &[&'a str] {
        &self.names
    }

    /// The number of a name of the taxonomy.
    pub(crate) fn number(&self, name: &str) -> u8 {
        self.numbers.get(name).copied().unwrap_or_default()
    }
}

/// The raw names of a world's parts.
fn used(world: &World) -> impl Iterator<Item = &str> {
    let ground = world.ground.bands.iter().map(|band| band.class.as_str());
    let movers = world.movers.iter().map(|mover| mover.category.as_str());
    let body = world.ego.body.iter().map(|body| body.class.as_str());
    let statics = world.static_classes.iter().map(String::as_str);
    ground.chain(statics).chain(movers).chain(body)
}

fn all(taxonomy: &Taxonomy) -> BTreeSet<&str> {
    taxonomy.points.keys().chain(taxonomy.boxes.keys()).map(String::as_str).collect()
}

fn number(names: &[&str], name: &str, taxonomy: &Taxonomy) -> Option<usize> {
    let meaning = |name: &str| taxonomy.points.get(name);
    let same = |other: &&str| meaning(name).is_some() && meaning(other) == meaning(name);
    names.iter().position(|other| *other == name).or_else(|| names.iter().position(same))
}
