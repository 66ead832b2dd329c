//! Tallies as shares and metres.

use serde::Serialize;

use super::{HeldOutTally, KindTally, Tally};

/// The figures of labels, beside those of perfect labels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeldOutFigures {
    /// Of the labels.
    pub labels: Figures,
    /// Of the perfect labels of a flat ground, asked by the rays that end on ground.
    pub floor: Figures,
}

/// What a tally comes to. A share of nothing is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Rays that ended on the ground.
    pub ground: KindFigures,
    /// Rays that ended on what is neither ground nor a track.
    pub structure: KindFigures,
    /// Rays that ended on tracks.
    pub tracks: KindFigures,
    /// Returns in the grid that were asked.
    pub returns: u64,
    /// Share of them in unobserved voxels.
    pub returns_in_unobserved: Option<f64>,
    /// Returns of another time where a track stands now: not asked.
    pub returns_covered: u64,
    /// Occupied voxels with a return, or with at least 3 crossings.
    pub occupied_asked: u64,
    /// Share of them without a return.
    pub contradicted: Option<f64>,
}

/// What a tally of one kind of rays comes to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KindFigures {
    /// Returns in the grid.
    pub returns: u64,
    /// Share of them with an occupied voxel within the tolerance.
    pub hit_recall: Option<f64>,
    /// Crossings more than one voxel away from any return.
    pub crossings: u64,
    /// Share of them in voxels that are not occupied.
    pub free_agreement: Option<f64>,
    /// Share of them in unobserved voxels.
    pub crossings_of_unobserved: Option<f64>,
    /// Mean error of the first occupied voxel's distance, metres.
    pub depth_mean_m: Option<f64>,
    /// Its median, to half a centimetre.
    pub depth_median_m: Option<f64>,
    /// Its 95th percentile, to half a centimetre.
    pub depth_p95_m: Option<f64>,
    /// Share of rays with a return in the grid that meet no occupied voxel at all.
    pub meet_nothing: Option<f64>,
}

impl HeldOutFigures {
    /// Of a tally.
    pub fn of(tally: &HeldOutTally) -> Self {
        Self { labels: Figures::of(&tally.labels), floor: Figures::of(&tally.floor) }
    }
}

impl Figures {
    fn of(tally: &Tally) -> Self {
        Self {
            ground: KindFigures::of(&tally.ground),
            structure: KindFigures::of(&tally.structure),
            tracks: KindFigures::of(&tally.tracks),
            returns: tally.returns(),
            returns_in_unobserved: share(tally.in_unobserved(), tally.returns()),
            returns_covered: tally.covered,
            occupied_asked: tally.occupied_asked,
            contradicted: share(tally.contradicted, tally.occupied_asked),
        }
    }
}

impl KindFigures {
    fn of(tally: &KindTally) -> Self {
        let free = tally.crossings - tally.crossings_of_occupied;
        Self {
            returns: tally.returns,
            hit_recall: share(tally.hits, tally.returns),
            crossings: tally.crossings,
            free_agreement: share(free, tally.crossings),
            crossings_of_unobserved: share(tally.crossings_of_unobserved, tally.crossings),
            depth_mean_m: tally.depth.mean_m(),
            depth_median_m: tally.depth.percentile_m(50),
            depth_p95_m: tally.depth.percentile_m(95),
            meet_nothing: share(tally.meet_nothing, tally.returns),
        }
    }
}

fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
