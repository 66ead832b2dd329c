//! What looks wrong with label files: a named rule each, with its numbers.

use std::fmt;

use occlabel_core::GridSpec;
use serde::Serialize;

use crate::describe::{Examined, MotionCounts, VoxelTally, ids};
use crate::{ClassTable, Dialect, Layout};

/// Something that looks wrong.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Suspicion {
    /// The rule's name.
    pub rule: &'static str,
    /// How much of it there is.
    pub count: u64,
    /// Out of how much.
    pub of: u64,
    /// What it is.
    pub text: String,
}

impl fmt::Display for Suspicion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.rule, self.text)
    }
}

impl Suspicion {
    /// A suspicion, if there is anything of it.
    pub(crate) fn of(rule: &'static str, count: u64, of: u64, text: String) -> Option<Self> {
        (count > 0).then_some(Self { rule, count, of, text })
    }
}

/// What looks wrong with keyframes, taken for those of a dialect.
pub(crate) fn all(dialect: &Dialect, spec: &GridSpec, examined: &Examined) -> Vec<Suspicion> {
    let mut suspicions = of_files(dialect, examined);
    suspicions.extend(stretched(dialect, spec));
    let rules = [upside_down, outside_lidar, not_subset, empty, full];
    let of_voxels = rules.iter().filter_map(|rule| rule(&examined.tally, &dialect.classes));
    suspicions.extend(of_voxels);
    suspicions.extend(reversed(&examined.motion));
    suspicions
}

/// Published limits in so many voxels along an axis that these are of another form: axes may have
/// changed places.
fn stretched(dialect: &Dialect, spec: &GridSpec) -> Option<Suspicion> {
    let published = Dialect::named(&dialect.name).ok()?.grid.spec().ok()?;
    if (published.min_m(), published.max_m()) != (spec.min_m(), spec.max_m()) {
        return None;
    }
    let ratio = |axis: usize| spec.size_m()[axis] / published.size_m()[axis];
    let odd = (0..3).filter(|&axis| (ratio(axis) / ratio(0) - 1.0).abs() > 0.01).count() as u64;
    let ([x, y, z], size) = (spec.shape(), spec.size_m());
    let text = format!(
        "{x} x {y} x {z} voxels make them {} x {} x {} m: axes may have changed places",
        size.x, size.y, size.z
    );
    Suspicion::of("voxels-stretched", odd, 3, text)
}

fn of_files(dialect: &Dialect, examined: &Examined) -> Vec<Suspicion> {
    let is_dense = matches!(dialect.layout, Layout::Npz(_) | Layout::VoxelFiles(_));
    let all = Dialect::all();
    let free: Vec<(&str, u16)> =
        all.iter().map(|other| (other.name.as_str(), other.classes.free)).collect();
    let another = || ids::free_of_another(&examined.ids, &dialect.classes, &free);
    let masks = examined.odd_masks.iter().filter_map(mask_values);
    [
        refused(dialect, examined),
        ids::outside_classes(&examined.ids, &dialect.classes),
        is_dense.then(another).flatten(),
    ]
    .into_iter()
    .flatten()
    .chain(masks)
    .collect()
}

fn refused(dialect: &Dialect, examined: &Examined) -> Option<Suspicion> {
    let (_, why) = examined.first_refusal.as_ref()?;
    let (count, all) = (examined.refused, examined.refused + examined.tally.keyframes);
    let name = &dialect.name;
    let text = format!("{count} of {all} keyframes cannot be read as {name}; the first: {why}");
    Suspicion::of("unreadable", count, all, text)
}

fn mask_values((name, (count, all)): (&String, &(u64, u64))) -> Option<Suspicion> {
    let text = format!("{count} of {all} values of {name} are neither 0 nor 1");
    Suspicion::of("mask-values", *count, *all, text)
}

fn reversed(motion: &MotionCounts) -> Option<Suspicion> {
    let axis = motion.reversed_axis()?;
    let (asked, as_it_is, mirrored) = (motion.asked, motion.as_it_is, motion.mirrored[axis]);
    let text = format!(
        "of {asked} occupied voxels {as_it_is} are so at the next keyframe where the poses put them, \
         {mirrored} if {} is reversed",
        ["x", "y"][axis],
    );
    Suspicion::of("axis-reversed", mirrored, asked, text)
}

fn upside_down(tally: &VoxelTally, _: &ClassTable) -> Option<Suspicion> {
    let above = tally.columns.ground_above;
    let all = above + tally.columns.ground_below;
    let text = format!("the ground lies above what stands on it in {above} of {all} columns: z");
    tally.columns.is_upside_down().then(|| Suspicion::of("axis-reversed", above, all, text))?
}

fn outside_lidar(tally: &VoxelTally, classes: &ClassTable) -> Option<Suspicion> {
    let (lidar, occupied) = (tally.lidar?, tally.occupied(classes));
    let (count, flat) = (lidar.occupied_outside, lidar.flat_outside);
    let text = format!(
        "{count} of {occupied} occupied voxels are outside mask_lidar, {flat} of them ground"
    );
    Suspicion::of("occupied-outside-mask-lidar", count, occupied, text)
}

fn not_subset(tally: &VoxelTally, _: &ClassTable) -> Option<Suspicion> {
    let (count, camera) = (tally.camera_outside_lidar, tally.camera?);
    let text = format!("{count} of {camera} voxels of mask_camera are outside mask_lidar");
    Suspicion::of("mask-not-subset", count, camera, text)
}

fn empty(tally: &VoxelTally, _: &ClassTable) -> Option<Suspicion> {
    let text = format!("nothing is occupied in {} of {} keyframes", tally.empty, tally.keyframes);
    Suspicion::of("empty-grid", tally.empty, tally.keyframes, text)
}

fn full(tally: &VoxelTally, _: &ClassTable) -> Option<Suspicion> {
    let text = format!("nothing is free in {} of {} keyframes", tally.full, tally.keyframes);
    Suspicion::of("full-grid", tally.full, tally.keyframes, text)
}
