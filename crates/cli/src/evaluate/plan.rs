//! What is scored, and by which rules: settled on the first keyframe.

use occlabel_core::{Fault, GridSpec};
use occlabel_dialects::{KeyframeLabels, LabelSet};
use occlabel_evaluate::scores::{Metrics, Scorer, ScoringRules};

use crate::args::{EvaluateArgs, MaskArg, MetricArg};
use crate::evaluate::pairing::Pairing;
use crate::evaluate::{classes, mask};
use crate::exit::Stop;

/// What is scored, and by which rules.
pub(crate) struct Plan {
    pub(crate) scorer: Scorer,
    pub(crate) mask: MaskArg,
    /// Scores that `all` cannot have, and why.
    pub(crate) left_out: Vec<String>,
}

impl Plan {
    pub(crate) fn new(
        args: &EvaluateArgs,
        truth: &LabelSet,
        prediction: &LabelSet,
        pairing: &Pairing,
    ) -> Result<Self, Stop> {
        let rules = rules(args, truth, prediction).map_err(Stop::usage)?;
        let (true_key, predicted_key) = &pairing.pairs[0];
        let first = truth.read(true_key)?;
        let predicted = prediction.read(predicted_key)?;
        let (metrics, left_out) = metrics(&args.metrics, &first, &predicted);
        Ok(Self {
            scorer: Scorer::new(rules, metrics).map_err(Stop::usage)?,
            mask: mask::choose(args.mask, &first),
            left_out,
        })
    }
}

fn rules(
    args: &EvaluateArgs,
    truth: &LabelSet,
    prediction: &LabelSet,
) -> Result<ScoringRules, Fault> {
    let table = truth.classes();
    classes::check_same(table, prediction.classes())?;
    check_grid(truth, prediction)?;
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

fn check_grid(truth: &LabelSet, prediction: &LabelSet) -> Result<(), Fault> {
    if truth.spec() == prediction.spec() && truth.frame() == prediction.frame() {
        return Ok(());
    }
    let (expected, found) = (grid_name(truth), grid_name(prediction));
    Err(Fault::new("evaluate-grid", "prediction", format!("the truth's grid, {expected}"), found))
}

fn grid_name(set: &LabelSet) -> String {
    let corner = |p: nalgebra::Point3<f64>| format!("{} {} {}", p.x, p.y, p.z);
    let spec: &GridSpec = set.spec();
    let ([x, y, z], size_m) = (spec.shape(), spec.size_m());
    let (min, max) = (corner(spec.min_m()), corner(spec.max_m()));
    format!(
        "{x} x {y} x {z} voxels of {} x {} x {} m from {min} to {max} m in the {} frame",
        size_m.x,
        size_m.y,
        size_m.z,
        set.frame()
    )
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
