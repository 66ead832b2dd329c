//! The scores against small statements of their formulas: `vectors/scores.py`.

use occlabel_core::{ClassId, ClassSet, GridSpec, VoxelGrid};
use occlabel_evaluate::scores::{
    Metrics, ScoreTally, ScoredLabels, ScoredPair, Scorer, ScoringRules,
};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
struct Case {
    rules: Rules,
    frames: Vec<Frame>,
    expected: Value,
}

#[derive(Deserialize)]
struct Rules {
    classes: Vec<String>,
    ignored: Vec<u8>,
    things: Vec<u8>,
    flow_classes: Vec<u8>,
    min_m: [f64; 3],
    shape: [usize; 3],
    size_m: [f64; 3],
    ring_m: Vec<f64>,
    f_threshold_m: f64,
    detection_m: f64,
    min_segment_voxels: u64,
}

#[derive(Deserialize)]
struct Frame {
    truth: Vec<u8>,
    prediction: Vec<u8>,
    mask: Vec<u8>,
    truth_instances: Vec<u16>,
    prediction_instances: Vec<u16>,
    truth_flow: Vec<[Option<f32>; 3]>,
    prediction_flow: Vec<[Option<f32>; 3]>,
}

const ALL: Metrics = Metrics {
    semantic: true,
    f_score: true,
    panoptic: true,
    velocity: true,
    rays: false,
    ray_panoptic: false,
    ray_flow: false,
};

/// How far a number may be from what the statement gives, relative to one or to itself.
const TOLERANCE: f64 = 1e-9;

impl Rules {
    fn scoring(&self) -> ScoringRules {
        let max_m = std::array::from_fn(|i| self.min_m[i] + self.shape[i] as f64 * self.size_m[i]);
        let set = |ids: &[u8]| -> ClassSet { ids.iter().map(|&id| ClassId(id)).collect() };
        ScoringRules {
            ignored: set(&self.ignored),
            things: set(&self.things),
            flow_classes: set(&self.flow_classes),
            ring_m: self.ring_m.clone(),
            f_threshold_m: self.f_threshold_m,
            detection_m: self.detection_m,
            min_segment_voxels: self.min_segment_voxels,
            ..ScoringRules::new(
                GridSpec::new(self.min_m, max_m, self.size_m).unwrap(),
                self.classes.clone(),
            )
        }
    }
}

impl Frame {
    fn score(&self, scorer: &Scorer) -> ScoreTally {
        let spec = &scorer.rules().spec;
        let bytes = |ids: &[u8]| VoxelGrid::from_values(spec, ids.to_vec());
        let numbers = |ids: &[u16]| VoxelGrid::from_values(spec, ids.to_vec());
        let flow = |mps: &[[Option<f32>; 3]]| {
            let known = mps.iter().map(|v| v.map(|x| x.unwrap_or(f32::NAN))).collect();
            VoxelGrid::from_values(spec, known)
        };
        let (truth, prediction) = (bytes(&self.truth), bytes(&self.prediction));
        let instances = [numbers(&self.truth_instances), numbers(&self.prediction_instances)];
        let flow = [flow(&self.truth_flow), flow(&self.prediction_flow)];
        let labels = |semantics, side: usize| ScoredLabels {
            semantics,
            instances: Some(&instances[side]),
            flow: Some(&flow[side]),
        };
        let pair = ScoredPair {
            truth: labels(&truth, 0),
            prediction: labels(&prediction, 1),
            mask: Some(&bytes(&self.mask)),
            origins: &[],
        };
        scorer.score(&pair).unwrap()
    }
}

/// Compares what is expected, wherever it says something; returns how many numbers that were.
fn compare(place: &str, found: &Value, expected: &Value) -> usize {
    match expected {
        Value::Object(fields) => {
            let below = |(name, value): (&String, &Value)| {
                compare(&format!("{place}.{name}"), &found[name], value)
            };
            fields.iter().map(below).sum()
        }
        Value::Array(values) => {
            let found_len = found.as_array().map_or(0, Vec::len);
            assert_eq!(found_len, values.len(), "{place}: {found}");
            let below = |(at, value): (usize, &Value)| {
                compare(&format!("{place}[{at}]"), &found[at], value)
            };
            values.iter().enumerate().map(below).sum()
        }
        Value::Number(number) => {
            let expected = number.as_f64().unwrap();
            let found = found.as_f64().unwrap_or_else(|| panic!("{place}: {found}, {expected}"));
            let off = (found - expected).abs();
            assert!(off <= TOLERANCE * expected.abs().max(1.0), "{place}: {found}, {expected}");
            1
        }
        other => {
            assert_eq!((found, found.is_null()), (other, other.is_null()), "{place}");
            1
        }
    }
}

fn cases() -> Vec<Case> {
    serde_json::from_str(include_str!("vectors/scores.json")).unwrap()
}

#[test]
fn scores_are_those_of_their_statements() {
    let mut compared = 0;
    for (number, case) in cases().iter().enumerate() {
        let scorer = Scorer::new(case.rules.scoring(), ALL).unwrap();
        let tally: ScoreTally = case.frames.iter().map(|frame| frame.score(&scorer)).sum();
        let found = serde_json::to_value(tally.scores(scorer.rules())).unwrap();
        compared += compare(&format!("case {number}"), &found, &case.expected);
    }
    assert!(compared > 850, "{compared} numbers");
}

#[test]
fn the_order_of_keyframes_does_not_matter() {
    for case in cases() {
        let scorer = Scorer::new(case.rules.scoring(), ALL).unwrap();
        let tallies: Vec<_> = case.frames.iter().map(|frame| frame.score(&scorer)).collect();
        let forth: ScoreTally = tallies.iter().cloned().sum();
        let back: ScoreTally = tallies.into_iter().rev().sum();
        assert_eq!(forth, back);
        assert_eq!(forth.keyframes(), case.frames.len() as u64);
    }
}
