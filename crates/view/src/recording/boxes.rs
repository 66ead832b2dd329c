//! Boxes that stand at a time.

use foxglove::messages::scene_entity_deletion::Type;
use foxglove::messages::{CubePrimitive, SceneEntity, SceneEntityDeletion, SceneUpdate};
use occlabel_core::{Box3, Timestamp};

use super::WORLD;
use super::common::{color, pair, pose, stamp, vector};

/// How much a box covers.
const ALPHA: f64 = 0.35;

/// A track's box at a time.
#[derive(Clone, Debug)]
pub struct ShownBox {
    /// The log's own id of the track.
    pub id: String,
    /// The log's own category of it.
    pub category: String,
    /// Its number among the tracks, as in `instances`.
    pub track: u16,
    /// What it is called by the labels, and the colour of that; none if it is ignored.
    pub class: Option<(String, [u8; 3])>,
    /// Where it stands.
    pub boxed: Box3,
}

/// All boxes, in place of all that stood before.
pub(super) fn boxes(time: Timestamp, boxes: &[ShownBox]) -> SceneUpdate {
    let stamp = Some(stamp(time));
    let all = SceneEntityDeletion { timestamp: stamp, r#type: Type::All.into(), id: String::new() };
    let entities = boxes.iter().map(|shown| entity(time, shown)).collect();
    SceneUpdate { deletions: vec![all], entities }
}

fn entity(time: Timestamp, shown: &ShownBox) -> SceneEntity {
    let mut metadata =
        vec![pair("category", &shown.category), pair("track", shown.track.to_string())];
    metadata.extend(shown.class.iter().map(|(name, _)| pair("class", name)));
    let rgb = shown.class.as_ref().map_or([128; 3], |(_, rgb)| *rgb);
    let cube = CubePrimitive {
        pose: Some(pose(&shown.boxed.world_from_box)),
        size: Some(vector(&shown.boxed.size_m)),
        color: Some(color(rgb, ALPHA)),
    };
    SceneEntity {
        timestamp: Some(stamp(time)),
        frame_id: WORLD.to_owned(),
        id: shown.id.clone(),
        metadata,
        cubes: vec![cube],
        ..SceneEntity::default()
    }
}
