//! Which frame is the world, which the ego's, and what the lidars are called.

use std::collections::{BTreeMap, BTreeSet};

use occlabel_core::{Fault, McapSettings};

use super::recording::{CloudHead, Recording};

/// The word for what the log itself tells.
pub(super) const AUTO: &str = "auto";
/// Usual names of the ego's frame, of a world; the first that is there counts.
const EGO_FRAMES: [&str; 5] = ["base_link", "base_footprint", "ego_vehicle", "ego", "vehicle"];
const WORLD_FRAMES: [&str; 4] = ["map", "world", "local", "odom"];

/// The parts that frames play.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FrameRoles {
    pub(super) world: String,
    pub(super) ego: String,
}

impl FrameRoles {
    /// As the settings say, else by usual names, else by what moves.
    ///
    /// # Errors
    /// If there are no clouds, or nothing tells the ego's frame.
    pub(super) fn find(recording: &Recording, settings: &McapSettings) -> Result<Self, Fault> {
        let Some(first) = recording.clouds.first() else {
            let fault =
                Fault::new("mcap-clouds", &recording.file, "messages of point clouds", "none");
            return Err(fault.hint("`inspect` lists what is there"));
        };
        let chain = recording.frames.ancestors(&first.header.frame);
        let ego = match settings.ego_frame.as_str() {
            AUTO => ego_of(recording, &chain)?,
            named => named,
        };
        let above = recording.frames.ancestors(ego);
        let known = WORLD_FRAMES.into_iter().find(|name| above[1..].contains(name));
        let world = match settings.world_frame.as_str() {
            AUTO => known.unwrap_or(above[above.len() - 1]),
            named => named,
        };
        Ok(Self { world: world.to_owned(), ego: ego.to_owned() })
    }
}

/// Above the lidar: a usual name, else the frame nearest to it that moves.
fn ego_of<'a>(recording: &Recording, chain: &[&'a str]) -> Result<&'a str, Fault> {
    let usual = EGO_FRAMES.into_iter().find_map(|name| chain.iter().find(|frame| **frame == name));
    let moving = || chain.iter().find(|frame| recording.frames.moves(frame));
    usual.or_else(moving).copied().ok_or_else(|| {
        let expected = "a moving frame among those of the first cloud";
        let fault =
            Fault::new("mcap-ego-frame", &recording.file, expected, recording.frames.told(chain));
        fault.hint("`reader.mcap.ego_frame` names it")
    })
}

/// The lidars' names by their topics: as the settings say, else by their frames, or by their topics
/// where these share a frame.
pub(super) fn lidar_names(
    clouds: &[CloudHead],
    settings: &McapSettings,
) -> BTreeMap<String, String> {
    let mut topics: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for cloud in clouds {
        topics.entry(&cloud.header.frame).or_default().insert(&cloud.topic);
    }
    let name = |cloud: &CloudHead| {
        let named = settings.lidars.get(&cloud.topic);
        let is_alone = topics[cloud.header.frame.as_str()].len() == 1;
        let own = if is_alone { &cloud.header.frame } else { &cloud.topic };
        named.unwrap_or(own).clone()
    };
    let mut names = BTreeMap::new();
    for cloud in clouds {
        names.entry(cloud.topic.clone()).or_insert_with(|| name(cloud));
    }
    names
}
