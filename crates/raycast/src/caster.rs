//! Rays into counts.
//!
//! ```text
//!   whole rays, 16 at a time --+-- end in the grid ------------> walked side by side at once
//!                              +-- end outside, may pass it --+
//!   parts of rays, one by one --------------------------------+-> wait until there are 16
//!   rays too long for 32 bits, or under rules that steps do not tell -> walked alone
//! ```

use std::ops::ControlFlow;

use occlabel_core::{
    GridSpec, Kernel, LATTICE, LatticePoint, Level, RayCounts, VoxelGrid, VoxelIndex, walk,
};

use crate::cells::Cell;
use crate::near::{NearRules, NearSteps, RayEnds};
use crate::walkers::{MOST_VOXELS, Walks, walk_lanes};
use crate::ways::{Batch, LANES, Lane, Ways, all, any, fits};
use crate::{Outside, RaySettings};

/// Longest way that is walked, lattice units along an axis: 2^20 voxels, the most that a configuration
/// lets a ray be (labels.md section 8).
const LONGEST: u64 = (LATTICE as u64) << 20;

/// A ray to cast: walked from `end` towards `origin`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Where the walk starts: the point, or the entry into its box.
    pub(crate) end: LatticePoint,
    /// Where the walk ends: the lidar, or the entry into the box.
    pub(crate) origin: LatticePoint,
    /// Whether the walk starts at the point itself and so hits its voxel.
    pub(crate) hits: bool,
    /// The true ends, for the near rules.
    pub(crate) ends: RayEnds,
}

impl Ray {
    /// A whole ray, from a point to its lidar.
    pub(crate) fn whole(end: LatticePoint, origin: LatticePoint, is_flat: bool) -> Self {
        let ends = RayEnds { point: end.voxel(), origin: origin.voxel(), is_flat };
        Self { end, origin, hits: true, ends }
    }

    /// Whether no lidar can have measured it. A track annotated at the end of the world has such rays,
    /// and would be walked to for minutes.
    fn is_longer_than_any(&self) -> bool {
        (0..3).any(|axis| self.end.0[axis].abs_diff(self.origin.0[axis]) > LONGEST)
    }
}

/// Counts of the rays cast so far.
pub(crate) struct Caster<'a, C> {
    spec: &'a GridSpec,
    level: Level,
    clips: bool,
    near: NearRules<'a>,
    /// The near rules, if there are any, told in steps of whole rays, if they can be.
    near_steps: Option<NearSteps>,
    shape: [i32; 3],
    strides: [i32; 3],
    hits: VoxelGrid<u32>,
    /// One for each voxel, and one that is nobody's.
    cells: Vec<C>,
    /// Rays that may begin or end outside the grid, until there are enough to cast.
    waiting: Batch,
    waiting_len: usize,
}

impl<'a, C: Cell> Caster<'a, C> {
    pub(crate) fn new(spec: &'a GridSpec, settings: &'a RaySettings, level: Level) -> Self {
        let near = NearRules::new(spec, settings);
        Self {
            spec,
            level,
            clips: settings.outside == Outside::Clip,
            near,
            near_steps: near.in_steps(),
            shape: spec.shape().map(|n| n as i32),
            strides: spec.strides().map(|n| n as i32),
            hits: VoxelGrid::filled(spec, 0),
            cells: vec![C::default(); spec.len() + 1],
            waiting: Batch::empty(),
            waiting_len: 0,
        }
    }

    /// The counts.
    pub(crate) fn into_counts(mut self) -> RayCounts {
        self.cast_waiting();
        self.cells.truncate(self.spec.len());
        // Of 32 bits each, they become crossings where they stand.
        let crossings = self.cells.into_iter().map(Cell::crossings).collect();
        RayCounts { hits: self.hits, crossings: VoxelGrid::from_values(self.spec, crossings) }
    }

    /// Forgets all crossings of a voxel by the rays cast so far.
    pub(crate) fn forget(&mut self, flats: impl Iterator<Item = usize>) {
        self.cast_waiting();
        flats.for_each(|flat| self.cells[flat] = C::default());
    }

    /// The instruction set to cast on.
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Whether rays that end outside the grid count.
    pub(crate) fn clips(&self) -> bool {
        self.clips
    }

    /// Whether whole rays can be cast in batches: the grid is not too large for it, and the near
    /// rules, if there are any, can be told in steps.
    pub(crate) fn takes_batches(&self) -> bool {
        let shape = self.spec.shape();
        (0..3).all(|axis| shape[axis] <= MOST_VOXELS[axis])
            && (self.near_steps.is_some() || !self.near.are_any())
    }

    /// Whether parts of rays can be cast in batches: no rule speaks of the whole rays' ends.
    pub(crate) fn takes_parts(&self) -> bool {
        self.takes_batches() && !self.near.are_any()
    }

    /// Whether it matters which rays end on the ground.
    pub(crate) fn asks_for_ground(&self) -> bool {
        self.near_steps.is_some()
    }

    /// Voxels along each axis.
    pub(crate) fn shape(&self) -> [i32; 3] {
        self.shape
    }

    /// Counts the hit of a point alone.
    pub(crate) fn hit(&mut self, voxel: VoxelIndex) {
        if let Some(flat) = self.spec.flat(voxel) {
            self.hits.values_mut()[flat] += 1;
        }
    }

    /// Counts a ray's hit and crossings.
    pub(crate) fn cast(&mut self, ray: &Ray) {
        if ray.hits {
            self.hit(ray.ends.point);
        }
        if !self.clips && self.spec.flat(ray.ends.point).is_none() {
            return;
        }
        if !self.takes_parts() || !fits(ray.end, ray.origin) {
            if ray.is_longer_than_any() {
                return;
            }
            return self.cast_alone(ray);
        }
        self.waiting.put(self.waiting_len, ray.end, ray.origin);
        self.waiting_len += 1;
        if self.waiting_len == LANES {
            self.level.run(CastWaiting(self));
        }
    }

    /// Counts a ray's crossings in the plain way.
    fn cast_alone(&mut self, ray: &Ray) {
        let (near, cells) = (self.near, &mut self.cells);
        let is_ruled = near.are_any();
        walk(self.spec, ray.end, ray.origin, |flat, voxel| {
            if !(is_ruled && near.forbid(voxel, &ray.ends)) {
                cells[flat].cross();
            }
            ControlFlow::Continue(())
        });
    }

    /// Counts the hits and crossings of whole rays.
    #[inline(always)]
    pub(crate) fn cast_batch(&mut self, batch: &mut Batch) {
        let inside = batch.ends_inside(self.shape);
        if !all(&inside) {
            self.put_aside(batch, &inside);
        }
        if !any(&inside) {
            return;
        }
        self.count_hits(batch, &inside);
        match self.near_steps {
            Some(near) => self.cast_inside::<true>(batch, Some(near)),
            None => self.cast_inside::<false>(batch, None),
        }
    }

    /// Counts the hits of rays alone.
    #[inline(always)]
    pub(crate) fn hit_batch(&mut self, batch: &Batch) {
        let inside = batch.ends_inside(self.shape);
        self.count_hits(batch, &inside);
    }

    #[inline(always)]
    fn count_hits(&mut self, batch: &Batch, inside: &Lane) {
        for lane in 0..LANES {
            if inside[lane] != 0 {
                self.hits.values_mut()[batch.end_flat(lane, self.strides)] += 1;
            }
        }
    }

    /// Takes those that end outside the grid out of a batch, to be cast later if they may tell
    /// anything.
    #[inline(always)]
    fn put_aside(&mut self, batch: &mut Batch, inside: &Lane) {
        let passing = batch.may_pass(self.shape);
        for lane in 0..LANES {
            if inside[lane] == 0 {
                if passing[lane] != 0 && self.clips {
                    self.wait(batch, lane);
                }
                batch.remove(lane);
            }
        }
    }

    #[inline(always)]
    fn wait(&mut self, batch: &Batch, lane: usize) {
        self.waiting.copy(self.waiting_len, batch, lane);
        self.waiting_len += 1;
        if self.waiting_len == LANES {
            self.cast_waiting();
        }
    }

    /// Counts the crossings of rays that end in the grid.
    #[inline(always)]
    fn cast_inside<const RULED: bool>(&mut self, batch: &Batch, near: Option<NearSteps>) {
        let ways = Ways::new(batch);
        let mut walks = Walks::new(&ways, [[0; LANES]; 3], self.shape);
        if let Some(near) = near {
            near.apply(&mut walks, &ways.faces, &batch.flat);
        }
        walk_lanes::<C, RULED>(&ways, walks, self.strides, &mut self.cells);
    }

    /// Counts the crossings of parts of rays that begin and end anywhere.
    #[inline(always)]
    pub(crate) fn cast_anywhere(&mut self, batch: &Batch) {
        if any(&batch.may_pass(self.shape)) {
            self.walk_anywhere(batch);
        }
    }

    #[inline(always)]
    fn cast_waiting(&mut self) {
        let waiting = std::mem::replace(&mut self.waiting, Batch::empty());
        self.waiting_len = 0;
        self.walk_anywhere(&waiting);
    }

    #[inline(always)]
    fn walk_anywhere(&mut self, batch: &Batch) {
        let ways = Ways::new(batch);
        let from = ways.faces_before(&ways.part_before_grid(self.shape));
        let mut walks = Walks::new(&ways, from, self.shape);
        if let Some(near) = self.near_steps {
            near.apply(&mut walks, &ways.faces, &batch.flat);
        }
        walk_lanes::<C, true>(&ways, walks, self.strides, &mut self.cells);
    }
}

/// Casts the waiting rays.
struct CastWaiting<'r, 'a, C>(&'r mut Caster<'a, C>);

impl<C: Cell> Kernel for CastWaiting<'_, '_, C> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.0.cast_waiting();
    }
}
