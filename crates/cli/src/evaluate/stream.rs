//! Keyframe after keyframe: read, scored, dropped.

use std::sync::atomic::{AtomicUsize, Ordering};

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, KeyframeLabels};
use occlabel_evaluate::scores::{Breakdown, SceneAttributes, ScoreTally, ScoredLabels, ScoredPair};
use rayon::prelude::*;

use crate::evaluate::mask;
use crate::evaluate::missing::name;
use crate::evaluate::plan::Plan;
use crate::label_pairs::LabelPairs;

/// Scores every pair, as many at once as there are threads; each is dropped once it is counted.
///
/// # Errors
/// Of several keyframes at fault, the first.
pub(crate) fn score(
    plan: &Plan,
    pairs: &LabelPairs,
    attributes: &SceneAttributes,
) -> Result<Breakdown, Fault> {
    let first_fault = AtomicUsize::new(usize::MAX);
    let counted = pairs.both.par_iter().enumerate().fold(Counted::default, |sum, (at, keys)| {
        // What comes after a fault is not needed any more; what comes before may have another.
        if at > first_fault.load(Ordering::Relaxed) {
            return sum;
        }
        match score_pair(plan, pairs, keys) {
            Ok(tally) => sum.with(&tally, &keys.0.scene, attributes),
            Err(fault) => {
                first_fault.fetch_min(at, Ordering::Relaxed);
                sum.failed(at, fault)
            }
        }
    });
    let all = counted.reduce(Counted::default, Counted::join);
    all.fault.map_or(Ok(all.breakdown), |(_, fault)| Err(fault))
}

/// What some keyframes gave, and the first fault among them.
#[derive(Default)]
struct Counted {
    breakdown: Breakdown,
    fault: Option<(usize, Fault)>,
}

impl Counted {
    fn with(mut self, tally: &ScoreTally, scene: &str, attributes: &SceneAttributes) -> Self {
        self.breakdown.add(tally, scene, attributes);
        self
    }

    fn failed(mut self, at: usize, fault: Fault) -> Self {
        self.fault.get_or_insert((at, fault));
        self
    }

    fn join(mut self, other: Self) -> Self {
        self.breakdown += &other.breakdown;
        let faults = self.fault.into_iter().chain(other.fault);
        self.fault = faults.min_by_key(|(at, _)| *at);
        self
    }
}

fn score_pair(
    plan: &Plan,
    pairs: &LabelPairs,
    (true_key, predicted_key): &(KeyframeKey, KeyframeKey),
) -> Result<ScoreTally, Fault> {
    let truth = pairs.a.read_with(true_key, &plan.wanted)?;
    let prediction = pairs.b.read_with(predicted_key, &plan.wanted)?;
    let origins = plan.origins.as_ref().map(|origins| origins.of(true_key)).transpose()?;
    let score = || {
        plan.scorer.score(&ScoredPair {
            truth: scored(&truth),
            prediction: scored(&prediction),
            mask: mask::of(&truth, plan.mask)?,
            origins: origins.as_deref().unwrap_or_default(),
        })
    };
    score().map_err(|fault| fault.record(name(true_key)))
}

fn scored(labels: &KeyframeLabels) -> ScoredLabels<'_> {
    ScoredLabels {
        semantics: &labels.semantics,
        instances: labels.instances.as_ref(),
        flow: labels.flow.as_ref(),
    }
}
