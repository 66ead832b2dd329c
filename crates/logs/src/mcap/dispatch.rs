//! Which messages are read, told by their encoding and schema; topics tell nothing.

use occlabel_core::Timestamp;

use super::container::Message;
use super::contents::Channel;
use super::messages::{Boxes, Cloud, Defect, Link, Optics, Picture};
use super::ros::{Layout, MarkerParts, Reader};
use super::{json, protobuf, ros};

/// What a channel's messages tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Cloud,
    /// One transform a message.
    Link,
    /// Many.
    Links,
    Optics,
    /// Foxglove's scene.
    Scene,
    Detections,
    Markers,
    /// With a file of pixels in it.
    CompressedPicture,
    RawPicture,
}

/// How messages are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Protobuf,
    Json,
    Ros(Layout),
}

/// What a channel's messages tell, if it is anything that is read.
pub(super) fn kind(channel: &Channel) -> Option<Kind> {
    let name = channel.schema.name.as_str();
    match encoding(channel)? {
        Encoding::Protobuf | Encoding::Json => foxglove_kind(name.strip_prefix("foxglove.")?),
        Encoding::Ros(_) => ros_kind(name),
    }
}

fn encoding(channel: &Channel) -> Option<Encoding> {
    match channel.encoding.as_str() {
        "protobuf" => Some(Encoding::Protobuf),
        "json" => Some(Encoding::Json),
        "cdr" => Some(Encoding::Ros(Layout::Cdr)),
        "ros1" => Some(Encoding::Ros(Layout::Ros1)),
        _ => None,
    }
}

fn foxglove_kind(name: &str) -> Option<Kind> {
    Some(match name {
        "PointCloud" => Kind::Cloud,
        "FrameTransform" => Kind::Link,
        "FrameTransforms" => Kind::Links,
        "CameraCalibration" => Kind::Optics,
        "SceneUpdate" => Kind::Scene,
        "CompressedImage" => Kind::CompressedPicture,
        "RawImage" => Kind::RawPicture,
        _ => return None,
    })
}

/// ROS 2 has `/msg/` between package and type.
fn ros_kind(name: &str) -> Option<Kind> {
    Some(match name.replace("/msg/", "/").as_str() {
        "sensor_msgs/PointCloud2" => Kind::Cloud,
        "geometry_msgs/TransformStamped" => Kind::Link,
        "tf2_msgs/TFMessage" | "tf/tfMessage" => Kind::Links,
        "sensor_msgs/CameraInfo" => Kind::Optics,
        "vision_msgs/Detection3DArray" => Kind::Detections,
        "visualization_msgs/MarkerArray" => Kind::Markers,
        "sensor_msgs/CompressedImage" => Kind::CompressedPicture,
        "sensor_msgs/Image" => Kind::RawPicture,
        _ => return None,
    })
}

/// A message, decoded.
#[derive(Debug)]
pub(super) enum Decoded {
    Cloud(Cloud),
    Links(Vec<Link>),
    Optics(Optics),
    Boxes(Boxes),
    Picture(Picture),
}

/// Decodes a message of a channel that is read. A time of 0 is none: the log's stands in.
///
/// # Errors
/// If it is not laid out as its schema says.
pub(super) fn decode(message: &Message, use_log_time: bool) -> Result<Option<Decoded>, Defect> {
    let channel = &message.channel;
    let (Some(kind), Some(encoding)) = (kind(channel), encoding(channel)) else { return Ok(None) };
    let mut decoded = match encoding {
        Encoding::Protobuf => of_protobuf(kind, &message.data)?,
        Encoding::Json => json::decode(kind, &message.data)?,
        Encoding::Ros(layout) => of_ros(kind, layout, message)?,
    };
    let log_time = Timestamp(i64::try_from(message.log_time_ns).unwrap_or(i64::MAX));
    decoded.each_time(|time| {
        if use_log_time || *time == Timestamp(0) {
            *time = log_time;
        }
    });
    Ok(Some(decoded))
}

fn of_protobuf(kind: Kind, data: &[u8]) -> Result<Decoded, Defect> {
    Ok(match kind {
        Kind::Cloud => Decoded::Cloud(protobuf::cloud(data)?),
        Kind::Link => Decoded::Links(vec![protobuf::link(data)?]),
        Kind::Links => Decoded::Links(protobuf::links(data)?),
        Kind::Optics => Decoded::Optics(protobuf::optics(data)?),
        Kind::Scene | Kind::Detections | Kind::Markers => Decoded::Boxes(protobuf::boxes(data)?),
        Kind::CompressedPicture => Decoded::Picture(protobuf::picture(data, true)?),
        Kind::RawPicture => Decoded::Picture(protobuf::picture(data, false)?),
    })
}

fn of_ros(kind: Kind, layout: Layout, message: &Message) -> Result<Decoded, Defect> {
    let mut reader = Reader::new(&message.data, layout)?;
    let reader = &mut reader;
    Ok(match kind {
        Kind::Cloud => Decoded::Cloud(ros::cloud(reader)?),
        Kind::Link => Decoded::Links(vec![ros::link(reader)?]),
        Kind::Links => Decoded::Links(ros::links(reader)?),
        Kind::Optics => Decoded::Optics(ros::optics(reader)?),
        Kind::Scene | Kind::Detections => Decoded::Boxes(ros::detections(reader)?),
        Kind::Markers => {
            let parts = MarkerParts::of_schema(&message.channel.schema.data);
            Decoded::Boxes(ros::markers(reader, parts)?)
        }
        Kind::CompressedPicture => Decoded::Picture(ros::picture(reader, true)?),
        Kind::RawPicture => Decoded::Picture(ros::picture(reader, false)?),
    })
}

impl Decoded {
    fn each_time(&mut self, mut change: impl FnMut(&mut Timestamp)) {
        match self {
            Self::Cloud(cloud) => change(&mut cloud.header.time),
            Self::Links(links) => links.iter_mut().for_each(|link| change(&mut link.header.time)),
            Self::Optics(optics) => change(&mut optics.header.time),
            Self::Boxes(boxes) => {
                boxes.cubes.iter_mut().for_each(|cube| change(&mut cube.header.time));
                boxes.cleared.iter_mut().for_each(change);
            }
            Self::Picture(picture) => change(&mut picture.header.time),
        }
    }

    /// The first of its times.
    pub(super) fn time(&self) -> Option<Timestamp> {
        match self {
            Self::Cloud(cloud) => Some(cloud.header.time),
            Self::Links(links) => links.first().map(|link| link.header.time),
            Self::Optics(optics) => Some(optics.header.time),
            Self::Boxes(boxes) => boxes.cubes.first().map(|cube| cube.header.time),
            Self::Picture(picture) => Some(picture.header.time),
        }
    }
}
