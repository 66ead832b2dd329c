//! Rows that name the ones before and after them.
//!
//! Nothing is looked up along these chains, which are others' work: rows are ordered by their times.
//! But a chain that does not hold says that rows were lost or mixed up.

use std::collections::HashMap;

use occlabel_core::{Fault, Loss};

use super::captures::{Capture, Captures};
use super::rows::{Sample, SampleAnnotation, SampleData};
use super::table::{Row, Table};
use super::tables::SceneRows;
use super::token::Token;
use crate::notes::Notes;

/// A row of a chain.
pub(super) trait Linked: Table {
    /// The tokens before and after it, by the names of their fields; empty at the chain's ends.
    fn links(&self) -> [(&'static str, Option<&Token>); 2];

    /// What it names under one of these names.
    fn link(&self, name: &str) -> Option<&Token> {
        let named = self.links().into_iter().find(|(known, _)| *known == name);
        named.and_then(|(_, token)| token).filter(|token| **token != Token::from(""))
    }
}

/// Ties each row type to its two fields.
macro_rules! linked {
    ($($row:ty),*) => {
        $(impl Linked for $row {
            fn links(&self) -> [(&'static str, Option<&Token>); 2] {
                [(PREV, self.prev.as_ref()), (NEXT, self.next.as_ref())]
            }
        })*
    };
}

const PREV: &str = "prev";
const NEXT: &str = "next";

linked!(Sample, SampleData, SampleAnnotation);

/// Refuses what the rows of a scene say wrongly of their neighbours. Of images and boxes only rings
/// are refused: that one of these is absent is nothing special, and noted.
pub(super) fn report_chains(rows: &SceneRows, captures: &Captures<'_>, notes: &mut Notes) {
    let samples: Vec<_> = rows.samples.iter().collect();
    let sweeps: Vec<_> = captures.lidars.iter().map(Capture::row_of).collect();
    let images: Vec<_> = captures.cameras.values().flatten().map(Capture::row_of).collect();
    let boxes: Vec<_> = rows.annotations.iter().collect();
    let (samples, sweeps) = (Chains::of(&samples), Chains::of(&sweeps));
    for fault in [samples.broken(), samples.rings(), sweeps.broken(), sweeps.rings()].concat() {
        notes.refuse(Loss::Link, fault);
    }
    let (images, boxes) = (Chains::of(&images), Chains::of(&boxes));
    for fault in [images.rings(), boxes.rings()].concat() {
        notes.refuse(Loss::Link, fault);
    }
    [images.broken(), boxes.broken()].concat().into_iter().for_each(|fault| notes.warn(fault));
}

/// The chains of a scene's rows of one table.
struct Chains<'a, T> {
    rows: &'a [&'a Row<T>],
    by_token: HashMap<&'a Token, &'a Row<T>>,
}

impl<'a, T: Linked> Chains<'a, T> {
    fn of(rows: &'a [&'a Row<T>]) -> Self {
        Self { rows, by_token: rows.iter().map(|row| (&row.token, *row)).collect() }
    }

    /// Links that name no row of the scene, or one that does not name this row in turn.
    fn broken(&self) -> Vec<Fault> {
        let ways = [(PREV, NEXT), (NEXT, PREV)];
        let faults = self.rows.iter().flat_map(|row| {
            ways.into_iter().filter_map(|(name, back)| self.broken_link(row, name, back))
        });
        faults.collect()
    }

    fn broken_link(&self, row: &Row<T>, name: &str, back: &str) -> Option<Fault> {
        let token = row.link(name)?;
        let Some(named) = self.by_token.get(token) else {
            let expected = format!("a row of its scene that `{name}` names: `{token}`");
            return Some(row.fault("dangling-token", expected, "none"));
        };
        if named.link(back) == Some(&row.token) {
            return None;
        }
        let expected = format!("a row whose `{back}` names this one, as its `{name}`");
        let found = named.link(back).map_or("nothing".into(), |other| format!("`{other}`"));
        Some(row.fault("chain-broken", expected, format!("`{token}`, whose `{back}` is {found}")))
    }

    /// Chains that lead back into themselves, one fault each. Every row is passed once.
    fn rings(&self) -> Vec<Fault> {
        let (mut walk_of, mut rings) = (HashMap::new(), Vec::new());
        for (walk, start) in self.rows.iter().enumerate() {
            let mut at = Some(*start);
            while let Some(row) = at {
                if let Some(earlier) = walk_of.insert(&row.token, walk) {
                    let ring = || row.fault("chain-ring", "an end of `next`", "a way back to here");
                    rings.extend((earlier == walk).then(ring));
                    break;
                }
                at = row.link(NEXT).and_then(|next| self.by_token.get(next).copied());
            }
        }
        rings
    }
}
