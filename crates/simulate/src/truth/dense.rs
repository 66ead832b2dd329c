//! Where the rays of a denser pattern would end.

use std::sync::atomic::{AtomicU32, Ordering};

use occlabel_core::VoxelGrid;
use rayon::prelude::*;

use crate::Drive;
use crate::lidar::Lidar;
use crate::truth::marks::Target;
use crate::truth::rays::SweepRays;
use crate::truth::{TruthAt, TruthSettings};

/// The dense pattern has twice the beams and twice the shots a turn: four times the rays.
const DENSER: usize = 2;

/// How many rays of a pattern four times denser than the logged one end in each voxel, for many
/// keyframes at once: every sweep is cast anew, once. Parallel over sweeps.
///
/// Takes 4 bytes a voxel and keyframe, and as long as casting four drives.
pub fn dense_ends(
    drive: &Drive,
    keyframes: &[TruthAt],
    settings: &TruthSettings,
) -> Vec<VoxelGrid<u32>> {
    let targets: Vec<_> = keyframes.iter().map(|at| Target::new(drive, at, settings)).collect();
    let counts: Vec<Vec<AtomicU32>> = keyframes
        .iter()
        .map(|at| (0..at.spec.len()).map(|_| AtomicU32::new(0)).collect())
        .collect();
    (0..drive.scene().sweeps.len()).into_par_iter().for_each(|sweep| {
        let (lidar, number) = drive.taken_by(sweep);
        let dense = Lidar { pattern: lidar.pattern.denser(DENSER), ..lidar.clone() };
        let rays = SweepRays::cast(drive, &dense, number);
        for (target, counts) in targets.iter().zip(&counts) {
            if target.is_within(&rays, settings.window_s) {
                target.ends(&rays).for_each(|(flat, _)| {
                    counts[flat].fetch_add(1, Ordering::Relaxed);
                });
            }
        }
    });
    let counted = keyframes.iter().zip(counts);
    let grid = |(at, counts): (&TruthAt, Vec<AtomicU32>)| {
        VoxelGrid::from_values(at.spec, counts.into_iter().map(AtomicU32::into_inner).collect())
    };
    counted.map(grid).collect()
}
