//! The scores along rays, of those keyframes that have origins.

use occlabel_core::{ClassId, ClassSet, Fault};
use serde::Serialize;

use super::rules::ScoringRules;
use super::scorer::{Metrics, ScoredLabels, ScoredPair};
use crate::rays::{
    FlowScore, FlowTally, InstanceGrids, PanopticTally, RayGrid, RayIou, RayPair, RayPq, RaySet,
    RayTally, THRESHOLDS_M, challenge_score, ray_pairs,
};

/// What was counted along rays.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTallies {
    iou: RayTally,
    panoptic: Option<PanopticTally>,
    flow: Option<FlowTally>,
}

/// RayIoU and its kin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayScores {
    /// The classes, in the order of every `by_class`.
    pub classes: Vec<String>,
    /// RayIoU.
    pub ray_iou: RayIou,
    /// RayPQ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ray_pq: Option<RayPq>,
    /// The classes of AVE, in the order of its `by_class`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub flow_classes: Vec<String>,
    /// AVE along rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ave: Option<FlowScore>,
    /// The score of the challenge of 2024, of RayIoU and mAVE.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub challenge_score: Option<f64>,
}

impl RayTallies {
    /// Of one keyframe, whose ids and shapes are checked.
    pub(crate) fn of(
        pair: &ScoredPair,
        rules: &ScoringRules,
        metrics: Metrics,
        rays: &RaySet,
    ) -> Result<Self, Fault> {
        let (truth, prediction) = (pair.truth.semantics, pair.prediction.semantics);
        let pairs = ray_pairs(
            &RayGrid::new(&rules.spec, truth, rules.free())?,
            &RayGrid::new(&rules.spec, prediction, rules.free())?,
            pair.origins,
            rays,
        )?;
        let mut iou = RayTally::new(rules.classes.len(), &THRESHOLDS_M);
        iou.count(&pairs, truth, prediction);
        let panoptic = metrics.ray_panoptic.then(|| panoptic(&pairs, pair, rules));
        let flow = metrics.ray_flow.then(|| flow(&pairs, pair, rules));
        Ok(Self { iou, panoptic: panoptic.flatten(), flow: flow.flatten() })
    }

    /// Adds another keyframe's.
    pub(super) fn add(&mut self, other: &Self) {
        self.iou.add(&other.iou);
        if let (Some(sum), Some(other)) = (&mut self.panoptic, &other.panoptic) {
            sum.add(other);
        }
        if let (Some(sum), Some(other)) = (&mut self.flow, &other.flow) {
            sum.add(other);
        }
    }

    /// Takes the ratios.
    pub(crate) fn scores(&self, rules: &ScoringRules) -> RayScores {
        let ray_iou = self.iou.ray_iou();
        let ave = self.flow.as_ref().map(FlowTally::score);
        let asked = if ave.is_some() { ids(&rules.flow_classes, rules) } else { Vec::new() };
        let name = |id: &u8| rules.classes[usize::from(*id)].clone();
        RayScores {
            classes: rules.classes.clone(),
            challenge_score: challenge_score(ray_iou.mean, ave.as_ref().and_then(|ave| ave.mean)),
            ray_iou,
            ray_pq: self.panoptic.as_ref().map(PanopticTally::ray_pq),
            flow_classes: asked.iter().map(name).collect(),
            ave,
        }
    }
}

fn panoptic(pairs: &[RayPair], pair: &ScoredPair, rules: &ScoringRules) -> Option<PanopticTally> {
    fn grids<'a>(labels: &ScoredLabels<'a>) -> Option<InstanceGrids<'a>> {
        Some(InstanceGrids { semantics: labels.semantics, instances: labels.instances? })
    }
    let things = ids(&rules.things, rules);
    let mut tally = PanopticTally::new(rules.classes.len(), &things, &THRESHOLDS_M);
    tally.count(pairs, grids(&pair.truth)?, grids(&pair.prediction)?);
    Some(tally)
}

fn flow(pairs: &[RayPair], pair: &ScoredPair, rules: &ScoringRules) -> Option<FlowTally> {
    let truth = (pair.truth.semantics, pair.truth.flow?);
    let prediction = (pair.prediction.semantics, pair.prediction.flow?);
    let mut tally = FlowTally::new(&ids(&rules.flow_classes, rules));
    tally.count(pairs, [truth, prediction]);
    Some(tally)
}

fn ids(set: &ClassSet, rules: &ScoringRules) -> Vec<u8> {
    (0..rules.free()).filter(|&id| set.contains(ClassId(id))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::scorer::Scorer;
    use super::super::scorer::tests::{pair, row};
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn rays_begin_at_the_keyframes_origins() {
        let rules = ScoringRules {
            things: [ClassId(0)].into_iter().collect(),
            flow_classes: [ClassId(0)].into_iter().collect(),
            ..row(8, 1.0)
        };
        let metrics =
            Metrics { rays: true, ray_panoptic: true, ray_flow: true, ..Metrics::default() };
        let wall = |at: usize| std::array::from_fn::<u8, 8, _>(|x| u8::from(x != at));
        let mut grids = pair(&rules, &wall(4), &wall(6));
        grids.instances(&[1; 8], &[1; 8]);
        grids.flow(&[[1.0, 0.0, 0.0]; 8], &[[1.0, 0.5, 0.0]; 8]);
        grids.origins = vec![Point3::new(0.5, 0.5, 0.5)];
        let scorer = Scorer::new(rules.clone(), metrics).unwrap();
        let scores = scorer.score(&grids.scored()).unwrap().scores(&rules).rays.unwrap();
        let means: Vec<_> = scores.ray_iou.by_threshold.iter().map(|at| at.mean).collect();
        assert_eq!(means[0], Some(0.0), "the wall is two voxels too far");
        assert!(means[0] < means[1] && means[1] < means[2], "{means:?}");
        assert!(scores.ray_pq.is_some() && scores.ave.is_some());
        assert_eq!((scores.classes, scores.flow_classes.len()), (vec!["car".to_owned()], 1));
    }
}
