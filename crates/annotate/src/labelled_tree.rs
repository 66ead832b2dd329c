//! Labelled points in boxes of boxes, asked by the box.
//!
//! Our own because the order of neighbours is part of a label's meaning: by (distance, class), and no
//! library promises which of several points at one distance it returns.

use nalgebra::Point3;
use occlabel_core::ClassId;

use crate::bounds::Bounds;
use crate::groups::{ITEMS_A_TASK, Item, halve};

/// Points that are not divided further.
const LEAF: usize = 16;

/// A labelled point.
pub(crate) type Labelled = (Point3<f64>, ClassId);

/// A tree of boxes around points in order of place.
pub(crate) struct LabelledTree {
    points: Vec<Labelled>,
    nodes: Vec<Node>,
    k: usize,
}

/// A box around all that is below it.
struct Node {
    bounds: Bounds,
    below: Below,
}

enum Below {
    /// So many points from here on.
    Points { start: u32, count: u32 },
    /// Two nodes: the one before this in the list, and the one so many places before.
    Nodes { back: u32 },
}

/// The points that can be neighbours of a place in some box.
#[derive(Default)]
pub(crate) struct Candidates {
    /// The points.
    pub(crate) points: Vec<Labelled>,
    /// The greatest squared distances that those within reach of every place can have: at most `k`,
    /// the smallest, in order.
    pub(crate) most_squared: Vec<f64>,
    /// Points met, with their least squared distance: not too far by what was known then.
    met: Vec<(f64, u32)>,
}

impl LabelledTree {
    /// A tree over the points, in any order, for searches of `k` neighbours.
    ///
    /// # Panics
    /// With 2^32 points or more.
    pub(crate) fn new(mut points: Vec<Labelled>, k: usize) -> Self {
        assert!(u32::try_from(points.len()).is_ok(), "fewer than 2^32 labelled points");
        let center = points.first().map_or(Point3::origin(), |(p, _)| *p);
        let mut items: Vec<Item> =
            (0..).zip(&points).map(|(number, (p, _))| Item::new(p, &center, number)).collect();
        let mut nodes = Vec::new();
        Growth { points: &points, k }.grow(&mut items, 0, &mut nodes);
        let mut order: Vec<u32> = items.iter().map(Item::number).collect();
        drop(items);
        reorder(&mut points, &mut order);
        Self { points, nodes, k }
    }

    /// Finds all points that can be among the first `k` within reach of any place in `bounds`.
    pub(crate) fn search(&self, bounds: &Bounds, reach_squared: f64, to: &mut Candidates) {
        to.points.clear();
        to.most_squared.clear();
        to.met.clear();
        let mut search = Search { tree: self, bounds, limit: reach_squared, to };
        search.visit(self.nodes.len() - 1);
        let limit = search.limit;
        let near = to.met.iter().filter(|(least, _)| *least <= limit);
        to.points.extend(near.map(|(_, i)| self.points[*i as usize]));
    }
}

/// Puts in each place the point that `order` names for it; `order` becomes 0, 1, 2, and so on.
fn reorder(points: &mut [Labelled], order: &mut [u32]) {
    for start in 0..points.len() {
        let mut to = start;
        while order[to] as usize != start {
            let from = order[to] as usize;
            points.swap(to, from);
            order[to] = to as u32;
            to = from;
        }
        order[to] = to as u32;
    }
}

struct Growth<'a> {
    points: &'a [Labelled],
    k: usize,
}

impl Growth<'_> {
    /// Appends the tree of items that will stand from `start` on; its topmost node comes last.
    fn grow(&self, items: &mut [Item], start: u32, nodes: &mut Vec<Node>) {
        let split = if items.len() <= LEAF { None } else { halve(items, &|i| self.position(i)) };
        if let Some(split) = split {
            return self.grow_both(items, split, start, nodes);
        }
        let count = self.move_voters_first(items) as u32;
        let positions = items.iter().map(|item| &self.points[item.number() as usize].0);
        nodes.push(Node { bounds: Bounds::of(positions), below: Below::Points { start, count } });
    }

    fn grow_both(&self, items: &mut [Item], split: usize, start: u32, nodes: &mut Vec<Node>) {
        let parallel = split.min(items.len() - split) >= ITEMS_A_TASK;
        let (low, high) = items.split_at_mut(split);
        let middle = start + split as u32;
        let mut of_high = Vec::new();
        if parallel {
            rayon::join(|| self.grow(low, start, nodes), || self.grow(high, middle, &mut of_high));
        } else {
            self.grow(low, start, nodes);
        }
        let first = nodes.len() - 1;
        nodes.append(&mut of_high);
        if !parallel {
            self.grow(high, middle, nodes);
        }
        let here = nodes.len();
        let bounds = nodes[first].bounds.with(&nodes[here - 1].bounds);
        nodes.push(Node { bounds, below: Below::Nodes { back: (here - first) as u32 } });
    }

    fn position(&self, number: u32) -> Point3<f64> {
        self.points[number as usize].0
    }

    /// Of repeats of one point only the first `k` of a class can vote: moves those to the front and
    /// tells how many items are there.
    fn move_voters_first(&self, items: &mut [Item]) -> usize {
        if items.len() <= LEAF {
            return items.len();
        }
        let point = |item: &Item| self.points[item.number() as usize];
        let key = |item: &Item| {
            let (p, class) = point(item);
            ([p.x, p.y, p.z].map(f64::to_bits), class)
        };
        items.sort_unstable_by_key(key);
        let (mut kept, mut repeats) = (0, 0);
        for i in 0..items.len() {
            repeats =
                if i > 0 && key(&items[i]) == key(&items[kept - 1]) { repeats + 1 } else { 0 };
            if repeats < self.k {
                items.swap(kept, i);
                kept += 1;
            }
        }
        kept
    }
}

struct Search<'a> {
    tree: &'a LabelledTree,
    bounds: &'a Bounds,
    /// What is farther, squared, is no neighbour of any place in the box.
    limit: f64,
    to: &'a mut Candidates,
}

impl Search<'_> {
    /// Looks below a node, first where it is nearer.
    fn visit(&mut self, at: usize) {
        let nodes = &self.tree.nodes;
        match nodes[at].below {
            Below::Points { start, count } => (start..start + count).for_each(|i| self.meet(i)),
            Below::Nodes { back } => {
                let least = |child: usize| nodes[child].bounds.least_squared(self.bounds);
                let (a, b) = (at - back as usize, at - 1);
                let (a, b) = ((least(a), a), (least(b), b));
                let (near, far) = if b.0 < a.0 { (b, a) } else { (a, b) };
                for (least, child) in [near, far] {
                    if least <= self.limit {
                        self.visit(child);
                    }
                }
            }
        }
    }

    #[inline]
    fn meet(&mut self, i: u32) {
        let p = &self.tree.points[i as usize].0;
        let least = self.bounds.least_squared_to(p);
        if least > self.limit {
            return;
        }
        self.to.met.push((least, i));
        let most = self.bounds.most_squared_to(p);
        if most <= self.limit {
            self.tighten(most);
        }
    }

    /// One more point is at most so far from all of the box.
    fn tighten(&mut self, most: f64) {
        let (all, k) = (&mut self.to.most_squared, self.tree.k);
        let place = all.partition_point(|other| *other <= most);
        all.truncate(k - 1);
        all.insert(place.min(all.len()), most);
        if all.len() == k {
            self.limit = all[k - 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::distance_squared;
    use proptest::prelude::*;
    use std::cell::Cell;

    fn point() -> impl Strategy<Value = Point3<f64>> {
        let coordinate = prop_oneof![(0_i32..5).prop_map(f64::from), -9.0..9.0_f64, Just(0.5)];
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Point3::from)
    }

    /// The first neighbours, by sorting.
    fn nearest(
        points: &[Labelled],
        p: &Point3<f64>,
        k: usize,
        reach_squared: f64,
    ) -> Vec<(f64, ClassId)> {
        let mut all: Vec<_> =
            points.iter().map(|(q, class)| (distance_squared(q, p), *class)).collect();
        all.retain(|one| one.0 <= reach_squared);
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all.truncate(k);
        all
    }

    #[test]
    fn candidates_hold_the_neighbours_of_every_place_in_the_box() {
        let (asked, left_out) = (Cell::new(0), Cell::new(0));
        let labelled = prop::collection::vec((point(), (0_u8..4).prop_map(ClassId)), 0..300);
        let places = prop::collection::vec(point(), 1..4);
        let reach = prop_oneof![Just(f64::INFINITY), 0.0..30.0_f64];
        proptest!(ProptestConfig::with_cases(300), |(points in labelled, places in places, k in 1_usize..8, reach in reach)| {
            let mut found = Candidates::default();
            LabelledTree::new(points.clone(), k).search(&Bounds::of(places.iter()), reach, &mut found);
            for p in &places {
                prop_assert_eq!(nearest(&found.points, p, k, reach), nearest(&points, p, k, reach));
            }
            asked.set(asked.get() + places.len());
            left_out.set(left_out.get() + points.len() - found.points.len());
        });
        assert!(asked.get() > 300, "{} places", asked.get());
        assert!(left_out.get() > 5_000, "{} points left out", left_out.get());
    }

    #[test]
    fn of_repeats_only_those_that_can_vote_are_kept() {
        let points = (0..90).map(|i| (Point3::new(1.0, 2.0, 3.0), ClassId(i % 2))).collect();
        let mut found = Candidates::default();
        let here = Bounds::of([Point3::origin()].iter());
        LabelledTree::new(points, 3).search(&here, f64::INFINITY, &mut found);
        let classes: Vec<u8> = found.points.iter().map(|(_, class)| class.0).collect();
        assert_eq!(classes, [0, 0, 0, 1, 1, 1]);
    }
}
