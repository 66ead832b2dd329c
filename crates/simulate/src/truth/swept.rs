//! Where movers have been or will be.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::Point3;
use occlabel_core::{GridSpec, Pose, Timestamp, VoxelIndex, VoxelTruth};
use rayon::prelude::*;

use crate::Drive;
use crate::bodies::Body;
use crate::instant::mover_bodies;
use crate::truth::placed::{Cell, Placed};
use crate::truth::{SAME_TIME_S, TruthAt};

/// Marks the empty voxels that a mover reaches into at the time of another sweep, by the same test
/// as for solids now. Parallel over times.
pub(super) fn fill_swept(drive: &Drive, at: &TruthAt, truth: &mut [VoxelTruth]) {
    let full = |voxel: &VoxelTruth| AtomicBool::new(voxel.solid > 0.0);
    let seen: Vec<AtomicBool> = truth.iter().map(full).collect();
    let grid_from_world = at.world_from_grid.inverse();
    other_times(drive, at.keyframe.time).par_iter().for_each(|time| {
        let time_s = time.seconds_since(Timestamp(0));
        let movers = 0..drive.world().movers.len();
        for body in movers.flat_map(|mover| mover_bodies(drive.world(), mover, time_s)) {
            mark(&body, &grid_from_world, at.spec, &seen);
        }
    });
    for (voxel, seen) in truth.iter_mut().zip(seen) {
        voxel.swept = seen.into_inner() && voxel.solid == 0.0;
    }
}

/// The times of the drive's sweeps that are not the keyframe's, each once.
fn other_times(drive: &Drive, now: Timestamp) -> Vec<Timestamp> {
    let times = drive.scene().sweeps.iter().map(|sweep| sweep.time);
    let mut other: Vec<_> = times.filter(|time| time.seconds_apart(now) > SAME_TIME_S).collect();
    other.dedup();
    other
}

fn mark(body: &Body, grid_from_world: &Pose, spec: &GridSpec, seen: &[AtomicBool]) {
    let solid = Placed::body(body, grid_from_world);
    let half = spec.size_m() / 2.0;
    let Some(bounds) = solid.bounds() else { return };
    for voxel in voxels_within(spec, &bounds) {
        let Some(flat) = spec.flat(voxel) else { continue };
        if !seen[flat].load(Ordering::Relaxed) {
            let cell = Cell { centre: spec.centre(voxel), half };
            let nearest = solid.nearest(&cell.centre).0;
            if solid.reaches(&cell, &nearest) {
                seen[flat].store(true, Ordering::Relaxed);
            }
        }
    }
}

/// The voxels of a grid that a box of its frame touches.
fn voxels_within(
    spec: &GridSpec,
    [low, high]: &[Point3<f64>; 2],
) -> impl Iterator<Item = VoxelIndex> + use<> {
    let (low, high) = (spec.to_voxel_units(low), spec.to_voxel_units(high));
    let span = |axis: usize| -> Range<i64> {
        let n = spec.shape()[axis] as i64;
        (low[axis].floor() as i64).clamp(0, n)..(high[axis].floor() as i64 + 1).clamp(0, n)
    };
    let (xs, ys, zs) = (span(0), span(1), span(2));
    xs.flat_map(move |x| {
        let zs = zs.clone();
        ys.clone().flat_map(move |y| zs.clone().map(move |z| VoxelIndex([x, y, z])))
    })
}
