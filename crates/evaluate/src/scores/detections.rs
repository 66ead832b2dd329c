//! Objects of a keyframe as detections: a centre and a velocity.

use std::collections::BTreeMap;

use occlabel_core::GridSpec;

use super::scorer::{ScoredLabels, ScoredPair};

/// An instance's centre and velocity, horizontal: means over its voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Detection {
    pub(crate) centre_m: [f64; 2],
    pub(crate) velocity_mps: [f64; 2],
}

/// Sums over an instance's voxels, in flat order.
#[derive(Default)]
struct Sums {
    centre_m: [f64; 2],
    velocity_mps: [f64; 2],
    voxels: f64,
    /// Voxels whose velocity is a number.
    moving: f64,
}

/// The instances of a class within the mask, in order of their number; none without an instance or
/// a velocity.
pub(crate) fn detections(
    labels: &ScoredLabels,
    pair: &ScoredPair,
    class: u8,
    spec: &GridSpec,
) -> Vec<Detection> {
    let (Some(instances), Some(flow)) = (labels.instances, labels.flow) else {
        return Vec::new();
    };
    let mut sums: BTreeMap<u16, Sums> = BTreeMap::new();
    let voxels = labels.semantics.values().iter().zip(instances.values()).enumerate();
    for (at, (&found, &instance)) in voxels {
        if found == class && instance != 0 && pair.asks(at) {
            let centre = spec.centre(spec.voxel_at(at));
            let sums = sums.entry(instance).or_default();
            sums.add([centre.x, centre.y], flow.values()[at]);
        }
    }
    sums.values().filter_map(Sums::detection).collect()
}

/// Pairs of a true and a predicted detection, nearest first, each at most once; ties by place in the
/// lists, truth first.
pub(crate) fn matches(
    truth: &[Detection],
    prediction: &[Detection],
    within_m: f64,
) -> Vec<(usize, usize)> {
    let mut near: Vec<(f64, usize, usize)> = Vec::new();
    for (t, true_one) in truth.iter().enumerate() {
        for (p, predicted) in prediction.iter().enumerate() {
            let distance_m = distance(true_one.centre_m, predicted.centre_m);
            if distance_m <= within_m {
                near.push((distance_m, t, p));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut taken_truth, mut taken) = (vec![false; truth.len()], vec![false; prediction.len()]);
    near.retain(|&(_, t, p)| {
        let is_new = !taken_truth[t] && !taken[p];
        (taken_truth[t], taken[p]) = (taken_truth[t] || is_new, taken[p] || is_new);
        is_new
    });
    near.into_iter().map(|(_, t, p)| (t, p)).collect()
}

/// The length of the difference of two horizontal vectors.
pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [a[0] - b[0], a[1] - b[1]];
    (x * x + y * y).sqrt()
}

impl Sums {
    fn add(&mut self, centre_m: [f64; 2], velocity_mps: [f32; 3]) {
        let is_known = velocity_mps[0].is_finite() && velocity_mps[1].is_finite();
        for axis in 0..2 {
            self.centre_m[axis] += centre_m[axis];
            if is_known {
                self.velocity_mps[axis] += f64::from(velocity_mps[axis]);
            }
        }
        self.voxels += 1.0;
        self.moving += f64::from(u8::from(is_known));
    }

    fn detection(&self) -> Option<Detection> {
        (self.moving > 0.0).then(|| Detection {
            centre_m: self.centre_m.map(|sum| sum / self.voxels),
            velocity_mps: self.velocity_mps.map(|sum| sum / self.moving),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Detection {
        Detection { centre_m: [x, 0.0], velocity_mps: [0.0; 2] }
    }

    #[test]
    fn the_nearest_pair_is_matched_first() {
        let pairs = matches(&[at(0.0), at(1.5)], &[at(1.0), at(-1.9)], 2.0);
        assert_eq!(pairs, [(1, 0), (0, 1)]);
    }

    #[test]
    fn what_is_too_far_is_no_match_and_a_tie_goes_to_the_first() {
        assert_eq!(matches(&[at(0.0)], &[at(2.1)], 2.0), []);
        assert_eq!(matches(&[at(0.0)], &[at(2.0), at(-2.0)], 2.0), [(0, 0)]);
    }
}
