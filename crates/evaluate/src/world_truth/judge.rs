//! Labels of one keyframe against what is exactly known.

use occlabel_core::{ClassId, Fault, VoxelGrid, VoxelTruth};
use occlabel_occlusion::{Eye, OcclusionSettings};
use rayon::prelude::*;

use super::camera::{ExactView, exact_view};
use super::door::check;
use super::objects::objects;
use super::people::{is_of_people, speed_errors};
use super::scale::Scale;
use super::tally::{Question, Ring, Size, Tally};

/// How many rays have to end in a voxel until its label may be asked for.
const OBSERVABLE_ENDS: u32 = 5;

/// The largest solid share of a voxel that may be called free.
const FREE_SOLID: f32 = 0.05;

/// The labels of one keyframe, as `labels.npz` and `evidence.npz` hold them (labels.md section 11).
#[derive(Clone, Copy, Debug)]
pub struct JudgedLabels<'a> {
    /// The class where occupied, the scale's `free` elsewhere.
    pub semantics: &'a VoxelGrid<u8>,
    /// Not 0 where observed.
    pub mask_lidar: &'a VoxelGrid<u8>,
    /// Not 0 where some camera sees it and it is observed.
    pub mask_camera: &'a VoxelGrid<u8>,
    /// Velocity in the grid frame, metres per second; none if there is no evidence file.
    pub flow: Option<&'a VoxelGrid<[f32; 3]>>,
}

/// What is exactly known of a keyframe.
#[derive(Clone, Copy, Debug)]
pub struct KnownWorld<'a> {
    /// The scene's name, which tells its objects from those of other scenes.
    pub scene: &'a str,
    /// The truth of each voxel.
    pub truth: &'a VoxelGrid<VoxelTruth>,
    /// The keyframe's cameras where they truly stood; without any, camera masks are not judged.
    pub eyes: &'a [Eye<'a>],
    /// The occluders and depth that the labels were made with; none leaves A6c out, whose rays
    /// through every pixel cost more than all other figures together.
    pub occlusion: Option<&'a OcclusionSettings>,
}

/// Counts how right the labels of a keyframe are. Parallel over slices of the grid.
///
/// # Errors
/// If a grid has not the scale's shape, or labels or truth hold a class that the scale does not name.
pub fn judge(labels: &JudgedLabels, known: &KnownWorld, scale: &Scale) -> Result<Tally, Fault> {
    check(labels, known, scale)?;
    let bench = Bench {
        labels,
        truth: known.truth.values(),
        camera: exact_view(known, scale),
        has_sight: !known.eyes.is_empty() && known.truth.values().iter().any(|t| t.sight != 0),
        has_ends: known.truth.values().iter().any(|truth| truth.camera_ends > 0),
        scale,
    };
    let mut rings = bench.rings();
    for (ring, class, error_mps) in speed_errors(labels, known, scale) {
        rings[ring].measure(Size::PeopleSpeedError, Some(class), error_mps);
    }
    Ok(Tally::of_keyframe(scale, rings, objects(labels, known, scale)))
}

/// Everything that a voxel's judgement needs.
struct Bench<'a> {
    labels: &'a JudgedLabels<'a>,
    truth: &'a [VoxelTruth],
    camera: Option<ExactView>,
    has_sight: bool,
    has_ends: bool,
    scale: &'a Scale,
}

/// A voxel's label beside its truth.
struct Pair<'a> {
    truth: &'a VoxelTruth,
    /// The class it is labelled occupied with.
    label: Option<ClassId>,
    is_observed: bool,
    is_camera_seen: bool,
}

impl Pair<'_> {
    fn is_labelled_free(&self) -> bool {
        self.label.is_none() && self.is_observed
    }

    fn is_true_positive(&self) -> bool {
        self.label.is_some() && self.truth.solid > 0.0
    }
}

impl Bench<'_> {
    fn rings(&self) -> Vec<Ring> {
        let empty = || vec![Ring::new(self.scale.classes.len()); self.scale.ring_m.len() + 1];
        let slices = 0..self.scale.spec.shape()[0];
        slices
            .into_par_iter()
            .fold(empty, |mut rings, x| {
                self.slice(x, &mut rings);
                rings
            })
            .reduce(empty, |mut sum, rings| {
                sum.iter_mut().zip(&rings).for_each(|(sum, ring)| sum.add(ring));
                sum
            })
    }

    fn slice(&self, x: usize, rings: &mut [Ring]) {
        let [_, ny, nz] = self.scale.spec.shape();
        for y in 0..ny {
            let ring = &mut rings[self.scale.ring(x, y)];
            let column = (x * ny + y) * nz;
            (column..column + nz).for_each(|flat| self.voxel(flat, ring));
        }
    }

    fn voxel(&self, flat: usize, ring: &mut Ring) {
        let pair = self.pair(flat);
        self.occupied(&pair, ring);
        self.people(&pair, ring);
        surface(&pair, ring);
        class(&pair, ring);
        air(&pair, ring);
        self.masks(flat, &pair, ring);
        self.in_view(flat, &pair, ring);
        if let Some(flow) = self.labels.flow {
            motion(&pair, flow.values()[flat], ring);
        }
    }

    fn pair(&self, flat: usize) -> Pair<'_> {
        let class = self.labels.semantics.values()[flat];
        Pair {
            truth: &self.truth[flat],
            label: (class != self.scale.free).then_some(ClassId(class)),
            is_observed: self.labels.mask_lidar.values()[flat] != 0,
            is_camera_seen: self.labels.mask_camera.values()[flat] != 0,
        }
    }

    /// A1 and A7, by the label's class.
    fn occupied(&self, pair: &Pair, ring: &mut Ring) {
        if pair.label.is_none() {
            return;
        }
        let (truth, is_right) = (pair.truth, pair.truth.solid > 0.0);
        ring.count(Question::OccupiedPrecision, pair.label, is_right);
        ring.measure(Size::OccupiedDistance, pair.label, truth.surface_distance.into());
        if self.scale.noise_sigma_m > 0.0 {
            let reach = self.scale.noise_reach();
            let is_near = truth.clearance.is_some_and(|gap| f64::from(gap) <= reach);
            ring.count(Question::OccupiedPrecisionNoise, pair.label, is_right || is_near);
        }
    }

    /// PI, seen or not.
    fn people(&self, pair: &Pair, ring: &mut Ring) {
        let deformable = &self.scale.deformable;
        let is_labelled = pair.label.is_some_and(|class| deformable.contains(class));
        ring.overlap(Question::People, is_labelled, is_of_people(pair.truth, deformable));
    }

    /// A6, A6c and A6g. Both camera masks leave out what the labels call unobserved.
    fn masks(&self, flat: usize, pair: &Pair, ring: &mut Ring) {
        let is_visible = pair.truth.ends > 0 || pair.truth.crossed;
        ring.overlap(Question::MaskLidar, pair.is_observed, is_visible);
        if let Some(camera) = &self.camera {
            let is_seen = camera.by_pixels[flat] && pair.is_observed;
            ring.overlap(Question::MaskCamera, pair.is_camera_seen, is_seen);
        }
        if self.has_sight {
            let is_seen = pair.truth.sight != 0 && pair.is_observed;
            ring.overlap(Question::MaskCameraSight, pair.is_camera_seen, is_seen);
        }
    }

    /// A10: what is labelled occupied where cameras look, and what they see well enough to ask for.
    fn in_view(&self, flat: usize, pair: &Pair, ring: &mut Ring) {
        let Some(camera) = self.camera.as_ref().filter(|_| self.has_ends) else { return };
        let is_asked = pair.truth.solid > 0.0 && pair.truth.camera_ends >= OBSERVABLE_ENDS;
        if camera.by_rule[flat] && (is_asked || pair.label.is_some()) {
            ring.count(Question::OccupiedCamera, None, pair.is_true_positive());
        }
    }
}

/// A2, and the true surface's own A7, by the true class.
fn surface(pair: &Pair, ring: &mut Ring) {
    let (truth, is_occupied) = (pair.truth, pair.label.is_some());
    if truth.solid > 0.0 && truth.ends >= OBSERVABLE_ENDS {
        ring.count(Question::SurfaceRecall, truth.class, is_occupied);
    }
    if truth.solid > 0.0 && truth.dense_ends >= OBSERVABLE_ENDS {
        ring.count(Question::SurfaceRecallDense, truth.class, is_occupied);
    }
    if truth.surface {
        ring.measure(Size::SurfaceDistance, truth.class, truth.surface_distance.into());
    }
}

/// A5, by the true class.
fn class(pair: &Pair, ring: &mut Ring) {
    let (Some(label), Some(class), true) = (pair.label, pair.truth.class, pair.is_true_positive())
    else {
        return;
    };
    let is_right = label == class;
    let is_present = pair.truth.classes.contains(label);
    ring.count(Question::ClassAccuracy, Some(class), is_right);
    ring.count(Question::ClassPresent, Some(class), is_right || is_present);
    if let Some(hit) = pair.truth.hit_class {
        ring.count(Question::ClassHit, Some(hit), label == hit);
    }
}

/// A3, A4 and A8.
fn air(pair: &Pair, ring: &mut Ring) {
    let (truth, is_free) = (pair.truth, pair.is_labelled_free());
    if is_free {
        ring.count(Question::FreePurity, None, truth.solid < FREE_SOLID);
        ring.count(Question::FreePurityStrict, None, truth.solid == 0.0);
    }
    if truth.crossed && truth.solid == 0.0 {
        ring.count(Question::FreeRecall, None, is_free);
    }
    if truth.swept {
        ring.count(Question::TrailRate, None, pair.label.is_some());
    }
}

/// Flow, by the true class.
fn motion(pair: &Pair, flow: [f32; 3], ring: &mut Ring) {
    let (truth, class) = (pair.truth, pair.truth.class);
    if !pair.is_true_positive() {
        return;
    }
    if truth.instance.is_none() {
        ring.count(Question::StaticFlow, class, flow != [0.0; 3]);
    } else if truth.flow.iter().all(|v| v.is_finite()) {
        let is_missing = flow.iter().any(|v| !v.is_finite());
        ring.count(Question::FlowMissing, class, is_missing);
        if !is_missing {
            let error_mps = distance(flow, truth.flow);
            ring.measure(Size::FlowError, class, error_mps);
            if pair.label == class {
                ring.measure(Size::FlowErrorRightClass, class, error_mps);
            }
        }
    }
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    let way: [f64; 3] = std::array::from_fn(|axis| f64::from(a[axis]) - f64::from(b[axis]));
    (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt()
}
