//! Which tracks stand at a moment, and where in its grid.

use occlabel_core::{GrownBox, Pose, Scene, StandingBox, Timestamp};

use crate::Rules;
use crate::aggregate_scene::standing_boxes;

/// The tracks that stand at a time, their boxes grown as for sorting sweeps.
pub fn standing_at(
    scene: &Scene,
    time: Timestamp,
    grid_from_world: &Pose,
    rules: &Rules,
) -> Vec<StandingBox> {
    let stand = |track: occlabel_aggregate::TrackBox| StandingBox {
        track: track.track,
        grown: GrownBox::new(&track.boxed.size_m, &rules.window.growth),
        grid_from_box: grid_from_world * track.boxed.world_from_box,
        boxed: track.boxed,
    };
    standing_boxes(&scene.tracks, time, rules).into_iter().map(stand).collect()
}
