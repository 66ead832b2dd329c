//! The schemas that the file's messages have, as a protobuf `FileDescriptorSet`.
//!
//! Field numbers are those of foxglove-sdk, `schemas/proto/foxglove`. Messages that are named but
//! never written are left empty.

use std::sync::OnceLock;

use crate::write::wire::Wire;
use Kind::{Bool, Bytes, Double, Enum, Fixed32, Int32, Int64, Message, Text};

#[derive(Clone, Copy)]
enum Kind {
    Bool,
    Bytes,
    Double,
    Fixed32,
    Int32,
    Int64,
    Text,
    Enum(&'static str),
    Message(&'static str),
}

/// A field's number, name, and type.
type Field = (u64, &'static str, Kind);

/// A message: its name, and its fields; those whose name ends in `[]` are lists.
type Schema = (&'static str, &'static [Field]);

const TIMESTAMP: Kind = Message(".google.protobuf.Timestamp");
const DURATION: Kind = Message(".google.protobuf.Duration");

const MESSAGES: &[Schema] = &[
    ("Vector3", &[(1, "x", Double), (2, "y", Double), (3, "z", Double)]),
    ("Quaternion", &[(1, "x", Double), (2, "y", Double), (3, "z", Double), (4, "w", Double)]),
    ("Color", &[(1, "r", Double), (2, "g", Double), (3, "b", Double), (4, "a", Double)]),
    ("KeyValuePair", &[(1, "key", Text), (2, "value", Text)]),
    (
        "Pose",
        &[
            (1, "position", Message(".foxglove.Vector3")),
            (2, "orientation", Message(".foxglove.Quaternion")),
        ],
    ),
    (
        "FrameTransform",
        &[
            (1, "timestamp", TIMESTAMP),
            (2, "parent_frame_id", Text),
            (3, "child_frame_id", Text),
            (4, "translation", Message(".foxglove.Vector3")),
            (5, "rotation", Message(".foxglove.Quaternion")),
        ],
    ),
    (
        "PackedElementField",
        &[
            (1, "name", Text),
            (2, "offset", Fixed32),
            (3, "type", Enum(".foxglove.PackedElementField.NumericType")),
        ],
    ),
    (
        "PointCloud",
        &[
            (1, "timestamp", TIMESTAMP),
            (2, "frame_id", Text),
            (3, "pose", Message(".foxglove.Pose")),
            (4, "point_stride", Fixed32),
            (5, "fields[]", Message(".foxglove.PackedElementField")),
            (6, "data", Bytes),
        ],
    ),
    (
        "CameraCalibration",
        &[
            (1, "timestamp", TIMESTAMP),
            (9, "frame_id", Text),
            (2, "width", Fixed32),
            (3, "height", Fixed32),
            (4, "distortion_model", Text),
            (5, "D[]", Double),
            (6, "K[]", Double),
            (7, "R[]", Double),
            (8, "P[]", Double),
        ],
    ),
    (
        "CompressedImage",
        &[
            (1, "timestamp", TIMESTAMP),
            (4, "frame_id", Text),
            (2, "data", Bytes),
            (3, "format", Text),
        ],
    ),
    (
        "CubePrimitive",
        &[
            (1, "pose", Message(".foxglove.Pose")),
            (2, "size", Message(".foxglove.Vector3")),
            (3, "color", Message(".foxglove.Color")),
        ],
    ),
    (
        "SceneEntityDeletion",
        &[
            (1, "timestamp", TIMESTAMP),
            (2, "type", Enum(".foxglove.SceneEntityDeletion.Type")),
            (3, "id", Text),
        ],
    ),
    (
        "SceneEntity",
        &[
            (1, "timestamp", TIMESTAMP),
            (2, "frame_id", Text),
            (3, "id", Text),
            (4, "lifetime", DURATION),
            (5, "frame_locked", Bool),
            (6, "metadata[]", Message(".foxglove.KeyValuePair")),
            (7, "arrows[]", Message(".foxglove.ArrowPrimitive")),
            (8, "cubes[]", Message(".foxglove.CubePrimitive")),
            (9, "spheres[]", Message(".foxglove.SpherePrimitive")),
            (10, "cylinders[]", Message(".foxglove.CylinderPrimitive")),
            (11, "lines[]", Message(".foxglove.LinePrimitive")),
            (12, "triangles[]", Message(".foxglove.TriangleListPrimitive")),
            (13, "texts[]", Message(".foxglove.TextPrimitive")),
            (14, "models[]", Message(".foxglove.ModelPrimitive")),
        ],
    ),
    (
        "SceneUpdate",
        &[
            (1, "deletions[]", Message(".foxglove.SceneEntityDeletion")),
            (2, "entities[]", Message(".foxglove.SceneEntity")),
        ],
    ),
    ("ArrowPrimitive", &[]),
    ("SpherePrimitive", &[]),
    ("CylinderPrimitive", &[]),
    ("LinePrimitive", &[]),
    ("TriangleListPrimitive", &[]),
    ("TextPrimitive", &[]),
    ("ModelPrimitive", &[]),
];

/// Enumerations within a message: its name, theirs, and their values from 0.
const ENUMS: &[(&str, &str, &[&str])] = &[
    (
        "PackedElementField",
        "NumericType",
        &["UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"],
    ),
    ("SceneEntityDeletion", "Type", &["MATCHING_ID", "ALL"]),
];

const SECONDS_AND_NANOS: &[Field] = &[(1, "seconds", Int64), (2, "nanos", Int32)];

/// The set of files that describes every message.
pub(super) fn descriptor_set() -> &'static Wire {
    static SET: OnceLock<Wire> = OnceLock::new();
    SET.get_or_init(|| {
        let times = ["timestamp", "duration"].map(|name| format!("google/protobuf/{name}.proto"));
        let [timestamp, duration] = &times;
        Wire::default()
            .message(
                1,
                &file(timestamp, "google.protobuf", &[], &[("Timestamp", SECONDS_AND_NANOS)]),
            )
            .message(1, &file(duration, "google.protobuf", &[], &[("Duration", SECONDS_AND_NANOS)]))
            .message(1, &file("foxglove.proto", "foxglove", &times, MESSAGES))
    })
}

/// A `FileDescriptorProto` (protobuf, `descriptor.proto`, as are those below).
fn file(name: &str, package: &str, needs: &[String], schemas: &[Schema]) -> Wire {
    let named = Wire::default().text(1, name).text(2, package);
    let linked = needs.iter().fold(named, |wire, need| wire.text(3, need));
    linked.messages(4, schemas.iter().map(descriptor)).text(12, "proto3")
}

/// A `DescriptorProto`.
fn descriptor((name, fields): &Schema) -> Wire {
    let enums = ENUMS.iter().filter(|(message, ..)| message == name);
    let enums = enums.map(|(_, name, values)| {
        let value = |(number, value): (usize, &&str)| {
            Wire::default().text(1, value).integer(2, number as u64)
        };
        Wire::default().text(1, name).messages(2, values.iter().enumerate().map(value))
    });
    Wire::default().text(1, name).messages(2, fields.iter().map(field)).messages(4, enums)
}

/// A `FieldDescriptorProto`.
fn field((number, name, kind): &Field) -> Wire {
    const OPTIONAL: u64 = 1;
    const REPEATED: u64 = 3;
    let label = if name.ends_with("[]") { REPEATED } else { OPTIONAL };
    let (kind, type_name) = match kind {
        Double => (1, None),
        Int64 => (3, None),
        Int32 => (5, None),
        Fixed32 => (7, None),
        Bool => (8, None),
        Text => (9, None),
        Message(name) => (11, Some(name)),
        Bytes => (12, None),
        Enum(name) => (14, Some(name)),
    };
    let wire = Wire::default().text(1, name.trim_end_matches("[]"));
    let wire = wire.integer(3, *number).integer(4, label).integer(5, kind);
    type_name.map_or(wire.clone(), |name| wire.text(6, name))
}
