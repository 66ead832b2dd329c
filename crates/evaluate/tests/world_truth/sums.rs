//! Tallies add up, and perfect labels are perfect, on random worlds.

use crate::support::*;
use occlabel_core::{ClassId, GridSpec, VoxelTruth};
use occlabel_evaluate::{Limits, Scale, Tally};

/// A small generator of whole numbers, the same everywhere (Marsaglia 2003).
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % sides
    }

    pub(crate) fn truth(&mut self) -> VoxelTruth {
        let truth = match self.roll(4) {
            0 => surface([ROAD, WALL][self.roll(2) as usize]),
            1 => mover(1 + self.roll(3) as u16, [2.0, self.roll(9) as f32, 0.0]),
            2 => VoxelTruth { swept: self.roll(3) == 0, ..air() },
            _ => VoxelTruth { surface_distance: 1.0, ..VoxelTruth::default() },
        };
        let is_kerb = truth.solid > 0.0 && self.roll(3) == 0;
        let solid = if self.roll(3) == 0 { truth.solid * 0.05 } else { truth.solid };
        let mut classes = truth.classes;
        if is_kerb {
            classes.insert(ClassId(ROAD));
        }
        let ends = truth.ends * self.roll(2) as u32;
        VoxelTruth { solid, classes, ends, dense_ends: truth.ends, ..truth }
    }

    pub(crate) fn label(&mut self) -> Label {
        match self.roll(3) {
            0 => UNOBSERVED,
            1 => EMPTY,
            _ => {
                moving(self.roll(3) as u8, [[0.0, 2.0, f32::NAN][self.roll(3) as usize], 0.0, 0.0])
            }
        }
    }
}

pub(crate) fn block() -> Scale {
    scale(GridSpec::new([-24.0, -24.0, 0.0], [24.0, 24.0, 8.0], [2.0; 3]).unwrap())
}

/// What labels without a fault say.
fn perfect(truth: &VoxelTruth) -> Label {
    match truth.class {
        Some(class) if truth.dense_ends > 0 => moving(class.0, truth.flow),
        _ if truth.crossed => EMPTY,
        _ => UNOBSERVED,
    }
}

fn random_tally(seed: u64) -> Tally {
    let scale = block();
    let mut dice = Dice(seed);
    let pairs: Vec<_> = (0..scale.spec.len()).map(|_| (dice.label(), dice.truth())).collect();
    tally(["north", "south"][seed as usize % 2], &pairs, &scale)
}

#[test]
fn tallies_add_up_the_same_in_any_order() {
    let forward: Tally = (1..=6).map(random_tally).sum();
    let backward: Tally = (1..=6).rev().map(random_tally).sum();
    let halves = (1..=3).map(random_tally).sum::<Tally>();
    let mut joined: Tally = (4..=6).map(random_tally).sum();
    joined += halves;
    assert_eq!(forward, backward);
    assert_eq!(forward, joined);
    let quality = forward.quality();
    assert_eq!(quality.keyframes, 6);
    assert_eq!(all(&quality, "object_completeness").1, 6, "three tracks in each of two scenes");
    assert!(all(&quality, "occupied_precision").1 > 500);
}

#[test]
fn threads_change_nothing() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| random_tally(7))
    };
    assert_eq!(on(1), on(2));
    assert_eq!(on(1), on(5));
}

#[test]
fn rings_and_classes_hold_each_voxel_once() {
    let quality = random_tally(3).quality();
    let count = |name: &str| {
        let rings: u64 = quality.by_ring.iter().map(|r| figure(&r.figures, name).1).sum();
        let classes: u64 = quality.by_class.iter().map(|c| figure(&c.figures, name).1).sum();
        (rings, classes)
    };
    for name in ["occupied_precision", "surface_recall", "class_hit", "flow_error_mps"] {
        let (_, expected) = all(&quality, name);
        assert!(expected > 50, "{name} {expected}");
        assert_eq!(count(name), (expected, expected), "{name}");
    }
}

#[test]
fn perfect_labels_reach_every_limit() {
    let (scale, mut dice) = (block(), Dice(11));
    let truth: Vec<_> = (0..scale.spec.len())
        .map(|_| dice.truth())
        .map(|truth| VoxelTruth { ends: truth.dense_ends, ..truth })
        .collect();
    let pairs: Vec<_> = truth.into_iter().map(|truth| (perfect(&truth), truth)).collect();
    let quality = tally("block", &pairs, &scale).quality();
    let mut exercised = 0;
    for name in RATIOS {
        let (value, count) = all(&quality, name);
        assert_eq!(value, Some(1.0), "{name}");
        assert!(
            count > 30 || name.starts_with("object") || name.ends_with("mean"),
            "{name} {count}"
        );
        exercised += 1;
    }
    for name in ["trail_rate", "flow_error_mps", "flow_missing", "static_flow"] {
        assert_eq!(all(&quality, name).0, Some(0.0), "{name}");
        exercised += 1;
    }
    assert_eq!(exercised, 14);
    let missed: Vec<_> = Limits::precise().misses(&quality);
    assert_eq!(missed.len(), 1, "only A6c, without a camera: {missed:?}");
}

const RATIOS: [&str; 10] = [
    "occupied_precision",
    "surface_recall",
    "surface_recall_dense",
    "free_purity",
    "free_purity_strict",
    "free_recall",
    "class_accuracy",
    "class_accuracy_mean",
    "mask_lidar_iou",
    "object_completeness",
];
