//! The parsers of MCAP logs, for whoever throws bytes at them.

use occlabel_testkit::in_folder;

use super::cameras::model;
use super::container::{Message, MessageAt};
use super::contents::{Channel, Schema};
use super::dispatch::{Decoded, decode};
use super::frames::checked_pose;
use super::points::Points;
use super::samples::{TELLINGS, drive, file, options};
use super::{McapLog, McapOptions};
use crate::SceneSource;

/// A whole file, read as far as it goes; whether it was whole.
pub(crate) fn read_file(bytes: &[u8]) -> bool {
    [false, true].into_iter().all(|recover| {
        in_folder(&[("a.mcap", bytes)], |root| {
            let options = McapOptions { recover, ..options() };
            let Ok(log) = McapLog::open(root, options) else { return false };
            let _ = log.describe("a");
            let Ok(scene) = log.load("a") else { return false };
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            scene.refused.is_empty() && read == scene.sweeps.len()
        })
    })
}

/// Files of every encoding and compression.
pub(crate) fn files() -> Vec<Vec<u8>> {
    let compressions = [None, Some(mcap::Compression::Zstd), Some(mcap::Compression::Lz4)];
    let pairs = TELLINGS.into_iter().flat_map(|told| compressions.map(|packed| (told, packed)));
    pairs.map(|(told, compression)| file(&drive(told), compression)).collect()
}

/// Encodings and schemas, by the first two bytes of a message.
const ENCODINGS: [&str; 4] = ["json", "ros1", "cdr", "protobuf"];
const SCHEMAS: [&str; 15] = [
    "foxglove.PointCloud",
    "foxglove.FrameTransform",
    "foxglove.FrameTransforms",
    "foxglove.CameraCalibration",
    "foxglove.SceneUpdate",
    "foxglove.CompressedImage",
    "sensor_msgs/PointCloud2",
    "geometry_msgs/TransformStamped",
    "tf2_msgs/TFMessage",
    "sensor_msgs/CameraInfo",
    "vision_msgs/Detection3DArray",
    "visualization_msgs/MarkerArray",
    "sensor_msgs/CompressedImage",
    "sensor_msgs/Image",
    "foxglove.RawImage",
];

/// A message of the encoding and schema that its first two bytes name, and what follows from it.
pub(crate) fn read_message(bytes: &[u8]) -> bool {
    let [encoding, schema, data @ ..] = bytes else { return false };
    let name = SCHEMAS[usize::from(*schema) % SCHEMAS.len()].to_owned();
    let channel = Channel {
        topic: String::new(),
        encoding: ENCODINGS[usize::from(*encoding) % ENCODINGS.len()].to_owned(),
        schema: Schema { name, data: Vec::new() },
    };
    let at = MessageAt { block: 0, place: 0 };
    let message = Message { channel: channel.into(), log_time_ns: 0, data: data.to_vec(), at };
    match decode(&message, false) {
        Ok(Some(Decoded::Cloud(cloud))) => Points::new(&cloud).is_ok_and(|points| {
            let fields = cloud.fields.iter().filter_map(|field| points.numbers(&field.name).ok());
            fields
                .map(Iterator::count)
                .chain([points.positions().count()])
                .all(|n| n == points.len())
        }),
        Ok(Some(Decoded::Optics(optics))) => model(&optics).is_ok(),
        Ok(Some(Decoded::Links(links))) => {
            links.iter().all(|link| checked_pose(&link.parent_from_child).is_ok())
        }
        Ok(decoded) => decoded.is_some(),
        Err(_) => false,
    }
}

/// The messages of the drive in every encoding, and Foxglove's in protobuf.
pub(crate) fn messages() -> Vec<Vec<u8>> {
    let place = |list: &[&str], name: &str| list.iter().position(|known| *known == name);
    let seed = |encoding: &str, schema: &str, data: &[u8]| {
        let head = [place(&ENCODINGS, encoding), place(&SCHEMAS, schema)];
        [&head.map(|place| place.unwrap_or(0) as u8)[..], data].concat()
    };
    let samples = TELLINGS.into_iter().flat_map(drive);
    let told = samples.map(|sample| seed(sample.encoding, sample.schema, &sample.data));
    let protobuf = protobufs().into_iter().map(|(schema, data)| seed("protobuf", schema, &data));
    told.chain(protobuf).collect()
}

/// A field of bytes.
fn field(number: u8, bytes: &[u8]) -> Vec<u8> {
    [&[number << 3 | 2, bytes.len() as u8][..], bytes].concat()
}

/// The doubles 1, 2, 3, … of a message.
fn doubles(numbers: &[f64]) -> Vec<u8> {
    let double = |(number, at): (&f64, u8)| [&[at << 3 | 1][..], &number.to_le_bytes()].concat();
    numbers.iter().zip(1..).flat_map(double).collect()
}

fn protobufs() -> Vec<(&'static str, Vec<u8>)> {
    let time = field(1, &[0x08, 12, 0x10, 34]);
    let pose = [field(1, &doubles(&[1.0; 3])), field(2, &doubles(&[0.0, 0.0, 0.0, 1.0]))].concat();
    let axis = |name: &[u8], at: u8| {
        field(5, &[field(1, name), vec![0x15, at, 0, 0, 0, 0x18, 7]].concat())
    };
    let axes = [axis(b"x", 0), axis(b"y", 4), axis(b"z", 8)].concat();
    let stride = vec![0x25, 12, 0, 0, 0];
    let cloud = [time.clone(), field(2, b"f"), field(3, &pose), stride, axes, field(6, &[9; 36])];
    let turn = [field(4, &doubles(&[1.0; 3])), field(5, &doubles(&[0.0, 0.0, 0.0, 1.0]))].concat();
    let link = [time.clone(), field(2, b"map"), field(3, b"f"), turn].concat();
    let size = vec![0x15, 64, 0, 0, 0, 0x1d, 48, 0, 0, 0];
    let lens = [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0].map(f64::to_le_bytes);
    let lens = field(6, &lens.concat());
    let optics = [time.clone(), size, field(4, b"plumb_bob"), lens, field(9, b"f")];
    let cube = field(8, &[field(1, &pose), field(2, &doubles(&[1.0; 3]))].concat());
    let entity = [time.clone(), field(2, b"f"), field(3, b"id"), cube].concat();
    let scene = [field(1, &[time.clone(), vec![0x10, 1]].concat()), field(2, &entity)];
    vec![
        ("foxglove.PointCloud", cloud.concat()),
        ("foxglove.FrameTransforms", field(1, &link)),
        ("foxglove.FrameTransform", link),
        ("foxglove.CameraCalibration", optics.concat()),
        ("foxglove.SceneUpdate", scene.concat()),
        ("foxglove.CompressedImage", [time, field(2, b"png"), field(4, b"f")].concat()),
    ]
}
