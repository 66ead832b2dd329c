//! Exact nearest neighbours in a k-d tree.
//!
//! Bentley, "Multidimensional binary search trees used for associative searching", 1975. Our own
//! because the order of neighbours is part of a label's meaning: by (distance, class), and no
//! library promises which of several points at one distance it returns.

use nalgebra::Point3;
use occlabel_core::ClassId;

/// Points below which a node is not split further.
const LEAF: usize = 16;

/// A labelled point.
pub(crate) type Labelled = (Point3<f64>, ClassId);

/// A balanced tree: the median of each range stands in its middle, split along its widest axis.
pub(crate) struct KdTree {
    points: Vec<Labelled>,
    /// The axis that each inner node is split along, by the place of its median.
    axes: Vec<u8>,
}

/// A neighbour: squared distance, then class, in the order in which neighbours are taken.
pub(crate) type Neighbour = (f64, ClassId);

impl KdTree {
    /// A tree over the points. Any number, in any order, repeats and all.
    pub(crate) fn new(mut points: Vec<Labelled>) -> Self {
        let mut axes = vec![0; points.len()];
        split(&mut points, &mut axes);
        Self { points, axes }
    }

    /// The first `k` neighbours within `reach_squared`, ordered by (distance, class), into `found`.
    pub(crate) fn nearest(
        &self,
        p: &Point3<f64>,
        k: usize,
        reach_squared: f64,
        found: &mut Vec<Neighbour>,
    ) {
        found.clear();
        let mut search = Search { tree: self, p, k, reach_squared, found };
        search.visit(0, self.points.len());
    }
}

fn split(points: &mut [Labelled], axes: &mut [u8]) {
    if points.len() <= LEAF {
        return;
    }
    let axis = widest_axis(points);
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
    axes[middle] = axis as u8;
    let (low, high) = points.split_at_mut(middle);
    let (low_axes, high_axes) = axes.split_at_mut(middle);
    let (high, high_axes) = (&mut high[1..], &mut high_axes[1..]);
    if low.len() < 1 << 14 {
        split(low, low_axes);
        split(high, high_axes);
    } else {
        rayon::join(|| split(low, low_axes), || split(high, high_axes));
    }
}

fn widest_axis(points: &[Labelled]) -> usize {
    let (mut low, mut high) = (points[0].0, points[0].0);
    for (p, _) in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    (high - low).imax()
}

struct Search<'a> {
    tree: &'a KdTree,
    p: &'a Point3<f64>,
    k: usize,
    reach_squared: f64,
    found: &'a mut Vec<Neighbour>,
}

impl Search<'_> {
    fn visit(&mut self, start: usize, end: usize) {
        if end - start <= LEAF {
            return (start..end).for_each(|at| self.consider(at));
        }
        let middle = start + (end - start) / 2;
        let axis = usize::from(self.tree.axes[middle]);
        let beyond = self.p[axis] - self.tree.points[middle].0[axis];
        let (near, far) = if beyond < 0.0 {
            ((start, middle), (middle + 1, end))
        } else {
            ((middle + 1, end), (start, middle))
        };
        self.visit(near.0, near.1);
        if beyond * beyond <= self.limit() {
            self.consider(middle);
            self.visit(far.0, far.1);
        }
    }

    /// A point farther than this, squared, is no neighbour any more; one at this distance may be.
    fn limit(&self) -> f64 {
        if self.found.len() < self.k { self.reach_squared } else { self.found[self.k - 1].0 }
    }

    #[inline]
    fn consider(&mut self, at: usize) {
        let (position, class) = &self.tree.points[at];
        let neighbour = ((position - self.p).norm_squared(), *class);
        if neighbour.0 > self.limit() {
            return;
        }
        let place = self.found.partition_point(|other| *other <= neighbour);
        if place < self.k {
            self.found.truncate(self.k - 1);
            self.found.insert(place, neighbour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell;

    /// The oracle: sort everything.
    fn by_sorting(
        points: &[Labelled],
        p: &Point3<f64>,
        k: usize,
        reach_squared: f64,
    ) -> Vec<Neighbour> {
        let mut all: Vec<Neighbour> =
            points.iter().map(|(q, class)| ((q - p).norm_squared(), *class)).collect();
        all.retain(|neighbour| neighbour.0 <= reach_squared);
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all.truncate(k);
        all
    }

    /// Clouds of few distinct coordinates (planes, lines, repeats, ties) and of many.
    fn cloud() -> impl Strategy<Value = Vec<Labelled>> {
        let coarse = (0_i32..5).prop_map(f64::from);
        let fine = -10.0..10.0_f64;
        let flat = Just(0.0);
        let coordinate = prop_oneof![coarse, fine, flat];
        let point = [coordinate.clone(), coordinate.clone(), coordinate].prop_map(Point3::from);
        prop::collection::vec((point, (0_u8..4).prop_map(ClassId)), 0..400)
    }

    #[test]
    fn section_5_neighbours_are_those_that_sorting_finds() {
        let (queries, ties) = (Cell::new(0), Cell::new(0));
        proptest!(ProptestConfig::with_cases(300), |(points in cloud(), k in 1_usize..8, reach in prop_oneof![Just(f64::INFINITY), 0.0..9.0_f64])| {
            let tree = KdTree::new(points.clone());
            let mut found = Vec::new();
            for (p, _) in points.iter().take(20) {
                for query in [*p, p + nalgebra::Vector3::new(0.5, 0.0, 0.5)] {
                    let expected = by_sorting(&points, &query, k, reach);
                    tree.nearest(&query, k, reach, &mut found);
                    prop_assert_eq!(&found, &expected);
                    queries.set(queries.get() + 1);
                    ties.set(ties.get() + usize::from(expected.windows(2).any(|w| w[0].0 == w[1].0)));
                }
            }
        });
        assert!(queries.get() > 5_000, "{} queries", queries.get());
        assert!(ties.get() > 1_000, "{} queries with ties", ties.get());
    }

    #[test]
    fn a_far_outlier_and_a_heap_of_repeats_do_no_harm() {
        let mut points = vec![(Point3::new(1.0, 1.0, 1.0), ClassId(1)); 5_000];
        points.push((Point3::new(1e9, 0.0, 0.0), ClassId(2)));
        let tree = KdTree::new(points);
        let mut found = Vec::new();
        tree.nearest(&Point3::origin(), 5, f64::INFINITY, &mut found);
        assert_eq!(found, [(3.0, ClassId(1)); 5]);
        tree.nearest(&Point3::new(1e9, 1.0, 0.0), 1, 1.0, &mut found);
        assert_eq!(found, [(1.0, ClassId(2))]);
    }
}
