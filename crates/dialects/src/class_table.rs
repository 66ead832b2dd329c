//! The classes of a label set, in the order of their indices.

use occlabel_core::Fault;
use serde::{Deserialize, Serialize};

use crate::{Concepts, IGNORED};

/// The classes of a label set. A class's index is its place in `list`; free is the one after the last.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassTable {
    /// The id that files write where nothing stands.
    pub free: u16,
    /// The id that files write where they have no label.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_label: Option<u16>,
    /// The classes.
    pub list: Vec<Class>,
}

/// A class of a label set.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Class {
    /// Its id in files.
    pub id: u16,
    /// Its name.
    pub name: String,
    /// Whether scores leave it out, as noise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_ignored: bool,
    /// What it means, where that is not what its name says: a concept of
    /// `configs/dialects/concepts.toml`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub concept: Option<String>,
}

impl Class {
    /// The concept that it means, of the shipped tree: what it says itself, or else its name's.
    pub fn concept(&self) -> Option<&'static str> {
        Concepts::shipped().named(self.concept.as_ref().unwrap_or(&self.name))
    }
}

/// Most classes that a table may hold: 254 is [`UNKNOWN`], 255 [`IGNORED`].
const MAX_CLASSES: usize = 253;

/// In place of an index: the id is in no table.
pub(crate) const UNKNOWN: u8 = 254;

impl ClassTable {
    /// How many classes there are, which is also the index of free.
    pub fn free_index(&self) -> u8 {
        self.list.len() as u8
    }

    /// The names in the order of the indices.
    pub fn names(&self) -> Vec<String> {
        self.list.iter().map(|class| class.name.clone()).collect()
    }

    /// The index of an id; `None` where no class has it.
    pub fn index_of(&self, id: u16) -> Option<u8> {
        if id == self.free {
            return Some(self.free_index());
        }
        if self.no_label == Some(id) {
            return Some(IGNORED);
        }
        let at = self.list.iter().position(|class| class.id == id)?;
        Some(at as u8)
    }

    /// The id of an index; `None` for [`IGNORED`] where files have no id for it.
    ///
    /// # Panics
    /// If the index is that of no class, nor of free, nor [`IGNORED`].
    pub fn id_of(&self, index: u8) -> Option<u16> {
        match index {
            IGNORED => self.no_label,
            index if index == self.free_index() => Some(self.free),
            index => Some(self.list[usize::from(index)].id),
        }
    }

    /// Whether a file that lists what is not free lists a voxel of this index.
    pub(crate) fn is_written(&self, index: u8) -> bool {
        index != self.free_index() && self.id_of(index).is_some()
    }

    /// The index of each id, [`UNKNOWN`] where there is none.
    pub(crate) fn indices(&self) -> Vec<u8> {
        let mut indices = vec![UNKNOWN; 1 << 16];
        for (index, class) in self.list.iter().enumerate() {
            indices[usize::from(class.id)] = index as u8;
        }
        indices[usize::from(self.free)] = self.free_index();
        if let Some(id) = self.no_label {
            indices[usize::from(id)] = IGNORED;
        }
        indices
    }

    /// Refuses a table in which an id means two things, or which has too many classes.
    pub(crate) fn check(&self, place: &str) -> Result<(), Fault> {
        let fault = |expected: &str, found: String| {
            Err(Fault::new("class-table", place, expected, found).record("classes"))
        };
        if self.list.is_empty() || self.list.len() > MAX_CLASSES {
            return fault("1 to 253 classes", self.list.len().to_string());
        }
        let mut ids: Vec<u16> = self.list.iter().map(|class| class.id).collect();
        ids.extend(self.no_label.into_iter().chain([self.free]));
        ids.sort_unstable();
        match ids.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => fault("every id once", format!("{} twice", pair[0])),
            None => Ok(()),
        }
    }
}
