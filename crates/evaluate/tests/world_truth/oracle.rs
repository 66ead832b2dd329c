//! The definitions of `docs/quality.md`, one line each, against the judge.

use occlabel_core::{ClassId, VoxelTruth};

use crate::sums::{Dice, block};
use crate::support::*;

type Pair = (Label, VoxelTruth);
/// Name, the voxels that are asked, and those of them that are right.
type Definition = (&'static str, fn(&Pair) -> bool, fn(&Pair) -> bool);

fn is_occupied((label, _): &Pair) -> bool {
    label.semantics != FREE
}

fn is_free((label, _): &Pair) -> bool {
    label.semantics == FREE && label.is_observed
}

fn is_right(pair: &Pair) -> bool {
    is_occupied(pair) && pair.1.solid > 0.0
}

fn is_met(pair: &Pair) -> bool {
    is_right(pair) && pair.1.hit_class.is_some()
}

fn is_moving(pair: &Pair) -> bool {
    is_right(pair) && pair.1.instance.is_some()
}

fn is_still(pair: &Pair) -> bool {
    is_right(pair) && pair.1.instance.is_none()
}

fn is_visible((_, truth): &Pair) -> bool {
    truth.ends > 0 || truth.crossed
}

const DEFINITIONS: [Definition; 12] = [
    ("occupied_precision", is_occupied, |(_, t)| t.solid > 0.0),
    ("surface_recall", |(_, t)| t.solid > 0.0 && t.ends >= 5, is_occupied),
    ("surface_recall_dense", |(_, t)| t.solid > 0.0 && t.dense_ends >= 5, is_occupied),
    ("free_purity", is_free, |(_, t)| t.solid < 0.05),
    ("free_purity_strict", is_free, |(_, t)| t.solid == 0.0),
    ("free_recall", |(_, t)| t.crossed && t.solid == 0.0, is_free),
    ("class_accuracy", is_right, |(l, t)| t.class.map(|class| class.0) == Some(l.semantics)),
    ("class_hit", is_met, |(l, t)| t.hit_class == Some(ClassId(l.semantics))),
    ("class_present", is_right, |(l, t)| t.classes.contains(ClassId(l.semantics))),
    ("trail_rate", |(_, t)| t.swept, is_occupied),
    ("flow_missing", is_moving, |(l, _)| l.flow[0].is_nan()),
    ("static_flow", is_still, |(l, _)| l.flow != [0.0; 3]),
];

#[test]
fn every_ratio_is_its_definition() {
    let (scale, mut dice) = (block(), Dice(5));
    let pairs: Vec<Pair> = (0..scale.spec.len()).map(|_| (dice.label(), dice.truth())).collect();
    let quality = tally("block", &pairs, &scale).quality();
    for (name, is_asked, is_so) in DEFINITIONS {
        let asked: Vec<&Pair> = pairs.iter().filter(|pair| is_asked(pair)).collect();
        let right = asked.iter().filter(|pair| is_so(pair)).count();
        assert!(right > 3 && right < asked.len() - 3, "{name}: {right} of {}", asked.len());
        let ratio = right as f64 / asked.len() as f64;
        assert_eq!(all(&quality, name), (Some(ratio), asked.len() as u64), "{name}");
    }
}

#[test]
fn the_lidar_masks_overlap_by_its_definition() {
    let (scale, mut dice) = (block(), Dice(6));
    let pairs: Vec<Pair> = (0..scale.spec.len()).map(|_| (dice.label(), dice.truth())).collect();
    let both = pairs.iter().filter(|p| p.0.is_observed && is_visible(p)).count();
    let either = pairs.iter().filter(|p| p.0.is_observed || is_visible(p)).count();
    let quality = tally("block", &pairs, &scale).quality();
    let expected = (Some(both as f64 / either as f64), either as u64);
    assert!(both > 50 && either > both + 50);
    assert_eq!(all(&quality, "mask_lidar_iou"), expected);
}
