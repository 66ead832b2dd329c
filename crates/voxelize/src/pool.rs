//! Labels of larger voxels, from those of the voxels in them.
//!
//! The rule is that of the lower scales of SemanticKITTI as its users make them (LMSCNet, SSCBench's
//! `labels_downscale`): classes are counted, free and unobserved voxels compete only where there is
//! no class, and free goes before unobserved. Two things are ours: ties go by the taxonomy's
//! `priority`, and masks and evidence are pooled along.

use std::collections::BTreeMap;

use occlabel_core::{Blocks, Evidence, OccupancyLabels, VoxelState};

/// The labels of larger voxels: `rank[class]` decides ties, the lowest wins; `free` is written where
/// no voxel of a block is occupied.
///
/// A block is occupied if a voxel in it is, of the class that most of these have; else free if a voxel
/// in it is; else unobserved. A camera sees it that sees a voxel in it. Hits and crossings are summed,
/// saturating; the instance is the one that most voxels of the class have (ties: the lower; those
/// without do not compete), flow the mean of what flows among them.
pub fn pool(labels: &OccupancyLabels, blocks: &Blocks, free: u8, rank: &[u8]) -> OccupancyLabels {
    let class = blocks.map(|places| class_of(labels, places, rank));
    let states = blocks.map(|places| state_of(labels, places));
    let seen = blocks.map(|places| any(labels.mask_camera.values(), places));
    let evidence = labels.evidence.as_ref();
    OccupancyLabels {
        semantics: class.map(|class| class.unwrap_or(free)),
        mask_lidar: states.map(|state| u8::from(*state != VoxelState::Unobserved)),
        mask_camera: seen,
        states,
        evidence: evidence.map(|evidence| pool_evidence(labels, evidence, blocks, rank)),
    }
}

fn pool_evidence(
    labels: &OccupancyLabels,
    evidence: &Evidence,
    blocks: &Blocks,
    rank: &[u8],
) -> Evidence {
    let object = blocks.map(|places| object_of(labels, evidence, places, rank));
    Evidence {
        hits: blocks.map(|places| sum(evidence.hits.values(), places)),
        crossings: blocks.map(|places| sum(evidence.crossings.values(), places)),
        state: blocks.map(|places| state_of(labels, places) as u8),
        instances: object.map(|object| object.0),
        flow: object.map(|object| object.1),
        camera_bits: blocks.map(|places| {
            places.iter().fold(0, |bits, &at| bits | evidence.camera_bits.values()[at])
        }),
    }
}

fn is_occupied(labels: &OccupancyLabels, at: usize) -> bool {
    labels.states.values()[at] == VoxelState::Occupied
}

/// The class of most occupied voxels.
fn class_of(labels: &OccupancyLabels, places: &[usize], rank: &[u8]) -> Option<u8> {
    let occupied = places.iter().filter(|&&at| is_occupied(labels, at));
    let counts = counts(occupied.map(|&at| labels.semantics.values()[at]));
    let most = counts
        .into_iter()
        .min_by_key(|(class, count)| (std::cmp::Reverse(*count), rank[usize::from(*class)]));
    most.map(|(class, _)| class)
}

fn state_of(labels: &OccupancyLabels, places: &[usize]) -> VoxelState {
    let states = labels.states.values();
    let has = |state| places.iter().any(|&at| states[at] == state);
    match (has(VoxelState::Occupied), has(VoxelState::Free)) {
        (true, _) => VoxelState::Occupied,
        (false, true) => VoxelState::Free,
        (false, false) => VoxelState::Unobserved,
    }
}

/// The instance of most voxels of the block's class, and how they flow.
fn object_of(
    labels: &OccupancyLabels,
    evidence: &Evidence,
    places: &[usize],
    rank: &[u8],
) -> (u16, [f32; 3]) {
    let Some(class) = class_of(labels, places, rank) else { return (0, [0.0; 3]) };
    let instances = evidence.instances.values();
    let is_of = |at: usize| is_occupied(labels, at) && labels.semantics.values()[at] == class;
    let of_class = || places.iter().copied().filter(|&at| is_of(at) && instances[at] != 0);
    let counts = counts(of_class().map(|at| instances[at]));
    let most = counts.into_iter().min_by_key(|(id, count)| (std::cmp::Reverse(*count), *id));
    let Some((instance, _)) = most else { return (0, [0.0; 3]) };
    let flows = of_class().filter(|&at| instances[at] == instance);
    (instance, mean(flows.map(|at| evidence.flow.values()[at])))
}

/// The mean of what is known; unknown (NaN) if nothing is.
fn mean(flows: impl Iterator<Item = [f32; 3]>) -> [f32; 3] {
    let (mut sum, mut count) = ([0.0_f64; 3], 0);
    for flow in flows.filter(|flow| flow.iter().all(|v| v.is_finite())) {
        (0..3).for_each(|axis| sum[axis] += f64::from(flow[axis]));
        count += 1;
    }
    sum.map(|sum| if count > 0 { (sum / f64::from(count)) as f32 } else { f32::NAN })
}

fn counts<T: Ord>(values: impl Iterator<Item = T>) -> BTreeMap<T, u32> {
    let mut counts = BTreeMap::new();
    values.for_each(|value| *counts.entry(value).or_default() += 1);
    counts
}

fn any(mask: &[u8], places: &[usize]) -> u8 {
    u8::from(places.iter().any(|&at| mask[at] != 0))
}

fn sum(counts: &[u16], places: &[usize]) -> u16 {
    places.iter().fold(0, |sum, &at| sum.saturating_add(counts[at]))
}
