//! What is scored, and by which rules: settled on the first keyframe.

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeLabels, LabelSet, Wanted};
use occlabel_evaluate::scores::{Metrics, Scorer, ScoringRules};

use crate::args::{EvaluateArgs, MaskArg, MetricArg};
use crate::evaluate::{classes, mask};
use crate::exit::Stop;
use crate::label_pairs::LabelPairs;
use crate::ray_origins::RayOrigins;

/// What is scored, and by which rules.
pub(crate) struct Plan {
    pub(crate) scorer: Scorer,
    pub(crate) wanted: Wanted,
    pub(crate) mask: MaskArg,
    /// Where rays begin, if any are asked for.
    pub(crate) origins: Option<RayOrigins>,
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
        let origins = origins(args).map_err(Stop::usage)?;
        let (metrics, left_out) = metrics(&args.metrics, &first, &predicted, origins.is_some());
        if metrics.rays && origins.is_none() {
            return Err(Stop::usage(no_origins(args)));
        }
        Ok(Self {
            scorer: Scorer::new(rules, metrics).map_err(Stop::usage)?,
            wanted: Wanted {
                instances: metrics.panoptic || metrics.velocity || metrics.ray_panoptic,
                flow: metrics.velocity || metrics.ray_flow,
                extras: false,
            },
            mask: mask::choose(args.mask, &first),
            origins: origins.filter(|_| metrics.rays),
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

/// Where rays begin, if some metric may want to know.
fn origins(args: &EvaluateArgs) -> Result<Option<RayOrigins>, Fault> {
    let along_rays = [MetricArg::Rayiou, MetricArg::Raypq, MetricArg::Rayflow, MetricArg::All];
    match args.metrics.iter().any(|metric| along_rays.contains(metric)) {
        true => RayOrigins::find(args.ray_origins.as_deref(), &args.truth),
        false => Ok(None),
    }
}

fn no_origins(args: &EvaluateArgs) -> Fault {
    let place = args.truth.display().to_string();
    let expected = "where the lidar was at each keyframe, in the manifest";
    Fault::new("ray-origins", place, expected, "none").hint("name a file with --ray-origins")
}

/// What may have to be read for these metrics: arrays that are not there are no fault yet.
fn wanted_for(asked: &[MetricArg]) -> Wanted {
    let is_asked = |metric| asked.contains(&metric) || asked.contains(&MetricArg::All);
    let velocity = is_asked(MetricArg::Velocity);
    Wanted {
        instances: velocity || is_asked(MetricArg::Panoptic) || is_asked(MetricArg::Raypq),
        flow: velocity || is_asked(MetricArg::Rayflow),
        extras: false,
    }
}

/// The metrics that are asked for; of `all`, those that the files can tell.
fn metrics(
    asked: &[MetricArg],
    truth: &KeyframeLabels,
    prediction: &KeyframeLabels,
    has_origins: bool,
) -> (Metrics, Vec<String>) {
    let all = asked.contains(&MetricArg::All);
    let has = |metric| asked.contains(&metric);
    let both = |f: fn(&KeyframeLabels) -> bool| all && f(truth) && f(prediction);
    let (instances, flow) = (both(|l| l.instances.is_some()), both(|l| l.flow.is_some()));
    let rays = all && has_origins;
    let ray_panoptic = has(MetricArg::Raypq) || rays && instances;
    let ray_flow = has(MetricArg::Rayflow) || rays && flow;
    let metrics = Metrics {
        semantic: all || has(MetricArg::Miou),
        f_score: all || has(MetricArg::Fscore),
        panoptic: has(MetricArg::Panoptic) || instances,
        velocity: has(MetricArg::Velocity) || flow,
        rays: has(MetricArg::Rayiou) || rays || ray_panoptic || ray_flow,
        ray_panoptic,
        ray_flow,
    };
    (metrics, if all { left_out(metrics) } else { Vec::new() })
}

fn left_out(metrics: Metrics) -> Vec<String> {
    let reasons = [
        (metrics.panoptic, "PQ is left out: not both sides have `instances`"),
        (metrics.velocity, "velocity is left out: not both sides have `flow`"),
        (
            metrics.rays,
            "RayIoU is left out: the truth's manifest tells no poses; see --ray-origins",
        ),
    ];
    reasons.iter().filter(|(is_taken, _)| !is_taken).map(|(_, why)| (*why).to_owned()).collect()
}
