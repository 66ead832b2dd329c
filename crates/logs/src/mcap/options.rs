//! What the MCAP reader is asked for.

use occlabel_core::McapSettings;

use super::contents::Channel;
use super::dispatch::{Kind, kind};
use crate::ReadOptions;

/// Which scenes to read, and how.
#[derive(Clone, Debug)]
pub struct McapOptions {
    /// What every reader is asked for.
    pub read: ReadOptions,
    /// The `[reader.mcap]` table.
    pub settings: McapSettings,
    /// Which of a message's two times counts.
    pub time_source: TimeSource,
    /// Whether a broken file is read up to where it is broken.
    pub recover: bool,
}

/// A message's own time, or that of its record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeSource {
    /// The message's own.
    #[default]
    Header,
    /// When it was recorded.
    Log,
}

/// The end of topics that hold our own body masks.
const BODY_MASK: &str = "/body_mask";

/// What a channel is read for, if at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Sweeps,
    Transforms,
    Optics,
    Boxes,
    BodyMask,
    Pictures,
}

impl Purpose {
    /// For people.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Sweeps => "sweeps",
            Self::Transforms => "transforms",
            Self::Optics => "calibrations of a camera",
            Self::Boxes => "boxes",
            Self::BodyMask => "a body mask",
            Self::Pictures => "times of images",
        }
    }
}

/// What a channel is read for: its schema decides, and which topics the settings name.
pub(super) fn purpose(settings: &McapSettings, channel: &Channel) -> Option<Purpose> {
    let topic = &channel.topic;
    let (purpose, is_named) = match kind(channel)? {
        Kind::Cloud => {
            (Purpose::Sweeps, settings.lidars.is_empty() || settings.lidars.contains_key(topic))
        }
        Kind::Link | Kind::Links => (Purpose::Transforms, true),
        Kind::Optics => {
            (Purpose::Optics, settings.cameras.is_empty() || settings.cameras.contains_key(topic))
        }
        Kind::Scene | Kind::Detections | Kind::Markers => {
            (Purpose::Boxes, settings.boxes.is_empty() || settings.boxes.contains(topic))
        }
        Kind::CompressedPicture if topic.ends_with(BODY_MASK) => (Purpose::BodyMask, true),
        Kind::CompressedPicture | Kind::RawPicture => (Purpose::Pictures, true),
    };
    is_named.then_some(purpose)
}
