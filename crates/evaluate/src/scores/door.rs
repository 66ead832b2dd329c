//! What rules and grids have to be before anything is scored.

use occlabel_core::{Fault, VoxelGrid};

use super::rules::{ScoringRules, UNLABELLED};
use super::scorer::{Metrics, ScoredLabels, ScoredPair};

/// Checks that classes fit in ids, and that rings and distances are what they should be.
pub(super) fn check_rules(rules: &ScoringRules) -> Result<(), Fault> {
    let fault =
        |expected: &str, found: String| Fault::new("scoring-rules", "rules", expected, found);
    let classes = rules.classes.len();
    if classes == 0 || classes >= usize::from(UNLABELLED) {
        return Err(fault("1 to 254 classes", format!("{classes}")));
    }
    let from_zero: Vec<f64> = [0.0].iter().chain(&rules.ring_m).copied().collect();
    if !from_zero.is_sorted_by(|a, b| a < b) || from_zero.iter().any(|m| !m.is_finite()) {
        return Err(fault("rising radii of rings, above 0 m", format!("{:?}", rules.ring_m)));
    }
    for limit_m in [rules.f_threshold_m, rules.detection_m] {
        if !(limit_m.is_finite() && limit_m > 0.0) {
            return Err(fault("a threshold above 0 m", format!("{limit_m} m")));
        }
    }
    Ok(())
}

/// Checks shapes and ids, and that the arrays are there that the metrics need.
pub(super) fn check_pair(
    pair: &ScoredPair,
    rules: &ScoringRules,
    metrics: Metrics,
) -> Result<(), Fault> {
    check_labels("truth", &pair.truth, rules, metrics)?;
    check_labels("prediction", &pair.prediction, rules, metrics)?;
    match pair.mask {
        Some(mask) => check_shape("mask", mask.shape(), rules),
        None => Ok(()),
    }
}

fn check_labels(
    side: &str,
    labels: &ScoredLabels,
    rules: &ScoringRules,
    metrics: Metrics,
) -> Result<(), Fault> {
    check_shape(side, labels.semantics.shape(), rules)?;
    check_ids(side, labels.semantics.values(), rules)?;
    let instances = labels.instances.map(VoxelGrid::shape);
    let flow = labels.flow.map(VoxelGrid::shape);
    check_array(side, "instances", instances, metrics.panoptic || metrics.ray_panoptic, rules)?;
    check_array(side, "flow", flow, metrics.velocity || metrics.ray_flow, rules)
}

fn check_array(
    side: &str,
    name: &str,
    shape: Option<[usize; 3]>,
    is_needed: bool,
    rules: &ScoringRules,
) -> Result<(), Fault> {
    match shape {
        Some(shape) => check_shape(side, shape, rules),
        None if is_needed => {
            Err(Fault::new("scored-array", side, format!("an array `{name}`"), "none"))
        }
        None => Ok(()),
    }
}

fn check_shape(side: &str, found: [usize; 3], rules: &ScoringRules) -> Result<(), Fault> {
    let name = |[x, y, z]: [usize; 3]| format!("{x} x {y} x {z} voxels");
    match rules.spec.shape() {
        expected if expected == found => Ok(()),
        expected => Err(Fault::new("scored-shape", side, name(expected), name(found))),
    }
}

fn check_ids(side: &str, ids: &[u8], rules: &ScoringRules) -> Result<(), Fault> {
    // One more than the id, so that "no label" is the smallest.
    let highest = ids.iter().map(|id| id.wrapping_add(1)).max().unwrap_or(0);
    if highest <= rules.free() + 1 {
        return Ok(());
    }
    let expected = format!("class ids up to {} (free), or {UNLABELLED}", rules.free());
    Err(Fault::new("scored-class", side, expected, format!("id {}", highest - 1)))
}
