//! The classes of a label set, in the order of their indices.

use serde::{Deserialize, Serialize};

use crate::Concepts;

/// The classes of a label set. A class's index is its place in `list`; free is the one after the last.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassTable {
    /// The id that files write where nothing stands.
    pub free: u16,
    /// The id that files write where there is no label, if the dialect has one.
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

impl ClassTable {
    /// How many classes there are, which is also the index of free.
    pub fn free_index(&self) -> u8 {
        self.list.len() as u8
    }

    /// The names in the order of the indices.
    pub fn names(&self) -> Vec<String> {
        self.list.iter().map(|class| class.name.clone()).collect()
    }

    /// The index of each id of a file that has ids of a byte; `None` where no class has it.
    pub fn index_of(&self, id: u16) -> Option<u8> {
        if id == self.free {
            return Some(self.free_index());
        }
        let at = self.list.iter().position(|class| class.id == id)?;
        Some(at as u8)
    }
}
