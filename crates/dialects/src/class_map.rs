//! From the classes of one label set to those of another.

use occlabel_core::Fault;

use crate::concepts::plain;
use crate::remark::remarks;
use crate::{Class, ClassTable, Concepts, IGNORED, Remark};

/// What each class of a label set becomes in another.
///
/// A class becomes the other set's class of the same concept (of several, the one of the same name);
/// else the one of the nearest wider concept; else what usually stands for it; else the other set's
/// class for the rest; else it is no label. Free stays free, and no label no label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassMap {
    /// The index of the other set for each index of this one.
    table: Vec<u8>,
    /// Why, for each class.
    reasons: Vec<Reason>,
    /// What is lost or changed.
    remarks: Vec<Remark>,
    is_lossless: bool,
}

/// Why a class becomes what it becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It means the same.
    Same,
    /// It means something wider.
    Wider,
    /// It usually stands for it.
    Usual,
    /// It is the class for the rest.
    Rest,
    /// There is nothing to become.
    Nothing,
    /// One was told so.
    Told,
}

impl ClassMap {
    /// The map between two sets; `told` are pairs of a class of the one and a class of the other, or
    /// `free`, or `ignored`, that go before the rule.
    ///
    /// # Errors
    /// If a pair names what is no class.
    pub fn between(
        from: &ClassTable,
        to: &ClassTable,
        told: &[(String, String)],
    ) -> Result<Self, Fault> {
        let mut pairs: Vec<_> = from.list.iter().map(|class| like(class, to)).collect();
        for (class, becomes) in told {
            pairs[index_of(from, class)?] = (target(to, becomes)?, Reason::Told);
        }
        let back = table(to.list.iter().map(|class| like(class, from).0), from);
        let can_say = |index| index != IGNORED || to.no_label.is_some();
        let survives = |(class, pair): (usize, &(u8, Reason))| {
            can_say(pair.0) && usize::from(back[usize::from(pair.0)]) == class
        };
        let survive: Vec<bool> = pairs.iter().enumerate().map(survives).collect();
        Ok(Self {
            remarks: remarks(from, to, &pairs, &survive),
            table: table(pairs.iter().map(|pair| pair.0), to),
            reasons: pairs.iter().map(|pair| pair.1).collect(),
            is_lossless: !survive.contains(&false),
        })
    }

    /// The index in the other set for each index of this one: free to free,
    /// [`IGNORED`] to itself, or to noise where files have no id for it.
    pub fn table(&self) -> &[u8; 256] {
        self.table.first_chunk().expect("a table of all bytes")
    }

    /// Why each class becomes what it becomes.
    pub fn reasons(&self) -> &[Reason] {
        &self.reasons
    }

    /// What is lost or changed, line by line; empty if every class finds its like.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// Whether every class comes back as itself from the other set.
    pub fn is_lossless(&self) -> bool {
        self.is_lossless
    }

    /// Turns the classes of a grid into those of the other set.
    pub fn apply(&self, semantics: &mut [u8]) {
        let table = self.table();
        semantics.iter_mut().for_each(|class| *class = table[usize::from(*class)]);
    }
}

/// What a class becomes, and why.
fn like(class: &Class, to: &ClassTable) -> (u8, Reason) {
    let is_same = |other: &Class| {
        plain(&other.name) == plain(&class.name) && other.concept() == class.concept()
    };
    if let Some(same) = to.list.iter().position(is_same) {
        return (same as u8, Reason::Same);
    }
    let concepts = Concepts::shipped();
    let of = |wanted: &str| position(to, wanted);
    let Some(concept) = class.concept() else { return rest(of(concepts.catch_all()), to) };
    let same = of(concept).map(|at| (at, Reason::Same));
    let wider = || concepts.above(concept).find_map(of).map(|at| (at, Reason::Wider));
    let usual = || concepts.usual(concept).iter().find_map(|name| of(name));
    let found = same.or_else(wider).or_else(|| usual().map(|at| (at, Reason::Usual)));
    let catch_all = || (!concepts.is_nothing(concept)).then(|| of(concepts.catch_all())).flatten();
    found.unwrap_or_else(|| rest(catch_all(), to))
}

fn rest(catch_all: Option<u8>, to: &ClassTable) -> (u8, Reason) {
    catch_all.map_or((no_label(to), Reason::Nothing), |at| (at, Reason::Rest))
}

/// No label, in files that have no id for it: the class of noise, which scores leave out.
fn no_label(to: &ClassTable) -> u8 {
    let noise = position(to, NOISE).filter(|_| to.no_label.is_none());
    noise.unwrap_or(IGNORED)
}

/// The concept of a class that stands for no label.
const NOISE: &str = "noise";

/// The class of a concept.
fn position(table: &ClassTable, concept: &str) -> Option<u8> {
    let at = table.list.iter().position(|class| class.concept() == Some(concept))?;
    Some(at as u8)
}

/// What each index becomes: the classes as given, then free, then no label for all others.
fn table(classes: impl Iterator<Item = u8>, to: &ClassTable) -> Vec<u8> {
    let mut table: Vec<u8> = classes.chain([to.free_index()]).collect();
    table.resize(256, no_label(to));
    table
}

fn index_of(table: &ClassTable, name: &str) -> Result<usize, Fault> {
    let at = table.list.iter().position(|class| plain(&class.name) == plain(name));
    at.ok_or_else(|| unknown(table, name, ""))
}

fn target(table: &ClassTable, name: &str) -> Result<u8, Fault> {
    match index_of(table, name) {
        Ok(at) => Ok(at as u8),
        Err(_) if name == "free" => Ok(table.free_index()),
        Err(_) if name == "ignored" => Ok(no_label(table)),
        Err(_) => Err(unknown(table, name, ", free, ignored")),
    }
}

fn unknown(table: &ClassTable, name: &str, more: &str) -> Fault {
    let expected = format!("one of {}{more}", table.names().join(", "));
    Fault::new("class-map", "--map", expected, format!("`{name}`"))
}
