//! The segments of a keyframe, as its rays see them.

use std::collections::BTreeMap;

use occlabel_core::VoxelGrid;

use super::pairs::RayPair;

/// Segments of fewer rays are no errors if they have no match.
pub const MIN_RAYS: u64 = 10;
/// Segments match above this IoU; so no segment matches twice.
const MATCH_IOU: f64 = 0.5;

/// The classes and instances of a keyframe; instance 0 is none.
#[derive(Clone, Copy, Debug)]
pub struct InstanceGrids<'a> {
    /// Classes.
    pub semantics: &'a VoxelGrid<u8>,
    /// Instances.
    pub instances: &'a VoxelGrid<u16>,
}

/// A segment: its class, and its instance or 0.
type Segment = (u8, u16);

/// The segments of a keyframe: how many rays they have, and share within a threshold of depth.
pub(super) struct Frame {
    truth: BTreeMap<Segment, u64>,
    prediction: BTreeMap<Segment, u64>,
    /// Every ray that both segments of one class have, and how far its depths are apart, metres.
    both: Vec<(Segment, Segment, f64)>,
}

/// How segments of a class fare: matched with which IoU, or one of truth or prediction left over.
pub(super) enum Fate {
    Matched(f64),
    Missed,
    Invented,
}

impl Frame {
    pub(super) fn new(
        pairs: &[RayPair],
        truth: InstanceGrids,
        prediction: InstanceGrids,
        is_thing: impl Fn(u8) -> bool,
    ) -> Self {
        let mut frame = Self { truth: BTreeMap::new(), prediction: BTreeMap::new(), both: vec![] };
        let of_one_class = classes_of_instances(pairs, truth);
        for pair in pairs {
            let (class, instance) = truth.at(pair.truth.flat);
            let is_one = is_thing(class) && of_one_class.get(&instance) == Some(&Some(class));
            let true_segment = (class, if is_one { instance } else { 0 });
            *frame.truth.entry(true_segment).or_default() += 1;
            let Some(hit) = pair.prediction else { continue };
            let segment = prediction.at(hit.flat);
            *frame.prediction.entry(segment).or_default() += 1;
            if segment.0 == class {
                let error_m = (hit.depth_m - pair.truth.depth_m).abs();
                frame.both.push((true_segment, segment, error_m));
            }
        }
        frame
    }

    /// What becomes of the segments, with their classes, if depths may be so far apart, metres.
    pub(super) fn fates(&self, threshold_m: f64) -> Vec<(u8, Fate)> {
        let (mut truth, mut prediction) = (self.truth.clone(), self.prediction.clone());
        let mut fates = vec![];
        for ((one, other), shared) in self.shared(threshold_m) {
            let either = self.truth[&one] + self.prediction[&other] - shared;
            let iou = shared as f64 / either as f64;
            if iou > MATCH_IOU {
                truth.remove(&one);
                prediction.remove(&other);
                fates.push((one.0, Fate::Matched(iou)));
            }
        }
        let large = |(segment, rays): (Segment, u64)| (rays >= MIN_RAYS).then_some(segment.0);
        fates.extend(truth.into_iter().filter_map(large).map(|class| (class, Fate::Missed)));
        fates.extend(prediction.into_iter().filter_map(large).map(|class| (class, Fate::Invented)));
        fates
    }

    /// Rays that pairs of segments share.
    fn shared(&self, threshold_m: f64) -> BTreeMap<(Segment, Segment), u64> {
        let mut shared = BTreeMap::new();
        for (one, other, _) in self.both.iter().filter(|(_, _, error_m)| *error_m < threshold_m) {
            *shared.entry((*one, *other)).or_default() += 1;
        }
        shared
    }
}

impl InstanceGrids<'_> {
    fn at(&self, flat: u32) -> Segment {
        let flat = flat as usize;
        (self.semantics.values()[flat], self.instances.values()[flat])
    }
}

/// The class of each instance of the truth, as its rays see it; `None` if they see several. Instance 0
/// is left out.
fn classes_of_instances(pairs: &[RayPair], truth: InstanceGrids) -> BTreeMap<u16, Option<u8>> {
    let mut classes = BTreeMap::new();
    for pair in pairs {
        let (class, instance) = truth.at(pair.truth.flat);
        if instance != 0 {
            let seen = classes.entry(instance).or_insert(Some(class));
            *seen = seen.filter(|seen| *seen == class);
        }
    }
    classes
}
