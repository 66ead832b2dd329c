//! Rigid flow of tracks (labels.md section 11).

use std::collections::BTreeMap;

use occlabel_annotate::BoxSettings;
use occlabel_core::{
    Body, BodyMotion, BoxTrack, GridSpec, Instant, Pose, Scene, StandingBox, TrackId, VoxelGrid,
    VoxelVote,
};

/// How a track moves in the grid, seen from where it stands now: until its next annotation, or as its
/// body does.
struct Motion {
    later_from_now: Pose,
    /// `None` if now is the earlier time.
    earlier_from_now: Option<Pose>,
    seconds: f64,
}

/// Velocity of each voxel's centre with its track, grid frame, metres per second.
///
/// 0 where nothing is, or nothing that a track vouches for; NaN where the track's next annotation is
/// missing or farther away than `max_gap_s`, of instances that have no box, and where a body has no
/// neighbour in time. Both boxes stand in the keyframe's own grid, so the
/// ego's motion is not in it.
pub(crate) fn flow(
    scene: &Scene,
    instant: &Instant,
    bodies: &[Body],
    occupied: &VoxelGrid<Option<VoxelVote>>,
    spec: &GridSpec,
    settings: &BoxSettings,
) -> VoxelGrid<[f32; 3]> {
    let mut motions: BTreeMap<TrackId, Option<Motion>> = (instant.standing.iter())
        .map(|standing| (standing.track, box_motion(scene, instant, standing, settings)))
        .collect();
    let to_grid = |motion| body_motion(motion, &instant.grid_from_world);
    motions.extend(bodies.iter().map(|body| (body.track, body.motion.as_ref().map(to_grid))));
    let mut flat = 0..spec.len();
    occupied.map(|vote| {
        let at = flat.next().expect("one voxel per vote");
        let track = vote.as_ref().and_then(|vote| vote.instance);
        // An instance that masks alone tell of has no box to move with.
        let motion = |track| motions.get(&track).and_then(Option::as_ref);
        track.map_or([0.0; 3], |track| velocity(motion(track), spec, at))
    })
}

fn velocity(motion: Option<&Motion>, spec: &GridSpec, flat: usize) -> [f32; 3] {
    let Some(motion) = motion else { return [f32::NAN; 3] };
    let centre = spec.centre(spec.voxel_at(flat));
    let earlier = motion.earlier_from_now.map_or(centre, |earlier| earlier * centre);
    let velocity = (motion.later_from_now * centre - earlier) / motion.seconds;
    [velocity.x as f32, velocity.y as f32, velocity.z as f32]
}

fn box_motion(
    scene: &Scene,
    instant: &Instant,
    standing: &StandingBox,
    settings: &BoxSettings,
) -> Option<Motion> {
    let track: &BoxTrack = &scene.tracks[usize::from(standing.track.0) - 1];
    let (time, next) = track.boxes.iter().find(|(time, _)| *time > instant.time)?;
    let seconds = time.seconds_since(instant.time);
    let grid_from_next = instant.grid_from_world * next.world_from_box;
    (seconds <= settings.max_gap_s).then(|| Motion {
        later_from_now: grid_from_next * standing.grid_from_box.inverse(),
        earlier_from_now: None,
        seconds,
    })
}

fn body_motion(motion: &BodyMotion, grid_from_world: &Pose) -> Motion {
    let in_grid = |world: &Pose| grid_from_world * world * grid_from_world.inverse();
    Motion {
        later_from_now: in_grid(&motion.later_from_now),
        earlier_from_now: Some(in_grid(&motion.earlier_from_now)),
        seconds: motion.seconds,
    }
}
