//! A short drive as MCAP, in every encoding that is read but protobuf.
//!
//! The ego drives 4 m ahead within a second; at half of it a lidar and a camera look, and there is a
//! car:
//!
//! ```text
//!   map -> base    (10, 0, 0) at 0 s, (14, 0, 0) at 1 s     topic /odometry
//!   base -> lidar  (1, 0, 1.5), turned left                 topic /mounts
//!   base -> eye    (1.5, 0, 1.2), looking ahead             topic /mounts
//!   cloud          (1, 2, 3) seen at 0.5 s, (4, 5, 6) seen at 0.75 s, labelled 7 and 9
//!   car            4 x 2 x 1.5 m at (5, 0, 0.75) in base
//! ```

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_SQRT_2;
use std::io::Cursor;

use mcap::WriteOptions;
use mcap::records::MessageHeader;
use occlabel_core::{ClassId, ClassSet, McapSettings, Meaning, Taxonomy};
use serde_json::{Value, json};

use super::ros::Layout;
use super::ros_writer::Writer;
use super::{McapOptions, TimeSource};
use crate::ReadOptions;

/// When the drive begins, nanoseconds.
pub(crate) const BEGIN_NS: i64 = 1_700_000_000_000_000_000;
/// When the sensors look.
pub(crate) const LOOK_NS: i64 = BEGIN_NS + 500_000_000;

const LEFT: [f64; 4] = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
const AHEAD: [f64; 4] = [-0.5, 0.5, -0.5, 0.5];
const NO_TURN: [f64; 4] = [0.0, 0.0, 0.0, 1.0];
/// Topic, time, parent, child, place, rotation.
type Link = (&'static str, i64, &'static str, &'static str, [f64; 3], [f64; 4]);
const LINKS: [Link; 4] = [
    ("/odometry", BEGIN_NS, "map", "base", [10.0, 0.0, 0.0], NO_TURN),
    ("/odometry", BEGIN_NS + 1_000_000_000, "map", "base", [14.0, 0.0, 0.0], NO_TURN),
    ("/mounts", BEGIN_NS, "base", "lidar", [1.0, 0.0, 1.5], LEFT),
    ("/mounts", BEGIN_NS, "base", "eye", [1.5, 0.0, 1.2], AHEAD),
];
const POINTS: [([f32; 3], u8, u32); 2] =
    [([1.0, 2.0, 3.0], 7, 0), ([4.0, 5.0, 6.0], 9, 250_000_000)];
const STRIDE: u32 = 25;
/// Name, offset, and type in PointCloud2 and in PackedElementField.
const FIELDS: [(&str, u32, u8, u8); 6] = [
    ("x", 0, 7, 7),
    ("y", 4, 7, 7),
    ("z", 8, 7, 7),
    ("label", 12, 2, 1),
    ("offset", 13, 6, 5),
    ("stamp", 17, 8, 8),
];
const LENS: [f64; 9] = [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0];
const BENT: [f64; 5] = [0.1, 0.0, 0.0, 0.0, 0.0];
const CAR: [f64; 3] = [5.0, 0.0, 0.75];
const CAR_SIZE: [f64; 3] = [4.0, 2.0, 1.5];

/// How the drive is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Told {
    Json,
    /// Boxes as markers.
    Ros1,
    /// Boxes as markers.
    Cdr,
    /// Boxes as detections.
    CdrDetections,
}

/// Every way to tell it.
pub(crate) const TELLINGS: [Told; 4] = [Told::Json, Told::Ros1, Told::Cdr, Told::CdrDetections];

/// A message on its way into a file.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    pub(crate) topic: &'static str,
    pub(crate) encoding: &'static str,
    pub(crate) schema: &'static str,
    pub(crate) time_ns: i64,
    pub(crate) data: Vec<u8>,
}

/// The drive's messages.
pub(crate) fn drive(told: Told) -> Vec<Sample> {
    match told {
        Told::Json => json_drive(),
        Told::Ros1 => ros_drive(Layout::Ros1, markers),
        Told::Cdr => ros_drive(Layout::Cdr, markers),
        Told::CdrDetections => ros_drive(Layout::Cdr, detections),
    }
}

/// Messages as a file whose chunk is verified by nothing, or is compressed and has a checksum.
pub(crate) fn file(samples: &[Sample], compression: Option<mcap::Compression>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().calculate_chunk_crcs(compression.is_some());
    let mut writer = options.compression(compression).create(&mut bytes).unwrap();
    for sample in samples {
        let (topic, encoding) = (sample.topic, sample.encoding);
        let schema = writer.add_schema(sample.schema, encoding, b"").unwrap();
        let channel_id = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
        let time = sample.time_ns as u64;
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &sample.data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

/// What the drive is read by: 7 is a `rock`, a `car` is a `thing`, as is what is unknown.
pub(crate) fn options() -> McapOptions {
    let meaning = Meaning::Class(ClassId(0));
    let taxonomy = Taxonomy {
        names: vec!["thing".into()],
        free: 1,
        unknown: None,
        things: ClassSet::default(),
        movers: ClassSet::default(),
        deformable: ClassSet::default(),
        flat: ClassSet::default(),
        rank: vec![0],
        points: BTreeMap::from([("rock".to_owned(), meaning)]),
        boxes: BTreeMap::from([("car".to_owned(), meaning)]),
    };
    let read = ReadOptions { unknown_as: Some(ClassId(0)), ..ReadOptions::of(taxonomy) };
    let classes = BTreeMap::from([("7".to_owned(), "rock".to_owned())]);
    let settings = McapSettings { classes, max_record_bytes: 1 << 20, ..McapSettings::default() };
    McapOptions { read, settings, time_source: TimeSource::Header, recover: false }
}

fn cloud_bytes() -> Vec<u8> {
    let point = |([x, y, z], label, offset): &([f32; 3], u8, u32)| {
        let place = [x, y, z].map(|metres| metres.to_le_bytes()).concat();
        let stamp = (LOOK_NS + i64::from(*offset)) as f64 * 1e-9;
        let (offset, stamp) = (offset.to_le_bytes().to_vec(), stamp.to_le_bytes().to_vec());
        [place, vec![*label], offset, stamp].concat()
    };
    POINTS.iter().flat_map(point).collect()
}

fn json_drive() -> Vec<Sample> {
    let sample = |topic, schema, time_ns, message: Value| Sample {
        topic,
        encoding: "json",
        schema,
        time_ns,
        data: message.to_string().into_bytes(),
    };
    let link = |(topic, time_ns, parent, child, place, turn): Link| {
        let message = json!({ "timestamp": json_time(time_ns), "parent_frame_id": parent,
            "child_frame_id": child, "translation": axes(&place), "rotation": axes(&turn) });
        sample(topic, "foxglove.FrameTransform", time_ns, message)
    };
    let field = |(name, offset, _, kind): (&str, u32, u8, u8)| json!({ "name": name, "offset": offset, "type": kind });
    let pose = json!({ "position": axes(&[0.0; 3]), "orientation": axes(&NO_TURN) });
    let time = json_time(LOOK_NS);
    let cloud = json!({ "timestamp": time, "frame_id": "lidar", "pose": pose,
        "point_stride": STRIDE, "fields": FIELDS.map(field), "data": base_64(&cloud_bytes()) });
    let optics = json!({ "timestamp": time, "frame_id": "eye", "width": 640, "height": 480,
        "distortion_model": "plumb_bob", "D": BENT, "K": LENS });
    let place = json!({ "position": axes(&CAR), "orientation": axes(&NO_TURN) });
    let boxes = json!({ "deletions": [{ "timestamp": time, "type": 1 }], "entities": [{
        "timestamp": time, "frame_id": "base", "id": "car/7",
        "metadata": [{ "key": "category", "value": "car" }],
        "cubes": [{ "pose": place, "size": axes(&CAR_SIZE) }] }] });
    LINKS
        .into_iter()
        .map(link)
        .chain([
            sample("/points", "foxglove.PointCloud", LOOK_NS, cloud),
            sample("/optics", "foxglove.CameraCalibration", LOOK_NS, optics),
            sample("/boxes", "foxglove.SceneUpdate", LOOK_NS, boxes),
        ])
        .collect()
}

fn json_time(time_ns: i64) -> Value {
    json!({ "sec": time_ns / 1_000_000_000, "nsec": time_ns % 1_000_000_000 })
}

fn axes(numbers: &[f64]) -> Value {
    ["x", "y", "z", "w"]
        .into_iter()
        .zip(numbers)
        .map(|(axis, number)| (axis.to_owned(), json!(number)))
        .collect()
}

/// RFC 4648 section 4.
fn base_64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| u32::from(*three.get(i).unwrap_or(&0)));
        let bits = a << 16 | b << 8 | c;
        let digits = [18, 12, 6, 0].map(|shift| DIGITS[(bits >> shift & 63) as usize]);
        let used = three.len() + 1;
        text.extend(digits.iter().take(used).map(|digit| char::from(*digit)));
        text.extend(std::iter::repeat_n('=', 4 - used));
    }
    text
}

fn ros_drive(layout: Layout, boxes: fn(Layout) -> (&'static str, Vec<u8>)) -> Vec<Sample> {
    let encoding = if layout == Layout::Cdr { "cdr" } else { "ros1" };
    let sample = |topic, schema, time_ns, data| Sample { topic, encoding, schema, time_ns, data };
    let link = |(topic, time_ns, parent, child, place, turn): Link| {
        let mut writer = Writer::new(layout);
        writer.header_at(time_ns, parent).text(child).f64s(&place).f64s(&turn);
        sample(topic, "geometry_msgs/TransformStamped", time_ns, writer.finish())
    };
    let mut cloud = Writer::new(layout);
    cloud.header_at(LOOK_NS, "lidar").u32(1).u32(POINTS.len() as u32).u32(FIELDS.len() as u32);
    for (name, offset, kind, _) in FIELDS {
        cloud.text(name).u32(offset).u8(kind).u32(1);
    }
    let points = cloud_bytes();
    cloud.u8(0).u32(STRIDE).u32(points.len() as u32).blob(&points).u8(1);
    let mut optics = Writer::new(layout);
    optics.header_at(LOOK_NS, "eye").u32(480).u32(640).text("plumb_bob").u32(5);
    optics.f64s(&BENT).f64s(&LENS);
    let (schema, boxes) = boxes(layout);
    LINKS
        .into_iter()
        .map(link)
        .chain([
            sample("/points", "sensor_msgs/PointCloud2", LOOK_NS, cloud.finish()),
            sample("/optics", "sensor_msgs/CameraInfo", LOOK_NS, optics.finish()),
            sample("/boxes", schema, LOOK_NS, boxes),
        ])
        .collect()
}

fn markers(layout: Layout) -> (&'static str, Vec<u8>) {
    const CUBE: u32 = 1;
    const ADD: u32 = 0;
    let mut writer = Writer::new(layout);
    writer.u32(1).header_at(LOOK_NS, "base").text("car").u32(7).u32(CUBE).u32(ADD);
    writer.f64s(&CAR).f64s(&NO_TURN).f64s(&CAR_SIZE);
    // Colour, lifetime, not locked, no points, no colours, no text, no mesh.
    (0..6).for_each(|_| {
        writer.u32(0);
    });
    writer.u8(0).u32(0).u32(0).text("").text("").u8(0);
    ("visualization_msgs/MarkerArray", writer.finish())
}

fn detections(layout: Layout) -> (&'static str, Vec<u8>) {
    let mut writer = Writer::new(layout);
    writer.header_at(LOOK_NS, "base").u32(1).header_at(LOOK_NS, "base").u32(1);
    writer.text("car").f64s(&[0.9]).f64s(&[0.0; 43]);
    writer.f64s(&CAR).f64s(&NO_TURN).f64s(&CAR_SIZE).text("car/7");
    ("vision_msgs/Detection3DArray", writer.finish())
}
