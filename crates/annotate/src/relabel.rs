//! Labels for unlabelled background (labels.md section 5).

use occlabel_core::{
    AggregatedScene, BackgroundSweep, ClassCounts, ClassId, ClassSet, DropCounts, Taxonomy,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::ballot::{Ballot, GROUP};
use crate::groups::for_each_group;
use crate::labelled_tree::{Labelled, LabelledTree};
use crate::unlabelled::{Unlabelled, Verdict};

/// How unlabelled background points get a class.
#[derive(Clone, Debug, PartialEq)]
pub struct RelabelSettings {
    /// How many neighbours vote, at least 1.
    pub k: usize,
    /// How far a neighbour may be, metres; `None` lifts the limit.
    pub max_distance_m: Option<f64>,
    /// The class of a point without a neighbour in reach; `None` drops it.
    pub unknown: Option<ClassId>,
    /// Classes whose background points are dropped afterwards.
    pub ghosts: ClassSet,
}

/// Which background points are left-overs of unboxed or badly boxed objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GhostClasses {
    /// The taxonomy's things.
    Things,
    /// The taxonomy's movers.
    Movers,
    /// None are.
    None,
}

impl GhostClasses {
    /// The classes meant: only those that boxes could have held, and only if there is a track.
    pub fn of(self, taxonomy: &Taxonomy, has_track: bool) -> ClassSet {
        match self {
            _ if !has_track => ClassSet::default(),
            Self::Things => taxonomy.things.intersection(&taxonomy.boxed()),
            Self::Movers => taxonomy.movers.intersection(&taxonomy.boxed()),
            Self::None => ClassSet::default(),
        }
    }
}

/// Gives every background point a class or drops it. Points of tracks keep theirs.
///
/// A point votes with its nearest labelled neighbours of the whole scene, ordered by
/// (distance, class id); on equal votes the tied class that comes first in that order wins.
/// Parallel over groups of neighbouring points; the order of threads does not show.
pub fn relabel(
    scene: AggregatedScene<Option<ClassId>>,
    settings: &RelabelSettings,
) -> AggregatedScene<ClassId> {
    let verdicts = verdicts(&scene.background, settings);
    let relabelled: Vec<_> = (scene.background.into_par_iter().zip(verdicts))
        .map(|(sweep, verdicts)| relabel_sweep(sweep, &verdicts, settings))
        .collect();
    let (mut dropped, mut class_from) = (scene.dropped, ClassCounts::default());
    let mut background = Vec::with_capacity(relabelled.len());
    for (sweep, drops, classes) in relabelled {
        background.push(sweep);
        dropped += drops;
        class_from += classes;
    }
    class_from.boxes = scene.objects.iter().map(|object| object.cloud.len() as u64).sum();
    AggregatedScene {
        background,
        objects: scene.objects,
        bodies: scene.bodies,
        dropped,
        class_from,
    }
}

/// What the vote gives each unlabelled point: a list a sweep, a verdict a point.
fn verdicts(
    sweeps: &[BackgroundSweep<Option<ClassId>>],
    settings: &RelabelSettings,
) -> Vec<Vec<Verdict>> {
    let verdicts: Vec<Vec<Verdict>> = (sweeps.par_iter())
        .map(|sweep| sweep.cloud.labels.iter().map(|_| Verdict::default()).collect())
        .collect();
    if sweeps.iter().any(|sweep| sweep.cloud.labels.contains(&None)) {
        let tree = LabelledTree::new(labelled_points(sweeps), settings.k);
        for round in Unlabelled::new(sweeps, &verdicts).rounds() {
            let reach_m = settings.max_distance_m.unwrap_or(f64::INFINITY);
            let (k, reach_squared) = (settings.k, reach_m * reach_m);
            let ballot = Ballot { tree: &tree, k, reach_squared, round: &round };
            let position = |number: u32| round.position(number);
            for_each_group(&mut round.items(), GROUP, &position, &|group| ballot.hold(group));
        }
    }
    verdicts
}

fn labelled_points(sweeps: &[BackgroundSweep<Option<ClassId>>]) -> Vec<Labelled> {
    let points = || {
        let clouds = sweeps.iter().map(|sweep| &sweep.cloud);
        let points = clouds.flat_map(|cloud| cloud.positions.iter().zip(&cloud.labels));
        points.filter_map(|(position, label)| Some((*position, (*label)?)))
    };
    let mut labelled = Vec::with_capacity(points().count());
    labelled.extend(points());
    labelled
}

fn relabel_sweep(
    sweep: BackgroundSweep<Option<ClassId>>,
    verdicts: &[Verdict],
    settings: &RelabelSettings,
) -> (BackgroundSweep<ClassId>, DropCounts, ClassCounts) {
    let (mut drops, mut classes) = (DropCounts::default(), ClassCounts::default());
    let is_painted = !sweep.brushes.is_empty();
    let mut brushes = Vec::with_capacity(sweep.brushes.len());
    let cloud = sweep.cloud.filter_map(|i, label| {
        let chosen = (label.map(|class| (class, &mut classes.labels)))
            .or_else(|| Some((verdicts[i].class()?, &mut classes.neighbours)))
            .or_else(|| Some((settings.unknown?, &mut classes.unknown)));
        let Some((class, from)) = chosen else {
            drops.unknown += 1;
            return None;
        };
        if settings.ghosts.contains(class) {
            drops.ghost += 1;
            return None;
        }
        *from += 1;
        if is_painted {
            brushes.push(sweep.brushes[i]);
        }
        Some(class)
    });
    classes.masks = brushes.iter().filter(|brush| brush.is_painted()).count() as u64;
    classes.labels -= classes.masks;
    (BackgroundSweep { brushes, ..BackgroundSweep::new(sweep.time, cloud) }, drops, classes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use occlabel_core::{PointCloud, Timestamp};

    const A: ClassId = ClassId(3);
    const B: ClassId = ClassId(1);

    fn settings() -> RelabelSettings {
        RelabelSettings {
            k: 3,
            max_distance_m: Some(1.0),
            unknown: Some(ClassId(9)),
            ghosts: ClassSet::default(),
        }
    }

    /// Points along x, with a label or none.
    fn scene(points: &[(f64, Option<ClassId>)]) -> AggregatedScene<Option<ClassId>> {
        let mut cloud = PointCloud::with_origins(vec![Point3::origin()]);
        points.iter().for_each(|(x, label)| cloud.push(Point3::new(*x, 0.0, 0.0), *label, 0));
        let background = vec![BackgroundSweep::new(Timestamp(0), cloud)];
        AggregatedScene::new(background, Vec::new())
    }

    fn labels(points: &[(f64, Option<ClassId>)], settings: &RelabelSettings) -> Vec<ClassId> {
        relabel(scene(points), settings).background[0].cloud.labels.clone()
    }

    #[test]
    fn section_5_the_majority_of_k_neighbours_wins() {
        let points = [(0.0, Some(A)), (0.3, Some(B)), (0.4, Some(B)), (0.1, None)];
        assert_eq!(labels(&points, &settings())[3], B);
    }

    #[test]
    fn section_5_on_equal_votes_the_nearest_class_wins_and_at_one_distance_the_lower_id() {
        let mut two = settings();
        two.k = 2;
        assert_eq!(labels(&[(0.0, Some(A)), (0.5, Some(B)), (0.2, None)], &two)[2], A);
        assert_eq!(labels(&[(0.0, Some(A)), (0.5, Some(B)), (0.25, None)], &two)[2], B);
    }

    #[test]
    fn section_5_neighbours_out_of_reach_do_not_vote() {
        let points = [(0.0, Some(A)), (1.0, None), (1.000_001, None)];
        assert_eq!(labels(&points, &settings()), [A, A, ClassId(9)]);
        let mut far = settings();
        far.max_distance_m = None;
        assert_eq!(labels(&points, &far), [A, A, A]);
    }

    #[test]
    fn section_5_a_point_without_neighbour_is_dropped_if_unknown_is_drop() {
        let mut drop = settings();
        drop.unknown = None;
        let relabelled = relabel(scene(&[(0.0, Some(A)), (5.0, None)]), &drop);
        assert_eq!((relabelled.point_count(), relabelled.dropped.unknown), (1, 1));
    }

    #[test]
    fn section_5_ghosts_are_dropped_labelled_or_not() {
        let mut ghosts = settings();
        ghosts.ghosts.insert(A);
        let relabelled = relabel(scene(&[(0.0, Some(A)), (0.1, None), (9.0, Some(B))]), &ghosts);
        assert_eq!(relabelled.background[0].cloud.labels, [B]);
        assert_eq!(relabelled.dropped.ghost, 2);
    }

    #[test]
    fn section_5_every_point_is_counted_by_where_its_class_is_from() {
        let mut ghosts = settings();
        ghosts.ghosts.insert(B);
        let points = [(0.0, Some(A)), (0.1, None), (7.0, None), (20.0, Some(B)), (20.1, None)];
        let relabelled = relabel(scene(&points), &ghosts);
        let expected =
            ClassCounts { labels: 1, neighbours: 1, unknown: 1, ..ClassCounts::default() };
        assert_eq!((relabelled.class_from, relabelled.dropped.ghost), (expected, 2));
    }

    #[test]
    fn fault_28_an_unlabelled_point_never_votes_as_class_0() {
        let points = [(0.0, None), (0.1, None), (0.2, Some(A)), (0.05, None)];
        assert_eq!(labels(&points, &settings()), [A; 4]);
    }
}
