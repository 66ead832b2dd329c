//! A voxel divided until each part is full, empty, or cut by one plane.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use crate::What;
use crate::nearest::Nearest;
use crate::truth::cut::Cut;
use crate::truth::placed::{Cell, Placed, TOUCH_M};
use crate::truth::tally::Tally;
use crate::truth::{ROUNDING, SKIN_M};

/// How often a voxel is halved at most: its leaves are 1/16 of its edges long.
const DEEPEST: u32 = 4;
/// A voxel that solid reaches into without filling any sample has this share: half a leaf.
pub(super) const LEAST_SHARE: f64 = 0.5 / (1 << (3 * DEEPEST)) as f64;

/// A solid near a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) solid: usize,
    pub(super) nearest: Nearest,
    pub(super) what: What,
}

/// What is in a voxel.
#[derive(Clone, Debug, Default)]
pub(super) struct Content {
    /// Share of the volume.
    pub(super) solid: f64,
    /// Whether any of it is air.
    pub(super) open: bool,
    /// From the voxel's centre to the nearest surface found in it, metres.
    pub(super) surface_m: f64,
    /// Area that borders on air.
    pub(super) surfaces: Tally,
    /// Volume, as shares.
    pub(super) volumes: Tally,
}

/// Divides voxels one after the other.
pub(super) struct Divider<'a> {
    solids: &'a [Placed<'a>],
    /// The solids near a cell and, before them, those near the cells around it.
    near: Vec<Near>,
    voxel: Cell,
    content: Content,
}

impl<'a> Divider<'a> {
    pub(super) fn new(solids: &'a [Placed<'a>]) -> Self {
        let voxel = Cell { centre: Point3::origin(), half: Vector3::zeros() };
        Self { solids, near: Vec::new(), voxel, content: Content::default() }
    }

    /// What the solids that reach into a voxel make of it.
    pub(super) fn divide(&mut self, voxel: &Cell, near: &[Near]) -> &Content {
        self.near.clear();
        self.near.extend_from_slice(near);
        self.voxel = *voxel;
        (self.content.solid, self.content.open) = (0.0, false);
        self.content.surface_m = f64::INFINITY;
        self.content.surfaces.clear();
        self.content.volumes.clear();
        self.visit(voxel, 0, 0..near.len());
        &self.content
    }

    /// A cell, given the solids near the cell around it.
    fn visit(&mut self, cell: &Cell, depth: u32, around: Range<usize>) {
        let start = self.near.len();
        let radius_m = cell.radius_m();
        for at in around {
            let solid = self.near[at].solid;
            let (nearest, what) = self.solids[solid].nearest(&cell.centre);
            if nearest.distance_m <= -radius_m {
                self.near.truncate(start);
                return self.fill(what, share(depth));
            }
            if nearest.distance_m < radius_m {
                self.near.push(Near { solid, nearest, what });
            }
        }
        let near = start..self.near.len();
        if near.is_empty() {
            self.content.open = true;
        } else if depth == DEEPEST || self.is_one_plane(&near, radius_m) {
            self.cut(cell, depth, near);
        } else {
            (0..8).for_each(|octant| self.visit(&cell.octant(octant), depth + 1, near.clone()));
        }
        self.near.truncate(start);
    }

    fn fill(&mut self, what: What, share: f64) {
        self.content.solid += share;
        self.content.volumes.add(what, share);
    }

    fn is_one_plane(&self, near: &Range<usize>, radius_m: f64) -> bool {
        let Nearest { distance_m, flat_m, .. } = self.near[near.start].nearest;
        near.len() == 1 && flat_m >= distance_m.abs() + radius_m
    }

    /// Whether a surface passes through a leaf. One that lies between two leaves of the voxel is
    /// that of the solid one's.
    fn passes(&self, cut: &Cut, foot: &Point3<f64>) -> bool {
        let Cell { centre, half } = self.voxel;
        let is_within = || (0..3).all(|axis| (foot - centre)[axis].abs() < half[axis] - TOUCH_M);
        cut.area_m2 > 0.0 && cut.share > ROUNDING && (cut.share < 1.0 - ROUNDING || is_within())
    }

    /// A leaf: every surface that borders on air cuts it as its plane would. Several cut it as if
    /// they stood at right angles.
    fn cut(&mut self, cell: &Cell, depth: u32, near: Range<usize>) {
        let mut air = 1.0;
        let mut bordered = false;
        for at in near.clone() {
            let Near { nearest, what, .. } = self.near[at];
            let foot = nearest.foot(&cell.centre);
            if is_covered(self.solids, &self.near[near.clone()], at - near.start, &foot) {
                continue;
            }
            let cut = Cut::new(&cell.half, &nearest.normal, nearest.distance_m);
            air *= 1.0 - cut.share;
            bordered = true;
            if self.passes(&cut, &foot) {
                self.content.surfaces.add(what, cut.area_m2);
                let from_middle_m = (foot - self.voxel.centre).norm();
                self.content.surface_m = self.content.surface_m.min(from_middle_m);
            }
        }
        let deepest = self.near[near]
            .iter()
            .reduce(|a, b| if b.nearest.distance_m < a.nearest.distance_m { b } else { a });
        let Some(&Near { what, nearest, .. }) = deepest else { return };
        if !bordered {
            air = if nearest.distance_m <= 0.0 { 0.0 } else { 1.0 };
        }
        self.content.open |= air > ROUNDING;
        self.fill(what, (1.0 - air) * share(depth));
    }
}

/// Whether a place on the surface of one of the solids lies against another of them: nothing can be
/// seen there, and no air be touched.
pub(super) fn is_covered(
    solids: &[Placed],
    near: &[Near],
    which: usize,
    foot: &Point3<f64>,
) -> bool {
    let before = foot + near[which].nearest.normal * SKIN_M;
    let mut others = near.iter().enumerate().filter(|&(at, _)| at != which);
    others.any(|(_, other)| solids[other.solid].contains(&before))
}

/// Share of a voxel that a cell of some depth has.
fn share(depth: u32) -> f64 {
    1.0 / f64::from(1_u32 << (3 * depth))
}
