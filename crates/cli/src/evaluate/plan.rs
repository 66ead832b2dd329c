//! What is scored, and by which rules: settled on the first keyframe.

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeLabels, LabelSet, Wanted};
use occlabel_evaluate::scores::{Metrics, Scorer, ScoringRules};

use crate::args::{EvaluateArgs, MaskArg, MetricArg};
use crate::evaluate::{classes, mask};
use crate::exit::Stop;
use crate::label_pairs::LabelPairs;

/// What is scored, and by which rules.
pub(crate) struct Plan {
    pub(crate) scorer: Scorer,
    pub(crate) wanted: Wanted,
    pub(crate) mask: MaskArg,
    /// Scores that `all` cannot have, and why.
    pub(crate) left_out: Vec<String>,
}

impl Plan {
    pub(crate) fn new(args: &EvaluateArgs, pairs: &LabelPairs) -> Result<Self, Stop> {
        let rules = rules(args, &pairs.a).map_err(Stop::usage)?;
        let (true_key, predicted_key) = pairs.both.first().ok_or_else(|| nothing(args))?;
        let wanted = wanted_for(&args.metrics);
        let first = pairs.a.read_with(true_key, &wanted)?;
        let predicted = pairs.b.read_with(predicted_key, &wanted)?;
        let (metrics, left_out) = metrics(&args.metrics, &first, &predicted);
        Ok(Self {
            scorer: Scorer::new(rules, metrics).map_err(Stop::usage)?,
            wanted: Wanted {
                instances: metrics.panoptic || metrics.velocity,
                flow: metrics.velocity,
                extras: false,
            },
            mask: mask::choose(args.mask, &first),
            left_out,
        })
    }
}

fn rules(args: &EvaluateArgs, truth: &LabelSet) -> Result<ScoringRules, Fault> {
    let table = truth.classes();
    Ok(ScoringRules {
        ignored: classes::ignored(table),
        things: classes::named(table, args.things.as_deref())?,
        flow_classes: classes::named(table, args.flow_classes.as_deref())?,
        ring_m: args.rings.clone(),
        f_threshold_m: args.f_threshold_m,
        detection_m: args.detection_m,
        min_segment_voxels: args.min_segment_voxels,
        ..ScoringRules::new(truth.spec().clone(), table.names())
    })
}

fn nothing(args: &EvaluateArgs) -> Fault {
    let place = args.truth.display().to_string();
    Fault::new("evaluate-keyframes", place, "keyframes", "none")
}

/// What may have to be read for these metrics: arrays that are not there are no fault yet.
fn wanted_for(asked: &[MetricArg]) -> Wanted {
    let is_asked = |metric| asked.contains(&metric) || asked.contains(&MetricArg::All);
    let velocity = is_asked(MetricArg::Velocity);
    Wanted { instances: is_asked(MetricArg::Panoptic) || velocity, flow: velocity, extras: false }
}

/// The metrics that are asked for; of `all`, those that both sides can tell.
fn metrics(
    asked: &[MetricArg],
    truth: &KeyframeLabels,
    prediction: &KeyframeLabels,
) -> (Metrics, Vec<String>) {
    let all = asked.contains(&MetricArg::All);
    let has = |metric| asked.contains(&metric);
    let both = |f: fn(&KeyframeLabels) -> bool| f(truth) && f(prediction);
    let (instances, flow) = (both(|l| l.instances.is_some()), both(|l| l.flow.is_some()));
    let metrics = Metrics {
        semantic: all || has(MetricArg::Miou),
        f_score: all || has(MetricArg::Fscore),
        panoptic: has(MetricArg::Panoptic) || all && instances,
        velocity: has(MetricArg::Velocity) || all && flow,
    };
    let mut left_out = Vec::new();
    for (name, array, is_taken) in
        [("panoptic", "instances", metrics.panoptic), ("velocity", "flow", metrics.velocity)]
    {
        if all && !is_taken {
            left_out.push(format!("{name} is left out: not both sides have `{array}`"));
        }
    }
    (metrics, left_out)
}
