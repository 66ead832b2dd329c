//! The classes of a group of points, found together.
//!
//! All in a group have nearly the same neighbours, so these are searched for once.

use nalgebra::Point3;
use occlabel_core::ClassId;

use crate::bounds::Bounds;
use crate::groups::{Item, halve};
use crate::labelled_tree::{Candidates, LabelledTree};
use crate::poll::{Outcome, PLACES, Poll};
use crate::unlabelled::Round;
use crate::vote::vote;

/// Points that are asked about together.
pub(crate) const GROUP: usize = 64;

/// More candidates than these are worth dividing the group for.
const MANY_CANDIDATES: usize = 256;

/// What the points of a round are asked.
pub(crate) struct Ballot<'a> {
    /// Who votes.
    pub(crate) tree: &'a LabelledTree,
    /// How many of them.
    pub(crate) k: usize,
    /// How far they may be, squared, square metres.
    pub(crate) reach_squared: f64,
    /// Those whose classes are sought.
    pub(crate) round: &'a Round<'a>,
}

impl Ballot<'_> {
    /// Finds the class of each point of a group.
    pub(crate) fn hold(&self, group: &mut [Item]) {
        let positions: Vec<_> =
            group.iter().map(|item| self.round.position(item.number())).collect();
        let bounds = Bounds::of(positions.iter());
        let mut candidates = Candidates::default();
        self.tree.search(&bounds, self.reach_squared, &mut candidates);
        if let Some(verdict) = unanimous(&candidates) {
            group.iter().for_each(|item| self.round.set(item.number(), verdict));
        } else if candidates.points.len() > MANY_CANDIDATES && group.len() > PLACES {
            self.divide(group);
        } else {
            self.poll(group, &positions, &bounds, &candidates);
        }
    }

    fn divide(&self, group: &mut [Item]) {
        let split = halve(group, &|number| self.round.position(number));
        let (low, high) = group.split_at_mut(split.unwrap_or(group.len() / 2));
        self.hold(low);
        self.hold(high);
    }

    fn poll(
        &self,
        group: &[Item],
        positions: &[Point3<f64>],
        bounds: &Bounds,
        candidates: &Candidates,
    ) {
        let points = &candidates.points;
        let poll = Poll::new(points, bounds, self.k, self.reach_squared);
        for (items, positions) in group.chunks(PLACES).zip(positions.chunks(PLACES)) {
            let outcomes = match &poll {
                Some(poll) => poll.outcomes(positions),
                None => [Outcome::Unsure; PLACES],
            };
            for ((item, p), outcome) in items.iter().zip(positions).zip(outcomes) {
                let class = match outcome {
                    Outcome::Won(class) => Some(class),
                    Outcome::Nobody => None,
                    Outcome::Unsure => vote(points, p, self.k, self.reach_squared),
                };
                self.round.set(item.number(), class);
            }
        }
    }
}

/// What the vote gives everywhere in the box that the candidates were found for, where that is plain:
/// none is near, or all are of one class and one of them is in reach of all of the box.
fn unanimous(candidates: &Candidates) -> Option<Option<ClassId>> {
    let Some((_, class)) = candidates.points.first() else {
        return Some(None);
    };
    let one_class = candidates.points.iter().all(|(_, other)| other == class);
    (one_class && !candidates.most_squared.is_empty()).then_some(Some(*class))
}
