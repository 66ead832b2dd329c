//! What is counted of label files, before anything is made of it.

use std::ops::AddAssign;

use crate::describe::ground::{ColumnCounts, GroundLevels};
use crate::{ClassTable, Concepts, IGNORED, KeyframeLabels};

/// Counts of the voxels of keyframes, added up in any order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VoxelTally {
    /// How many keyframes were counted.
    pub keyframes: u64,
    /// Their voxels.
    pub voxels: u64,
    /// Voxels by what stands in `semantics`.
    pub by_index: Vec<u64>,
    /// Keyframes in which nothing is occupied.
    pub empty: u64,
    /// Keyframes in which all is occupied.
    pub full: u64,
    /// What the masks say; `None` if no keyframe has them.
    pub lidar: Option<LidarCounts>,
    /// Voxels that some camera sees; `None` if no keyframe says it.
    pub camera: Option<u64>,
    /// Where both masks are there: voxels that a camera sees and no lidar.
    pub camera_outside_lidar: u64,
    /// How the ground lies in its columns.
    pub columns: ColumnCounts,
    /// At which levels it lies near the origin.
    pub ground: GroundLevels,
}

/// What `mask_lidar` says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LidarCounts {
    /// Voxels observed.
    pub observed: u64,
    /// Voxels that are labelled free, and not observed.
    pub unobserved: u64,
    /// Voxels that are occupied but not observed.
    pub occupied_outside: u64,
    /// Those of them that are ground.
    pub flat_outside: u64,
}

impl VoxelTally {
    /// Nothing counted yet.
    pub fn new() -> Self {
        Self {
            keyframes: 0,
            voxels: 0,
            by_index: vec![0; 256],
            empty: 0,
            full: 0,
            lidar: None,
            camera: None,
            camera_outside_lidar: 0,
            columns: ColumnCounts::default(),
            ground: GroundLevels::default(),
        }
    }

    /// The counts of one keyframe.
    pub fn of(labels: &KeyframeLabels, classes: &ClassTable) -> Self {
        let flat = flat_classes(classes);
        let semantics = labels.semantics.values();
        let mut tally = Self { keyframes: 1, voxels: semantics.len() as u64, ..Self::new() };
        semantics.iter().for_each(|index| tally.by_index[usize::from(*index)] += 1);
        let (occupied, free) = (tally.occupied(classes), tally.free(classes));
        (tally.empty, tally.full) = (u64::from(occupied == 0), u64::from(free == 0));
        let lidar = labels.mask_lidar.as_ref().map(|mask| mask.values());
        let camera = labels.mask_camera.as_ref().map(|mask| mask.values());
        tally.lidar = lidar.map(|mask| LidarCounts::of(semantics, mask, classes, &flat));
        tally.camera = camera.map(|mask| count(mask.iter(), |seen| **seen != 0));
        if let (Some(lidar), Some(camera)) = (lidar, camera) {
            tally.camera_outside_lidar =
                count(lidar.iter().zip(camera), |(l, c)| **l == 0 && **c != 0);
        }
        tally.columns = ColumnCounts::of(&labels.semantics, classes, &flat);
        tally.ground = GroundLevels::of(&labels.spec, &labels.semantics, &flat);
        tally
    }

    /// Voxels of a class.
    pub fn occupied(&self, classes: &ClassTable) -> u64 {
        self.by_index[..classes.list.len()].iter().sum()
    }

    /// Voxels labelled as free, seen or not.
    pub fn free(&self, classes: &ClassTable) -> u64 {
        self.by_index[usize::from(classes.free_index())]
    }

    /// Voxels without a label.
    pub fn ignored(&self) -> u64 {
        self.by_index[usize::from(IGNORED)]
    }
}

impl Default for VoxelTally {
    fn default() -> Self {
        Self::new()
    }
}

impl AddAssign for VoxelTally {
    fn add_assign(&mut self, other: Self) {
        self.keyframes += other.keyframes;
        self.voxels += other.voxels;
        self.by_index.iter_mut().zip(&other.by_index).for_each(|(sum, more)| *sum += more);
        self.empty += other.empty;
        self.full += other.full;
        self.lidar = match (self.lidar, other.lidar) {
            (Some(one), Some(more)) => Some(one.plus(more)),
            (one, more) => one.or(more),
        };
        self.camera = match (self.camera, other.camera) {
            (Some(one), Some(more)) => Some(one + more),
            (one, more) => one.or(more),
        };
        self.camera_outside_lidar += other.camera_outside_lidar;
        self.columns += other.columns;
        self.ground += other.ground;
    }
}

impl LidarCounts {
    fn of(semantics: &[u8], mask: &[u8], classes: &ClassTable, flat: &[bool; 256]) -> Self {
        let (mut counts, free) = (Self::default(), classes.free_index());
        for (class, seen) in semantics.iter().zip(mask) {
            let (is_occupied, is_free) = (*class < free, *class == free);
            let is_outside = *seen == 0;
            counts.observed += u64::from(!is_outside);
            counts.unobserved += u64::from(is_outside & is_free);
            counts.occupied_outside += u64::from(is_outside & is_occupied);
            counts.flat_outside += u64::from(is_outside & flat[usize::from(*class)]);
        }
        counts
    }

    fn plus(self, more: Self) -> Self {
        Self {
            observed: self.observed + more.observed,
            unobserved: self.unobserved + more.unobserved,
            occupied_outside: self.occupied_outside + more.occupied_outside,
            flat_outside: self.flat_outside + more.flat_outside,
        }
    }
}

/// Which indices are classes of the ground.
pub(crate) fn flat_classes(classes: &ClassTable) -> [bool; 256] {
    let mut flat = [false; 256];
    for (at, class) in classes.list.iter().enumerate() {
        let concepts = Concepts::shipped();
        let concept = class.concept().unwrap_or_default();
        flat[at] = concept == GROUND || concepts.above(concept).any(|wider| wider == GROUND);
    }
    flat
}

/// The concept that all classes of the ground are under.
const GROUND: &str = "ground";

fn count<T>(items: impl Iterator<Item = T>, is: impl Fn(&T) -> bool) -> u64 {
    items.filter(is).count() as u64
}
