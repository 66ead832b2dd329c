//! The vote of the nearest, by its definition.

use nalgebra::Point3;
use occlabel_core::ClassId;

use crate::bounds::distance_squared;
use crate::labelled_tree::Labelled;

/// A neighbour: squared distance, then class, in the order in which neighbours are taken.
type Neighbour = (f64, ClassId);

/// The class that most of the first `k` points within reach of `p` have; `None` without any.
pub(crate) fn vote(
    points: &[Labelled],
    p: &Point3<f64>,
    k: usize,
    reach_squared: f64,
) -> Option<ClassId> {
    let mut nearest: Vec<Neighbour> = Vec::with_capacity(k.min(points.len()));
    for (position, class) in points {
        let neighbour = (distance_squared(position, p), *class);
        let last = if nearest.len() < k { None } else { nearest.last() };
        if neighbour.0 <= reach_squared && last.is_none_or(|last| neighbour < *last) {
            nearest.truncate(k - 1);
            nearest.insert(nearest.partition_point(|other| *other <= neighbour), neighbour);
        }
    }
    first_most_frequent(&nearest)
}

/// The class with most neighbours; of several, the one that comes first.
fn first_most_frequent(neighbours: &[Neighbour]) -> Option<ClassId> {
    let votes = |class: ClassId| neighbours.iter().filter(|other| other.1 == class).count();
    let mut winner: Option<(usize, ClassId)> = None;
    for &(_, class) in neighbours {
        let count = votes(class);
        if winner.is_none_or(|(most, _)| count > most) {
            winner = Some((count, class));
        }
    }
    winner.map(|(_, class)| class)
}
