//! What the classes are, and which raw names of a log mean which.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::{ClassId, ClassSet};

/// What a raw point label or a box category means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// It is of this class.
    Class(ClassId),
    /// It is not part of the world: noise, the ego vehicle. Its points and rays are dropped.
    Ignore,
}

/// The classes of a label set, and the meaning of every raw name.
///
/// Read from a TOML file in `configs/taxonomies/`; see labels.md sections 7 and 14.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "TaxonomyFile")]
pub struct Taxonomy {
    /// Class names in id order.
    pub names: Vec<String>,
    /// The id written where a voxel is not occupied.
    pub free: u8,
    /// The class of a point that nothing labels; `None` drops it.
    pub unknown: Option<ClassId>,
    /// Countable objects.
    pub things: ClassSet,
    /// Things that move by themselves.
    pub movers: ClassSet,
    /// Movers whose shape changes: people, animals, riders.
    pub deformable: ClassSet,
    /// The ground's classes.
    pub flat: ClassSet,
    /// `rank[class]` orders classes on equal votes: the lowest wins.
    pub rank: Vec<u8>,
    /// Raw point labels by name.
    pub points: BTreeMap<String, Meaning>,
    /// Box categories by name.
    pub boxes: BTreeMap<String, Meaning>,
}

impl Taxonomy {
    /// The class of a name.
    pub fn class_named(&self, name: &str) -> Option<ClassId> {
        let at = self.names.iter().position(|known| known == name)?;
        Some(ClassId(at as u8))
    }

    /// Of a set of classes the one that comes first in `priority`.
    pub fn first_of(&self, classes: &ClassSet) -> Option<ClassId> {
        let all = (0..self.names.len()).map(|at| ClassId(at as u8));
        all.filter(|class| classes.contains(*class)).min_by_key(|class| self.rank[class.index()])
    }

    /// The classes that some box category means.
    pub fn boxed(&self) -> ClassSet {
        self.boxes
            .values()
            .filter_map(|meaning| match meaning {
                Meaning::Class(class) => Some(*class),
                Meaning::Ignore => None,
            })
            .collect()
    }
}

/// A taxonomy as its file says it: names throughout.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TaxonomyFile {
    classes: Vec<String>,
    free: u8,
    unknown: String,
    things: Vec<String>,
    movers: Vec<String>,
    deformable: Vec<String>,
    flat: Vec<String>,
    priority: Vec<String>,
    points: BTreeMap<String, String>,
    boxes: BTreeMap<String, String>,
}

/// A taxonomy file that contradicts itself.
#[derive(Debug, thiserror::Error)]
pub enum TaxonomyError {
    /// A list or a mapping names a class that `classes` does not.
    #[error("`{place}` names the class `{name}`, which is not in `classes`")]
    UnknownClass {
        /// The key of the file.
        place: String,
        /// The name found there.
        name: String,
    },
    /// Two classes of one name.
    #[error("`classes` holds `{0}` twice")]
    Repeated(String),
    /// The free id is taken by a class.
    #[error("`free` is {free}, the id of class `{name}`")]
    FreeIsClass {
        /// The free id.
        free: u8,
        /// The class of that id.
        name: String,
    },
    /// Ties cannot be broken for every class.
    #[error("`priority` holds {found} classes, expected each of the {expected} once")]
    Priority {
        /// How many classes there are.
        expected: usize,
        /// How many different ones the list holds.
        found: usize,
    },
    /// Too many classes for a byte.
    #[error("`classes` holds {0} names, expected 1 to 255")]
    Count(usize),
}

impl TryFrom<TaxonomyFile> for Taxonomy {
    type Error = TaxonomyError;

    fn try_from(file: TaxonomyFile) -> Result<Self, TaxonomyError> {
        check_names(&file)?;
        let find = |place: &str, name: &str| class_at(&file.classes, place, name);
        let set = |place: &str, names: &[String]| -> Result<ClassSet, TaxonomyError> {
            names.iter().map(|name| find(place, name)).collect()
        };
        let meanings = |place: &str, map: &BTreeMap<String, String>| {
            map.iter()
                .map(|(raw, name)| Ok((raw.clone(), meaning(&file.classes, place, name)?)))
                .collect::<Result<BTreeMap<_, _>, TaxonomyError>>()
        };
        Ok(Self {
            unknown: match file.unknown.as_str() {
                "drop" => None,
                name => Some(find("unknown", name)?),
            },
            things: set("things", &file.things)?,
            movers: set("movers", &file.movers)?,
            deformable: set("deformable", &file.deformable)?,
            flat: set("flat", &file.flat)?,
            rank: ranks(&file)?,
            points: meanings("points", &file.points)?,
            boxes: meanings("boxes", &file.boxes)?,
            free: file.free,
            names: file.classes,
        })
    }
}

fn check_names(file: &TaxonomyFile) -> Result<(), TaxonomyError> {
    let classes = &file.classes;
    if classes.is_empty() || classes.len() > 255 {
        return Err(TaxonomyError::Count(classes.len()));
    }
    if let Some(at) = (1..classes.len()).find(|&at| classes[..at].contains(&classes[at])) {
        return Err(TaxonomyError::Repeated(classes[at].clone()));
    }
    match classes.get(usize::from(file.free)) {
        Some(name) => Err(TaxonomyError::FreeIsClass { free: file.free, name: name.clone() }),
        None => Ok(()),
    }
}

fn class_at(classes: &[String], place: &str, name: &str) -> Result<ClassId, TaxonomyError> {
    match classes.iter().position(|known| known == name) {
        Some(at) => Ok(ClassId(at as u8)),
        None => Err(TaxonomyError::UnknownClass { place: place.into(), name: name.into() }),
    }
}

fn meaning(classes: &[String], place: &str, name: &str) -> Result<Meaning, TaxonomyError> {
    match name {
        "ignore" => Ok(Meaning::Ignore),
        name => Ok(Meaning::Class(class_at(classes, place, name)?)),
    }
}

fn ranks(file: &TaxonomyFile) -> Result<Vec<u8>, TaxonomyError> {
    let expected = file.classes.len();
    let mut rank = vec![u8::MAX; expected];
    for (place, name) in file.priority.iter().enumerate() {
        rank[class_at(&file.classes, "priority", name)?.index()] = place as u8;
    }
    let found = rank.iter().filter(|&&place| place != u8::MAX).count();
    if found != expected || file.priority.len() != expected {
        return Err(TaxonomyError::Priority { expected, found });
    }
    Ok(rank)
}
