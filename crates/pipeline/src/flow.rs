//! Rigid flow of tracks (labels.md section 11).

use std::collections::BTreeMap;

use occlabel_annotate::BoxSettings;
use occlabel_core::{
    BoxTrack, GridSpec, Instant, Pose, Scene, StandingBox, TrackId, VoxelGrid, VoxelVote,
};

/// A track's motion until its next annotation; `None` if that is too far away.
type Motion = Option<(Pose, f64)>;

/// Velocity of each voxel's centre with its track, grid frame, metres per second.
///
/// 0 where nothing is, or nothing that a track vouches for; NaN where the track's next annotation is
/// missing or farther away than `max_gap_s`, and of instances that have no box. Both boxes stand in the keyframe's own grid, so the
/// ego's motion is not in it.
pub(crate) fn flow(
    scene: &Scene,
    instant: &Instant,
    occupied: &VoxelGrid<Option<VoxelVote>>,
    spec: &GridSpec,
    settings: &BoxSettings,
) -> VoxelGrid<[f32; 3]> {
    let motions: BTreeMap<TrackId, Motion> = (instant.standing.iter())
        .map(|standing| (standing.track, motion(scene, instant, standing, settings)))
        .collect();
    let mut flat = 0..spec.len();
    occupied.map(|vote| {
        let at = flat.next().expect("one voxel per vote");
        let track = vote.as_ref().and_then(|vote| vote.instance);
        // An instance that masks alone tell of has no box to move with.
        let motion = |track| motions.get(&track).and_then(Option::as_ref);
        track.map_or([0.0; 3], |track| velocity(motion(track), spec, at))
    })
}

fn velocity(motion: Option<&(Pose, f64)>, spec: &GridSpec, flat: usize) -> [f32; 3] {
    let Some((next_from_now, seconds)) = motion else { return [f32::NAN; 3] };
    let centre = spec.centre(spec.voxel_at(flat));
    let velocity = (next_from_now * centre - centre) / *seconds;
    [velocity.x as f32, velocity.y as f32, velocity.z as f32]
}

fn motion(
    scene: &Scene,
    instant: &Instant,
    standing: &StandingBox,
    settings: &BoxSettings,
) -> Motion {
    let track: &BoxTrack = &scene.tracks[usize::from(standing.track.0) - 1];
    let (time, next) = track.boxes.iter().find(|(time, _)| *time > instant.time)?;
    let seconds = time.seconds_since(instant.time);
    let grid_from_next = instant.grid_from_world * next.world_from_box;
    (seconds <= settings.max_gap_s)
        .then(|| (grid_from_next * standing.grid_from_box.inverse(), seconds))
}
