//! How to read MCAP logs: the `[reader.mcap]` table.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What an MCAP log's topics, frames and fields are for, where the log itself does not say, and how
/// much of it is believed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct McapSettings {
    /// The frame that stands still; `"auto"`: map, world or odom above the ego, else the top one.
    pub world_frame: String,
    /// The vehicle's frame; `"auto"`: one of the usual names, else the frame below the first lidar's
    /// top that moves.
    pub ego_frame: String,
    /// The field of points that holds their labels; a cloud without it is unlabelled.
    pub label_field: String,
    /// The field of points that holds when they were measured, for clouds that are not yet
    /// compensated for the ego's motion; `"none"` takes the clouds as they are.
    pub time_field: String,
    /// What 1 in that field is, seconds.
    pub time_unit_s: f64,
    /// Poses are interpolated over no longer gaps, seconds.
    pub max_transform_gap_s: f64,
    /// A record, or a chunk once unpacked, of more bytes is refused.
    pub max_record_bytes: u64,
    /// The taxonomy that `taxonomy.file = "auto"` means: a shipped one, or a path.
    pub taxonomy: String,
    /// Topics of boxes; none: all.
    pub boxes: Vec<String>,
    /// Topics of clouds, with the names of their lidars; none: all, named by their frames.
    pub lidars: BTreeMap<String, String>,
    /// Topics of calibrations, with the names of their cameras; none: all, named by their frames.
    pub cameras: BTreeMap<String, String>,
    /// Raw point labels, with their names in the taxonomy's `[points]`.
    pub classes: BTreeMap<String, String>,
    /// Raw categories of boxes, with their names in the taxonomy's `[boxes]`.
    pub categories: BTreeMap<String, String>,
}

impl Default for McapSettings {
    fn default() -> Self {
        Self {
            world_frame: "auto".into(),
            ego_frame: "auto".into(),
            label_field: "label".into(),
            time_field: "none".into(),
            time_unit_s: 1e-9,
            max_transform_gap_s: 1.0,
            max_record_bytes: 1 << 30,
            taxonomy: "occ3d-nuscenes".into(),
            lidars: BTreeMap::new(),
            cameras: BTreeMap::new(),
            boxes: Vec::new(),
            classes: BTreeMap::new(),
            categories: BTreeMap::new(),
        }
    }
}
