//! Semantic classes.

use serde::{Deserialize, Serialize};

/// A class by its place in the taxonomy's list of names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ClassId(pub u8);

impl ClassId {
    /// The class as an index into a list in id order.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// A set of classes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClassSet([u64; 4]);

impl ClassSet {
    /// Adds a class.
    pub fn insert(&mut self, class: ClassId) {
        self.0[class.index() / 64] |= 1 << (class.index() % 64);
    }

    /// Whether a class is in the set.
    #[inline]
    pub fn contains(&self, class: ClassId) -> bool {
        self.0[class.index() / 64] >> (class.index() % 64) & 1 == 1
    }

    /// The classes that are in both sets.
    pub fn intersection(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|word| self.0[word] & other.0[word]))
    }

    /// Whether there is no class in the set.
    pub fn is_empty(&self) -> bool {
        self.0 == [0; 4]
    }
}

impl FromIterator<ClassId> for ClassSet {
    fn from_iter<I: IntoIterator<Item = ClassId>>(classes: I) -> Self {
        let mut set = Self::default();
        classes.into_iter().for_each(|class| set.insert(class));
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_in_and_nothing_else() {
        let set: ClassSet = [0, 63, 64, 255].map(ClassId).into_iter().collect();
        let held: Vec<u8> = (0..=255).filter(|&id| set.contains(ClassId(id))).collect();
        assert_eq!(held, [0, 63, 64, 255]);
    }

    #[test]
    fn an_intersection_keeps_what_both_hold() {
        let a: ClassSet = [1, 2, 200].map(ClassId).into_iter().collect();
        let b: ClassSet = [2, 3, 200].map(ClassId).into_iter().collect();
        assert_eq!(a.intersection(&b), [2, 200].map(ClassId).into_iter().collect());
        assert!(ClassSet::default().is_empty() && !a.is_empty());
    }
}
