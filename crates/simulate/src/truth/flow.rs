//! Where movers go next.

use occlabel_core::{GridSpec, Keyframe, Pose, TrackId, VoxelTruth};
use rayon::prelude::*;

use crate::Drive;
use crate::truth::TruthAt;

/// How a mover stands at the next keyframe, from how it stands now, and seconds between; in grid.
type Motion = Option<(Pose, f64)>;

/// Fills in the velocity of each voxel's mover at its centre (labels.md section 11).
pub(super) fn fill_flow(drive: &Drive, at: &TruthAt, truth: &mut [VoxelTruth]) {
    let next = drive.scene().keyframes.iter().find(|key| key.time > at.keyframe.time);
    let motion = |mover| motion(drive, at, next?, mover);
    let motions: Vec<Motion> = (0..drive.world().movers.len()).map(motion).collect();
    truth.par_iter_mut().enumerate().for_each(|(flat, voxel)| {
        if let Some(TrackId(id)) = voxel.instance {
            voxel.flow = velocity(motions[usize::from(id) - 1].as_ref(), at.spec, flat);
        }
    });
}

fn motion(drive: &Drive, at: &TruthAt, next: &Keyframe, mover: usize) -> Motion {
    let world = drive.world();
    let [now_s, next_s] = [at.keyframe, next].map(|key| drive.mover_time_s(key, mover));
    let [now, then] = [now_s, next_s].map(|time_s| {
        at.world_from_grid.inverse()
            * world.movers[mover].box_at(time_s, &world.ground).world_from_box
    });
    Some((then * now.inverse(), next_s - now_s))
}

fn velocity(motion: Option<&(Pose, f64)>, spec: &GridSpec, flat: usize) -> [f32; 3] {
    let Some((next_from_now, seconds)) = motion else { return [f32::NAN; 3] };
    let centre = spec.centre(spec.voxel_at(flat));
    let velocity = (next_from_now * centre - centre) / *seconds;
    [velocity.x as f32, velocity.y as f32, velocity.z as f32]
}
