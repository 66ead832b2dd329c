//! What class names mean: a small tree of concepts, from narrow to wide.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

/// The shipped tree; a test checks it.
static SHIPPED: LazyLock<Concepts> = LazyLock::new(|| {
    let text = include_str!("../../../configs/dialects/concepts.toml");
    toml::from_str(text).expect("the shipped tree of concepts is sound")
});

/// A tree of concepts, and the names that mean them.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "ConceptsFile")]
pub struct Concepts {
    concepts: BTreeMap<String, Concept>,
    /// The concept of each name, both as [`plain`] text.
    by_name: BTreeMap<String, String>,
    catch_all: String,
}

/// A concept as the file says it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Concept {
    /// The nearest wider one.
    under: Option<String>,
    /// Other names of the same.
    #[serde(default)]
    also: Vec<String>,
    /// What stands for it, or for what is under it, where neither has a class.
    usual: Option<Vec<String>>,
    /// It is no object: no class for the rest takes it.
    #[serde(default)]
    nothing: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConceptsFile {
    catch_all: String,
    concepts: BTreeMap<String, Concept>,
}

impl Concepts {
    /// The tree of `configs/dialects/concepts.toml`.
    pub fn shipped() -> &'static Self {
        &SHIPPED
    }

    /// The concept that a class name means; case, blanks, `-` and `_` make no difference.
    pub fn named(&self, name: &str) -> Option<&str> {
        self.by_name.get(&plain(name)).map(String::as_str)
    }

    /// Wider and wider concepts, from the nearest.
    pub fn above<'a>(&'a self, concept: &str) -> impl Iterator<Item = &'a str> + use<'a> {
        let under = |concept: &str| self.concepts.get(concept)?.under.as_deref();
        std::iter::successors(under(concept), move |wider| under(wider))
    }

    /// What usually stands for a concept: its own list, or else the nearest above that has one.
    pub fn usual<'a>(&'a self, concept: &'a str) -> &'a [String] {
        let list = |concept| self.concepts.get(concept)?.usual.as_deref();
        std::iter::once(concept).chain(self.above(concept)).find_map(list).unwrap_or_default()
    }

    /// The concept of a class for all the rest.
    pub fn catch_all(&self) -> &str {
        &self.catch_all
    }

    /// Whether a concept is no object, such as noise.
    pub fn is_nothing(&self, concept: &str) -> bool {
        self.concepts.get(concept).is_some_and(|concept| concept.nothing)
    }
}

impl TryFrom<ConceptsFile> for Concepts {
    type Error = String;

    fn try_from(ConceptsFile { catch_all, concepts }: ConceptsFile) -> Result<Self, String> {
        let named = concepts.values().flat_map(|c| c.under.iter().chain(c.usual.iter().flatten()));
        if let Some(absent) = named.chain([&catch_all]).find(|name| !concepts.contains_key(*name)) {
            return Err(format!("`{absent}` is no concept"));
        }
        let by_name = names(&concepts)?;
        let tree = Self { concepts, by_name, catch_all };
        let is_round = |concept: &&String| tree.above(concept).take(99).count() == 99;
        match tree.concepts.keys().find(is_round) {
            Some(concept) => Err(format!("`{concept}` stands above itself")),
            None => Ok(tree),
        }
    }
}

/// The concept of each name.
fn names(concepts: &BTreeMap<String, Concept>) -> Result<BTreeMap<String, String>, String> {
    let mut by_name = BTreeMap::new();
    for (concept, entry) in concepts {
        for name in std::iter::once(concept).chain(&entry.also) {
            if let Some(other) = by_name.insert(plain(name), concept.clone()) {
                return Err(format!("`{name}` means both `{other}` and `{concept}`"));
            }
        }
    }
    Ok(by_name)
}

/// A name without what makes no difference.
pub(crate) fn plain(name: &str) -> String {
    name.to_lowercase().replace([' ', '-'], "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn above(concept: &str) -> Vec<&'static str> {
        Concepts::shipped().above(concept).collect()
    }

    #[test]
    fn wider_concepts_come_from_the_nearest() {
        assert_eq!(above("moving_bus"), ["bus", "other_vehicle", "large_vehicle", "vehicle"]);
        assert!(above("vehicle").is_empty());
    }

    #[test]
    fn names_are_told_apart_by_their_letters_alone() {
        let concepts = Concepts::shipped();
        for name in ["traffic sign", "traffic-sign", "TRAFFIC_SIGN", "Sign"] {
            assert_eq!(concepts.named(name), Some("sign"), "{name}");
        }
        assert_eq!(concepts.named("unheard of"), None);
    }

    #[test]
    fn a_list_of_its_own_hides_those_above() {
        let concepts = Concepts::shipped();
        assert_eq!(concepts.usual("bus"), ["truck", "car"]);
        assert_eq!(concepts.usual("car"), ["car"]);
        assert_eq!(concepts.usual("wall"), ["building"]);
        assert!(concepts.usual("pole").is_empty());
    }

    #[test]
    fn a_tree_that_contradicts_itself_is_refused() {
        let refused = |text: &str| {
            let text = format!("catch_all = \"a\"\n[concepts]\n{text}");
            toml::from_str::<Concepts>(&text).unwrap_err().to_string()
        };
        assert!(refused("a = {}\nb = { under = \"c\" }").contains("`c` is no concept"));
        assert!(refused("a = { usual = [\"d\"] }").contains("`d` is no concept"));
        assert!(refused("b = {}").contains("`a` is no concept"));
        assert!(refused("a = {}\nb = { also = [\"A\"] }").contains("means both"));
        assert!(refused("a = { under = \"b\" }\nb = { under = \"a\" }").contains("above itself"));
    }
}
