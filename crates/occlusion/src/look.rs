//! What one camera has seen so far.

use std::ops::{ControlFlow, Range};

use nalgebra::Point3;
use occlabel_core::{GridSpec, LATTICE, LatticePoint, VoxelIndex, walk, walk_after};

use crate::bit_columns::BitColumns;

/// Shapes up to this along each axis keep the sums of bundled rays within 63 bits.
const LARGEST: usize = 1 << 18;

/// One camera's view so far.
///
/// Of the seen voxels, those that let rays pass and those that end them are kept apart: where all
/// that a ray may meet is `open`, the ray goes on and changes nothing; where all is `shut`, it ends
/// and changes nothing.
pub(crate) struct Look<'a> {
    pub(crate) spec: &'a GridSpec,
    /// Where the rays start.
    pub(crate) start: LatticePoint,
    /// Voxels that end rays, never the camera's own.
    blocks: BitColumns,
    /// Seen, and rays pass. The camera's own voxel counts as seen.
    pub(crate) open: BitColumns,
    /// Seen, and rays end.
    pub(crate) shut: BitColumns,
    /// Whether the camera's own voxel was seen indeed.
    has_looked: bool,
}

impl<'a> Look<'a> {
    /// A camera that has not looked yet. `blocks` are the voxels that end rays.
    pub(crate) fn new(spec: &'a GridSpec, at: &Point3<f64>, blocks: &BitColumns) -> Self {
        let start = spec.snap(at);
        let nothing = BitColumns::new(spec);
        let mut look = Self {
            spec,
            start,
            blocks: blocks.clone(),
            open: nothing.clone(),
            shut: nothing,
            has_looked: false,
        };
        if let Some((column, z)) = look.own() {
            look.blocks.clear(column, z);
            look.open.set(column, z);
        }
        look
    }

    /// The camera's own voxel, if it is in the grid.
    pub(crate) fn own(&self) -> Option<(usize, usize)> {
        self.spec.flat(self.start.voxel()).map(|flat| self.place(flat))
    }

    /// Whether rays may be cast in bundles: they start in the grid, and it is not beyond measure.
    pub(crate) fn is_bundled(&self) -> bool {
        self.own().is_some() && self.spec.shape().iter().all(|n| *n <= LARGEST)
    }

    /// Column and height of a voxel.
    #[inline]
    pub(crate) fn place(&self, flat: usize) -> (usize, usize) {
        let nz = self.spec.shape()[2];
        (flat / nz, flat % nz)
    }

    /// Says that a ray is cast: it sees the camera's own voxel.
    pub(crate) fn open_eye(&mut self) {
        self.has_looked = true;
    }

    /// Marks a voxel as seen; tells whether it ends the ray.
    #[inline]
    pub(crate) fn meet(&mut self, column: usize, z: usize) -> bool {
        let is_end = self.blocks.get(column, z);
        let seen = if is_end { &mut self.shut } else { &mut self.open };
        seen.set(column, z);
        is_end
    }

    /// Marks all that one ray sees.
    #[inline]
    pub(crate) fn along(&mut self, end: LatticePoint) {
        self.open_eye();
        let (spec, start, nz) = (self.spec, self.start, self.spec.shape()[2]);
        walk(spec, start, end, |flat, [_, _, z]| {
            let z = z as usize;
            if self.meet((flat - z) / nz, z) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    }

    /// Marks all that one ray sees from the voxel on that it enters through face number `faces` of
    /// an axis; the ray must not end before in a voxel that blocks.
    pub(crate) fn along_after(&mut self, end: LatticePoint, axis: usize, faces: i64) {
        if faces == 0 {
            return self.along(end);
        }
        let (spec, start, nz) = (self.spec, self.start, self.spec.shape()[2]);
        walk_after(spec, [start, end], (axis, faces), |flat, [_, _, z]| {
            let z = z as usize;
            if self.meet((flat - z) / nz, z) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    }

    /// Where in its voxel the camera stands along an axis, 0 to 1.
    pub(crate) fn start_within(&self, axis: usize) -> f64 {
        (self.start.0[axis] & (LATTICE - 1)) as f64 / LATTICE as f64
    }

    /// Whether rays pass all voxels of a box, and all are seen.
    #[inline]
    pub(crate) fn all_open(&self, ranges: &[Range<usize>; 3]) -> bool {
        self.all(&self.open, ranges)
    }

    /// Whether all voxels of a box end rays, and are seen.
    #[inline]
    pub(crate) fn all_shut(&self, ranges: &[Range<usize>; 3]) -> bool {
        self.all(&self.shut, ranges)
    }

    #[inline]
    fn all(&self, bits: &BitColumns, [xs, ys, zs]: &[Range<usize>; 3]) -> bool {
        let ny = self.spec.shape()[1];
        let (low, high) = (zs.start, zs.end - 1);
        for x in xs.start..xs.end {
            for y in ys.start..ys.end {
                if !bits.has_all(x * ny + y, low, high) {
                    return false;
                }
            }
        }
        true
    }

    /// Whether all voxels of a box are seen.
    pub(crate) fn all_seen(&self, [xs, ys, zs]: &[Range<usize>; 3]) -> bool {
        let ny = self.spec.shape()[1];
        let is_seen = |column, z| self.open.get(column, z) || self.shut.get(column, z);
        xs.clone().all(|x| ys.clone().all(|y| zs.clone().all(|z| is_seen(x * ny + y, z))))
    }

    /// Marks a voxel that is seen without a ray; it ends none.
    pub(crate) fn mark(&mut self, column: usize, z: usize) {
        self.open.set(column, z);
        self.has_looked |= self.own() == Some((column, z));
    }

    /// Marks the voxels of a column from one height to another as a ray enters them; tells whether
    /// one of them ends it.
    #[inline]
    pub(crate) fn meet_between(&mut self, column: usize, from: usize, to: usize) -> bool {
        let (low, high) = (from.min(to), from.max(to));
        if self.blocks.has_none(column, low, high) {
            self.open.set_all(column, low, high);
            false
        } else if from == low {
            (low..=high).any(|z| self.meet(column, z))
        } else {
            (low..=high).rev().any(|z| self.meet(column, z))
        }
    }

    /// Adds a camera's bit to all voxels that it saw, in flat order.
    pub(crate) fn add_bit(&self, bit: usize, bits: &mut [u16]) {
        let mut seen = self.open.clone();
        seen.unite(&self.shut);
        if let Some((column, z)) = self.own().filter(|_| !self.has_looked) {
            seen.clear(column, z);
        }
        seen.for_each(self.spec, |flat| bits[flat] |= 1 << bit);
    }

    /// The voxel of a column and height.
    pub(crate) fn voxel(&self, column: usize, z: usize) -> VoxelIndex {
        let ny = self.spec.shape()[1];
        VoxelIndex([(column / ny) as i64, (column % ny) as i64, z as i64])
    }
}
