//! One keyframe's prediction against its truth.

use nalgebra::Point3;
use occlabel_core::{Fault, VoxelGrid};

use super::confusion::Confusion;
use super::door::{check_pair, check_rules};
use super::f_score::FScoreTally;
use super::pair_counts::PairCounts;
use super::panoptic::PanopticTally;
use super::ray_scores::RayTallies;
use super::rings::Rings;
use super::rules::ScoringRules;
use super::tally::ScoreTally;
use super::velocity::VelocityTally;
use crate::rays::RaySet;

/// The labels of one keyframe, with canonical ids.
#[derive(Clone, Copy, Debug)]
pub struct ScoredLabels<'a> {
    /// The class, free, or [`UNLABELLED`](super::UNLABELLED).
    pub semantics: &'a VoxelGrid<u8>,
    /// The number of the instance, 0 where there is none.
    pub instances: Option<&'a VoxelGrid<u16>>,
    /// Velocity in the grid frame, m/s; not a number where it is not known.
    pub flow: Option<&'a VoxelGrid<[f32; 3]>>,
}

impl<'a> ScoredLabels<'a> {
    /// Labels of classes alone.
    pub fn of(semantics: &'a VoxelGrid<u8>) -> Self {
        Self { semantics, instances: None, flow: None }
    }
}

/// Truth and prediction of one keyframe.
#[derive(Clone, Copy, Debug)]
pub struct ScoredPair<'a> {
    /// What is true.
    pub truth: ScoredLabels<'a>,
    /// What is predicted.
    pub prediction: ScoredLabels<'a>,
    /// Voxels are asked where it is not 0; none: everywhere.
    pub mask: Option<&'a VoxelGrid<u8>>,
    /// Where rays begin, in the grid frame, metres. Masks do not concern them.
    pub origins: &'a [Point3<f64>],
}

/// Which scores are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Metrics {
    /// mIoU and all else that the confusion of classes gives.
    pub semantic: bool,
    /// F-score and chamfer distance.
    pub f_score: bool,
    /// PQ, SQ, RQ: both sides need instances.
    pub panoptic: bool,
    /// AVE-T, AVE-O, AVE-D: both sides need flow, AVE-D instances too.
    pub velocity: bool,
    /// RayIoU.
    pub rays: bool,
    /// RayPQ, with RayIoU: both sides need instances.
    pub ray_panoptic: bool,
    /// AVE along rays and the score of the challenge of 2024, with RayIoU: both sides need flow.
    pub ray_flow: bool,
}

/// Scores keyframes by fixed rules.
#[derive(Clone, Debug)]
pub struct Scorer {
    rules: ScoringRules,
    metrics: Metrics,
    rings: Rings,
    rays: RaySet,
}

impl Scorer {
    /// A scorer of these metrics.
    ///
    /// # Errors
    /// If there are more than 254 classes, or the rings do not rise.
    pub fn new(rules: ScoringRules, metrics: Metrics) -> Result<Self, Fault> {
        check_rules(&rules)?;
        let rings = Rings::new(&rules.spec, &rules.ring_m);
        Ok(Self { rules, metrics, rings, rays: RaySet::published() })
    }

    /// The rules of scoring.
    pub fn rules(&self) -> &ScoringRules {
        &self.rules
    }

    /// Counts one keyframe, on the thread that asks.
    ///
    /// # Errors
    /// If a grid has not the rules' shape, an id is of no class, or an array that a metric needs is
    /// absent.
    pub fn score(&self, pair: &ScoredPair) -> Result<ScoreTally, Fault> {
        check_pair(pair, &self.rules, self.metrics)?;
        let (rules, metrics) = (&self.rules, self.metrics);
        Ok(ScoreTally {
            keyframes: 1,
            rings: if metrics.semantic { self.confusions(pair) } else { Vec::new() },
            f_score: metrics.f_score.then(|| FScoreTally::of(pair, rules)),
            panoptic: metrics.panoptic.then(|| PanopticTally::of(pair, rules)),
            velocity: metrics.velocity.then(|| VelocityTally::of(pair, rules)),
            rays: self.rays(pair)?,
        })
    }

    fn rays(&self, pair: &ScoredPair) -> Result<Option<RayTallies>, Fault> {
        let tallies = || RayTallies::of(pair, &self.rules, self.metrics, &self.rays);
        self.metrics.rays.then(tallies).transpose()
    }

    /// The confusion of each ring.
    fn confusions(&self, pair: &ScoredPair) -> Vec<Confusion> {
        let truth = pair.truth.semantics.values();
        let prediction = pair.prediction.semantics.values();
        let mask = pair.mask.map(VoxelGrid::values);
        let mut counts: Vec<_> = (0..self.rings.count()).map(|_| PairCounts::new()).collect();
        let nz = self.rules.spec.shape()[2];
        for (ring, columns) in self.rings.runs() {
            let voxels = columns.start * nz..columns.end * nz;
            let mask = mask.map(|mask| &mask[voxels.clone()]);
            counts[ring].count(&truth[voxels.clone()], &prediction[voxels], mask);
        }
        let (classes, ignored) = (self.rules.classes.len(), &self.rules.ignored);
        counts.iter().map(|pairs| Confusion::of_pairs(pairs, classes, ignored)).collect()
    }
}

impl ScoredPair<'_> {
    /// A grid's value where the mask asks for it.
    #[inline]
    pub(crate) fn asks(&self, at: usize) -> bool {
        self.mask.is_none_or(|mask| mask.values()[at] != 0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use occlabel_core::GridSpec;

    /// A row of voxels along x, with one class (0) and free (1).
    pub(crate) fn row(voxels: usize, size_m: f64) -> ScoringRules {
        let max_m = [voxels as f64 * size_m, size_m, size_m];
        let spec = GridSpec::new([0.0; 3], max_m, [size_m; 3]).unwrap();
        ScoringRules::new(spec, vec!["car".into()])
    }

    /// Grids of a pair.
    pub(crate) struct PairGrids {
        spec: GridSpec,
        semantics: [VoxelGrid<u8>; 2],
        instances: Option<[VoxelGrid<u16>; 2]>,
        flow: Option<[VoxelGrid<[f32; 3]>; 2]>,
        pub(crate) mask: Option<VoxelGrid<u8>>,
        pub(crate) origins: Vec<Point3<f64>>,
    }

    pub(crate) fn pair(rules: &ScoringRules, truth: &[u8], prediction: &[u8]) -> PairGrids {
        let spec = rules.spec.clone();
        let semantics = [truth, prediction].map(|ids| VoxelGrid::from_values(&spec, ids.to_vec()));
        PairGrids { spec, semantics, instances: None, flow: None, mask: None, origins: Vec::new() }
    }

    impl PairGrids {
        pub(crate) fn instances(&mut self, truth: &[u16], prediction: &[u16]) {
            let grid = |ids: &[u16]| VoxelGrid::from_values(&self.spec, ids.to_vec());
            self.instances = Some([grid(truth), grid(prediction)]);
        }

        pub(crate) fn flow(&mut self, truth: &[[f32; 3]], prediction: &[[f32; 3]]) {
            let grid = |mps: &[[f32; 3]]| VoxelGrid::from_values(&self.spec, mps.to_vec());
            self.flow = Some([grid(truth), grid(prediction)]);
        }

        pub(crate) fn scored(&self) -> ScoredPair<'_> {
            let labels = |side: usize| ScoredLabels {
                semantics: &self.semantics[side],
                instances: self.instances.as_ref().map(|sides| &sides[side]),
                flow: self.flow.as_ref().map(|sides| &sides[side]),
            };
            ScoredPair {
                truth: labels(0),
                prediction: labels(1),
                mask: self.mask.as_ref(),
                origins: &self.origins,
            }
        }
    }

    #[test]
    fn rings_share_the_voxels_out() {
        let rules = ScoringRules { ring_m: vec![2.0], ..row(4, 1.0) };
        let scorer = Scorer::new(rules.clone(), Metrics { semantic: true, ..Metrics::default() });
        let mut grids = pair(&rules, &[0, 1, 0, 0], &[0, 1, 1, 0]);
        grids.mask = Some(VoxelGrid::from_values(&rules.spec, vec![1, 1, 1, 0]));
        let tally = scorer.unwrap().score(&grids.scored()).unwrap();
        let scores = tally.scores(&rules);
        let mious: Vec<_> = scores.by_ring.iter().map(|ring| ring.semantic.miou).collect();
        assert_eq!(mious, [Some(1.0), Some(0.0)]);
        assert_eq!(scores.semantic.unwrap().miou, Some(0.5), "the last voxel is masked");
    }

    #[test]
    fn what_a_metric_needs_has_to_be_there() {
        let rules = row(2, 1.0);
        let grids = pair(&rules, &[0, 1], &[0, 1]);
        let refusal = |metrics| {
            let scorer = Scorer::new(rules.clone(), metrics).unwrap();
            scorer.score(&grids.scored()).unwrap_err().to_string()
        };
        let panoptic = refusal(Metrics { panoptic: true, ..Metrics::default() });
        assert!(panoptic.contains("instances"), "{panoptic}");
        let velocity = refusal(Metrics { velocity: true, ..Metrics::default() });
        assert!(velocity.contains("flow"), "{velocity}");
    }

    #[test]
    fn ids_of_no_class_are_refused() {
        let rules = row(2, 1.0);
        let scorer = Scorer::new(rules.clone(), Metrics::default()).unwrap();
        let refused =
            |prediction: &[u8]| scorer.score(&pair(&rules, &[0, 255], prediction).scored());
        assert!(refused(&[1, 255]).is_ok());
        let fault = refused(&[1, 2]).unwrap_err().to_string();
        assert!(fault.contains("prediction") && fault.contains("id 2"), "{fault}");
    }
}
