//! What was counted over keyframes, and the scores that it gives.

use std::iter::Sum;
use std::ops::AddAssign;

use serde::Serialize;

use super::confusion::Confusion;
use super::f_score::{FScoreTally, FScores};
use super::panoptic::PanopticTally;
use super::panoptic_scores::PanopticScores;
use super::ray_scores::{RayScores, RayTallies};
use super::rules::ScoringRules;
use super::semantic::SemanticScores;
use super::velocity::{VelocityScores, VelocityTally};

/// What was counted over some keyframes: tallies add up in any order to the same sum, and are no
/// larger for it. [`ScoreTally::scores`] takes the ratios.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScoreTally {
    pub(super) keyframes: u64,
    /// The confusion of each ring; one if there are no radii, none if it was not asked for.
    pub(super) rings: Vec<Confusion>,
    pub(super) f_score: Option<FScoreTally>,
    pub(super) panoptic: Option<PanopticTally>,
    pub(super) velocity: Option<VelocityTally>,
    pub(super) rays: Option<RayTallies>,
}

/// The scores of some keyframes; those that were asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// How many keyframes were scored.
    pub keyframes: u64,
    /// Of the confusion of classes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub semantic: Option<SemanticScores>,
    /// The same by horizontal distance from the grid frame's origin.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_ring: Vec<RingScores>,
    /// F-score and chamfer distance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub f_score: Option<FScores>,
    /// PQ, SQ, RQ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub panoptic: Option<PanopticScores>,
    /// AVE-T, AVE-O, AVE-D.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity: Option<VelocityScores>,
    /// RayIoU and its kin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rays: Option<RayScores>,
}

/// The scores of one range ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RingScores {
    /// Inner radius, metres.
    pub from_m: f64,
    /// Outer radius, metres; none if it reaches to the end of the grid.
    pub to_m: Option<f64>,
    /// Its scores.
    pub semantic: SemanticScores,
}

impl ScoreTally {
    /// How many keyframes were counted.
    pub fn keyframes(&self) -> u64 {
        self.keyframes
    }

    /// The confusion of classes over all rings; none if it was not asked for.
    pub fn confusion(&self) -> Option<Confusion> {
        let mut all = self.rings.first()?.clone();
        self.rings[1..].iter().for_each(|ring| all += ring);
        Some(all)
    }

    /// Takes the ratios. The rules are those that were counted by.
    pub fn scores(&self, rules: &ScoringRules) -> Scores {
        Scores {
            keyframes: self.keyframes,
            semantic: self.confusion().map(|confusion| SemanticScores::of(&confusion, rules)),
            by_ring: self.by_ring(rules),
            f_score: self.f_score.map(|tally| tally.scores(rules)),
            panoptic: self.panoptic.as_ref().map(|tally| tally.scores(rules)),
            velocity: self.velocity.as_ref().map(|tally| tally.scores(rules)),
            rays: self.rays.as_ref().map(|tallies| tallies.scores(rules)),
        }
    }

    fn by_ring(&self, rules: &ScoringRules) -> Vec<RingScores> {
        if rules.ring_m.is_empty() {
            return Vec::new();
        }
        let scores = |(ring, confusion): (usize, &Confusion)| RingScores {
            from_m: ring.checked_sub(1).map_or(0.0, |inner| rules.ring_m[inner]),
            to_m: rules.ring_m.get(ring).copied(),
            semantic: SemanticScores::of(confusion, rules),
        };
        self.rings.iter().enumerate().map(scores).collect()
    }
}

impl AddAssign<&ScoreTally> for ScoreTally {
    /// # Panics
    /// If the two were not counted by the same rules. An empty tally fits every other.
    fn add_assign(&mut self, other: &Self) {
        if self.keyframes == 0 {
            return self.clone_from(other);
        }
        if other.keyframes == 0 {
            return;
        }
        assert_eq!(self.rings.len(), other.rings.len(), "tallies of the same rings");
        self.keyframes += other.keyframes;
        self.rings.iter_mut().zip(&other.rings).for_each(|(sum, ring)| *sum += ring);
        add(&mut self.f_score, &other.f_score);
        add(&mut self.panoptic, &other.panoptic);
        add(&mut self.velocity, &other.velocity);
        if let (Some(sum), Some(other)) = (&mut self.rays, &other.rays) {
            sum.add(other);
        }
    }
}

impl Sum for ScoreTally {
    fn sum<I: Iterator<Item = Self>>(tallies: I) -> Self {
        tallies.fold(Self::default(), |mut sum, tally| {
            sum += &tally;
            sum
        })
    }
}

fn add<T: for<'a> AddAssign<&'a T>>(sum: &mut Option<T>, other: &Option<T>) {
    if let (Some(sum), Some(other)) = (sum, other) {
        *sum += other;
    }
}
