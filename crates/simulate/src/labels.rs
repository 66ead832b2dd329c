//! What the labels of a world's parts mean.

use std::collections::BTreeMap;

use occlabel_core::{ClassId, Fault, Meaning, Palette, PointLabel, Taxonomy};

use crate::check::{each, unknown};
use crate::{What, World};

/// What each part of a world is labelled, and how classes are named and painted.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    ground: Vec<PointLabel>,
    statics: Vec<PointLabel>,
    movers: Vec<PointLabel>,
    ego: PointLabel,
    /// Of each class that has one, the first raw name in byte order.
    raw_names: BTreeMap<ClassId, String>,
    colours: Vec<[u8; 3]>,
}

impl Labels {
    /// # Errors
    /// If the taxonomy does not know one of the world's raw names.
    pub(crate) fn new(world: &World, taxonomy: &Taxonomy) -> Result<Self, Fault> {
        let label = |key: &str, raw: &str| match taxonomy.points.get(raw) {
            Some(Meaning::Class(class)) => Ok(PointLabel::Class(*class)),
            Some(Meaning::Ignore) => Ok(PointLabel::Ignored),
            None => Err(unknown(key, "a point label of the taxonomy", taxonomy.points.keys(), raw)),
        };
        let palette = Palette::of(&taxonomy.names);
        Ok(Self {
            ground: each("ground.bands", &world.ground.bands, |band| label("class", &band.class))?,
            statics: each("static", &world.static_classes, |class| label("class", class))?,
            movers: world
                .movers
                .iter()
                .map(|mover| label(&format!("mover {}.category", mover.name), &mover.category))
                .collect::<Result<_, Fault>>()?,
            ego: match &world.ego.body {
                Some(body) => label("ego.body.class", &body.class)?,
                None => PointLabel::Ignored,
            },
            raw_names: raw_names(taxonomy),
            colours: (0..taxonomy.names.len()).map(|id| palette.color(id as u8)).collect(),
        })
    }

    /// The true label of a part.
    pub(crate) fn of(&self, what: What) -> PointLabel {
        match what {
            What::Ground(at) => self.ground[at],
            What::Static(at) => self.statics[at],
            What::Mover(at) => self.movers[at],
            What::Ego => self.ego,
        }
    }

    /// Another class than a point's own, by a number in [0, 1): any that a raw name means.
    pub(crate) fn mistaken_for(&self, class: ClassId, drawn: f64) -> ClassId {
        let others: Vec<_> = self.raw_names.keys().filter(|other| **other != class).collect();
        let at = (drawn * others.len() as f64) as usize;
        others.get(at).map_or(class, |other| **other)
    }

    /// A raw name that means a class, if the taxonomy has one.
    pub(crate) fn raw_name(&self, class: ClassId) -> Option<&str> {
        self.raw_names.get(&class).map(String::as_str)
    }

    pub(crate) fn colour(&self, class: ClassId) -> [u8; 3] {
        self.colours[class.index()]
    }
}

fn raw_names(taxonomy: &Taxonomy) -> BTreeMap<ClassId, String> {
    let mut names = BTreeMap::new();
    for (raw, meaning) in &taxonomy.points {
        if let Meaning::Class(class) = meaning {
            names.entry(*class).or_insert_with(|| raw.clone());
        }
    }
    names
}
