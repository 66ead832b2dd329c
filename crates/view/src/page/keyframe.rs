//! A keyframe as the page holds it.

use std::collections::{BTreeMap, BTreeSet};

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use occlabel_core::VoxelGrid;
use serde::Serialize;

use super::{counts, flow, planes};
use crate::{NO_LABEL, ShownEvidence, ShownKeyframe};

/// A keyframe with its arrays made small.
#[derive(Clone, Debug)]
pub struct PageKeyframe {
    pub(crate) about: About,
    arrays: Vec<PageArray>,
}

/// An array made small: deflated parts, behind their number and lengths.
#[derive(Clone, Debug)]
struct PageArray {
    name: &'static str,
    bytes: Vec<u8>,
}

/// What the page tells of a keyframe beside its arrays.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct About {
    token: String,
    /// Text, since a script's numbers hold no nanoseconds of an epoch.
    time_ns: Option<String>,
    /// x, y, z, and a quaternion x, y, z, w.
    world_from_grid: Option<[f64; 7]>,
    heading_rad: Option<f64>,
    min_m: [f64; 3],
    size_m: [f64; 3],
    shape: [usize; 3],
    /// The arrays that there are.
    arrays: Vec<&'static str>,
    /// The classes that occur.
    classes: BTreeSet<u8>,
    /// The largest hits and crossings.
    most: BTreeMap<&'static str, u16>,
}

impl PageKeyframe {
    /// Makes the arrays of a keyframe small. `free` is [`ShownScene::free`](crate::ShownScene::free).
    pub fn of(keyframe: &ShownKeyframe, free: u8) -> Self {
        let arrays = arrays(keyframe, free);
        Self { about: About::of(keyframe, &arrays, free), arrays }
    }

    /// How many bytes of the page each array takes.
    pub fn sizes(&self) -> impl Iterator<Item = (&'static str, usize)> {
        self.arrays.iter().map(|array| (array.name, array.bytes.len().div_ceil(3) * 4))
    }

    /// An array as text, by its name.
    pub(crate) fn texts(&self) -> impl Iterator<Item = (&'static str, String)> {
        self.arrays.iter().map(|array| (array.name, BASE64.encode(&array.bytes)))
    }
}

impl About {
    fn of(keyframe: &ShownKeyframe, arrays: &[PageArray], free: u8) -> Self {
        let spec = &keyframe.spec;
        let pose = keyframe.world_from_grid.map(|pose| {
            let ([x, y, z], q) = (pose.translation.vector.into(), pose.rotation.coords);
            [x, y, z, q.x, q.y, q.z, q.w]
        });
        Self {
            token: keyframe.token.clone(),
            time_ns: keyframe.time.map(|time| time.0.to_string()),
            world_from_grid: pose,
            heading_rad: keyframe.heading_rad,
            min_m: spec.min_m().into(),
            size_m: spec.size_m().into(),
            shape: spec.shape(),
            arrays: arrays.iter().map(|array| array.name).collect(),
            classes: classes(keyframe, free),
            most: keyframe.evidence.as_ref().map(most).unwrap_or_default(),
        }
    }
}

impl PageArray {
    fn new(name: &'static str, parts: &[Vec<u8>]) -> Self {
        let lengths = parts.iter().map(Vec::len);
        let head = std::iter::once(parts.len()).chain(lengths);
        let mut bytes: Vec<u8> = head.flat_map(|n| (n as u32).to_le_bytes()).collect();
        parts.iter().for_each(|part| bytes.extend(part));
        Self { name, bytes }
    }

    fn bytes(name: &'static str, grid: &VoxelGrid<u8>) -> Self {
        let values = grid.values();
        Self::new(name, &planes::encode(|flat| [values[flat]], values.len(), slab(grid.shape())))
    }

    fn numbers(name: &'static str, grid: &VoxelGrid<u16>) -> Self {
        let values = grid.values();
        let bytes = |flat: usize| values[flat].to_le_bytes();
        Self::new(name, &planes::encode(bytes, values.len(), slab(grid.shape())))
    }

    fn counts(name: &'static str, grid: &VoxelGrid<u16>, expected: impl Fn(usize) -> bool) -> Self {
        Self::new(name, &counts::encode(grid.values(), grid.shape(), expected))
    }
}

fn arrays(keyframe: &ShownKeyframe, free: u8) -> Vec<PageArray> {
    let mut arrays = vec![PageArray::bytes("semantics", &keyframe.semantics)];
    let masks = [("mask_lidar", &keyframe.mask_lidar), ("mask_camera", &keyframe.mask_camera)];
    for (name, mask) in masks {
        arrays.extend(mask.as_ref().map(|mask| PageArray::bytes(name, mask)));
    }
    arrays.extend(keyframe.instances.as_ref().map(|grid| PageArray::numbers("instances", grid)));
    let flow = keyframe.flow.as_ref();
    arrays.extend(flow.map(|flow| PageArray::new("flow", &flow::encode(flow.values()))));
    if let Some(evidence) = &keyframe.evidence {
        arrays.extend(evidence_arrays(keyframe, evidence, free));
    }
    arrays
}

/// Where voxels are occupied, there are hits; where they were observed, crossings.
fn evidence_arrays(keyframe: &ShownKeyframe, evidence: &ShownEvidence, free: u8) -> [PageArray; 3] {
    let semantics = keyframe.semantics.values();
    let occupied = |flat: usize| semantics[flat] != free && semantics[flat] != NO_LABEL;
    let mask = keyframe.mask_lidar.as_ref().map(VoxelGrid::values);
    let observed = |flat: usize| mask.is_some_and(|mask| mask[flat] != 0);
    [
        PageArray::numbers("camera_bits", &evidence.camera_bits),
        PageArray::counts("hits", &evidence.hits, occupied),
        PageArray::counts("crossings", &evidence.crossings, observed),
    ]
}

fn classes(keyframe: &ShownKeyframe, free: u8) -> BTreeSet<u8> {
    let mut occurs = [false; 256];
    keyframe.semantics.values().iter().for_each(|&class| occurs[usize::from(class)] = true);
    (0..NO_LABEL).filter(|&class| occurs[usize::from(class)] && class != free).collect()
}

fn most(evidence: &ShownEvidence) -> BTreeMap<&'static str, u16> {
    let counts = [("hits", &evidence.hits), ("crossings", &evidence.crossings)];
    let largest = |grid: &VoxelGrid<u16>| grid.values().iter().copied().max().unwrap_or(0);
    counts.map(|(name, grid)| (name, largest(grid))).into()
}

/// How many voxels share an x.
fn slab([_, ny, nz]: [usize; 3]) -> usize {
    ny * nz
}
