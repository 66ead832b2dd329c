//! What a grid's voxels are made of at a keyframe.

use nalgebra::Vector3;
use occlabel_core::{ClassSet, GridSpec, VoxelIndex, VoxelTruth};
use rayon::prelude::*;

use crate::Drive;
use crate::truth::divide::{Divider, LEAST_SHARE, Near, is_covered};
use crate::truth::placed::{Cell, Placed};
use crate::truth::tally::Tally;

/// Surfaces are looked for up to so many voxels from a voxel's centre.
pub(super) const FARTHEST_VOXELS: f64 = 4.0;
/// So many columns of voxels share one list of the solids near them.
const COLUMNS_A_TILE: usize = 8;

/// Fills in solid share, surface, class and instance. Parallel over x.
pub(super) fn fill_matter(
    drive: &Drive,
    solids: &[Placed],
    spec: &GridSpec,
    truth: &mut [VoxelTruth],
) {
    let [_, ny, nz] = spec.shape();
    truth.par_chunks_mut(ny * nz).enumerate().for_each(|(x, slab)| {
        let mut filler = Filler::new(drive, solids, spec);
        for (tile, voxels) in slab.chunks_mut(COLUMNS_A_TILE * nz).enumerate() {
            filler.fill((x * ny + tile * COLUMNS_A_TILE) * nz, voxels);
        }
    });
}

struct Filler<'a> {
    drive: &'a Drive,
    solids: &'a [Placed<'a>],
    spec: &'a GridSpec,
    half: Vector3<f64>,
    reach_m: f64,
    divider: Divider<'a>,
    near: Vec<Near>,
}

impl<'a> Filler<'a> {
    fn new(drive: &'a Drive, solids: &'a [Placed<'a>], spec: &'a GridSpec) -> Self {
        Self {
            drive,
            solids,
            spec,
            half: spec.size_m() / 2.0,
            reach_m: spec.size_m().min() * FARTHEST_VOXELS,
            divider: Divider::new(solids),
            near: Vec::new(),
        }
    }

    /// Fills whole columns of one x, the first voxel at a flat place.
    fn fill(&mut self, first: usize, voxels: &mut [VoxelTruth]) {
        let tile = self.tile(first, first + voxels.len() - 1);
        let reach_m = tile.radius_m() + self.reach_m;
        let is_near =
            |&solid: &usize| self.solids[solid].nearest(&tile.centre).0.distance_m <= reach_m;
        let solids: Vec<usize> = (0..self.solids.len()).filter(is_near).collect();
        for (at, truth) in voxels.iter_mut().enumerate() {
            self.fill_voxel(self.spec.voxel_at(first + at), &solids, truth);
        }
    }

    /// What holds two voxels and all between them.
    fn tile(&self, first: usize, last: usize) -> Cell {
        let ends = [first, last].map(|flat| self.spec.centre(self.spec.voxel_at(flat)));
        let centre = nalgebra::center(&ends[0], &ends[1]);
        Cell { centre, half: (ends[1] - ends[0]) / 2.0 + self.half }
    }

    fn fill_voxel(&mut self, voxel: VoxelIndex, solids: &[usize], truth: &mut VoxelTruth) {
        let cell = Cell { centre: self.spec.centre(voxel), half: self.half };
        let reach_m = self.reach_m.max(cell.radius_m());
        self.near.clear();
        self.near.extend(solids.iter().filter_map(|&solid| {
            let (nearest, what) = self.solids[solid].nearest(&cell.centre);
            (nearest.distance_m <= reach_m).then_some(Near { solid, nearest, what })
        }));
        let surface_m = self.exposed_m(&cell);
        let edge_m = self.spec.size_m().min();
        let clear_m = self.clear_m(&cell, edge_m);
        truth.clearance = (clear_m <= edge_m).then(|| (clear_m / edge_m) as f32);
        self.near.retain(|near| self.solids[near.solid].reaches(&cell, &near.nearest));
        let found_m = if self.near.is_empty() {
            f64::INFINITY
        } else {
            truth.clearance = Some(0.0);
            self.judge(&cell, truth)
        };
        let nearest_m = surface_m.min(found_m).min(self.reach_m);
        truth.surface_distance = (nearest_m / edge_m) as f32;
    }

    /// From a cell to the nearest solid, if that is not farther than `most_m`.
    fn clear_m(&self, cell: &Cell, most_m: f64) -> f64 {
        let radius_m = cell.radius_m();
        self.near.iter().fold(f64::INFINITY, |best_m, Near { solid, nearest, .. }| {
            let is_nearer = nearest.distance_m - radius_m <= best_m.min(most_m);
            let gap_m = || self.solids[*solid].gap_m(cell, nearest);
            if nearest.distance_m < 0.0 {
                0.0
            } else if is_nearer {
                best_m.min(gap_m())
            } else {
                best_m
            }
        })
    }

    /// From a cell's centre to the nearest surface that no other solid covers there.
    fn exposed_m(&self, cell: &Cell) -> f64 {
        let bare = (0..self.near.len()).filter(|&at| {
            let foot = self.near[at].nearest.foot(&cell.centre);
            !is_covered(self.solids, &self.near, at, &foot)
        });
        let distances = bare.map(|at| self.near[at].nearest.distance_m.abs());
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Judges a voxel that something reaches into; the distance of the nearest surface in it.
    fn judge(&mut self, cell: &Cell, truth: &mut VoxelTruth) -> f64 {
        let content = self.divider.divide(cell, &self.near);
        truth.solid = if content.open { content.solid.clamp(LEAST_SHARE, 1.0) } else { 1.0 } as f32;
        truth.surface = content.open;
        let mut only_deepest = Tally::default();
        let parts = if !content.surfaces.is_empty() {
            &content.surfaces
        } else if !content.open {
            &content.volumes
        } else {
            // It grazes the voxel between all samples.
            let deepest = self
                .near
                .iter()
                .min_by(|a, b| a.nearest.distance_m.total_cmp(&b.nearest.distance_m));
            deepest.into_iter().for_each(|near| only_deepest.add(near.what, 1.0));
            &only_deepest
        };
        (truth.class, truth.instance) = parts.winner(self.drive);
        truth.classes = if content.open { parts.classes(self.drive) } else { ClassSet::default() };
        content.surface_m
    }
}
