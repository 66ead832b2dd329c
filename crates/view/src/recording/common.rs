//! What many messages are made of.

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{
    Color, FrameTransform, KeyValuePair, PackedElementField, Pose as PoseMessage, Quaternion,
    Timestamp as Stamp, Vector3 as VectorMessage,
};
use nalgebra::Vector3;
use occlabel_core::{Pose, Timestamp};

use crate::rows::{Column, Kind};

/// `parent_from_child` at a time.
pub(super) fn transform(
    time: Timestamp,
    parent: &str,
    child: &str,
    parent_from_child: &Pose,
) -> FrameTransform {
    FrameTransform {
        timestamp: Some(stamp(time)),
        parent_frame_id: parent.to_owned(),
        child_frame_id: child.to_owned(),
        translation: Some(vector(&parent_from_child.translation.vector)),
        rotation: Some(quaternion(parent_from_child)),
    }
}

/// Times before 1970 are taken as its first moment, as messages have no words for them.
pub(super) fn stamp(time: Timestamp) -> Stamp {
    let ns = u64::try_from(time.0).unwrap_or_default();
    let seconds = u32::try_from(ns / 1_000_000_000).unwrap_or(u32::MAX);
    Stamp::new(seconds, (ns % 1_000_000_000) as u32)
}

pub(super) fn pose(pose: &Pose) -> PoseMessage {
    let position = vector(&pose.translation.vector);
    PoseMessage { position: Some(position), orientation: Some(quaternion(pose)) }
}

pub(super) fn vector(vector: &Vector3<f64>) -> VectorMessage {
    VectorMessage { x: vector.x, y: vector.y, z: vector.z }
}

fn quaternion(pose: &Pose) -> Quaternion {
    let [x, y, z, w] = pose.rotation.coords.into();
    Quaternion { x, y, z, w }
}

/// A colour that covers by `alpha`.
pub(super) fn color(rgb: [u8; 3], alpha: f64) -> Color {
    let [r, g, b] = rgb.map(|channel| f64::from(channel) / 255.0);
    Color { r, g, b, a: alpha }
}

pub(super) fn pair(key: &str, value: impl Into<String>) -> KeyValuePair {
    KeyValuePair { key: key.to_owned(), value: value.into() }
}

/// How numbers follow each other.
pub(super) fn fields(columns: &[Column]) -> Vec<PackedElementField> {
    let mut offset = 0;
    let field = |(name, kind): &Column| {
        let field =
            PackedElementField { name: (*name).to_owned(), offset, r#type: numeric(*kind).into() };
        offset += kind.bytes();
        field
    };
    columns.iter().map(field).collect()
}

fn numeric(kind: Kind) -> NumericType {
    match kind {
        Kind::U8 => NumericType::Uint8,
        Kind::U16 => NumericType::Uint16,
        Kind::F32 => NumericType::Float32,
    }
}
