//! A tiny drive, written as MCAP and read back by the mcap crate and a decoder that knows protobuf's
//! wire format only.

use std::collections::BTreeMap;

use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Pose, Taxonomy, Timestamp};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, Images, Output, World, render, write_mcap};

const TINY: &str = include_str!("tiny.toml");

fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

fn drive() -> Drive {
    let small = TINY
        .replace("800", "80")
        .replace("450", "45")
        .replace("400.0", "40.0")
        .replace("225.0", "22.5");
    Drive::new(World::parse(&small, "tiny.toml").unwrap(), &taxonomy()).unwrap()
}

fn logged(drive: &Drive) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let output = Output::create(folder.path()).unwrap();
    let (written, last) = write_mcap(drive, &taxonomy(), Images::Keyframes, &output).unwrap();
    assert_eq!((written.sweeps, written.keyframes, written.boxes), (42, 5, 20));
    output.finish(&last).unwrap();
    std::fs::read(folder.path().join("tiny.mcap")).unwrap()
}

/// A field's value: a number's bits, or bytes.
#[derive(Clone, Debug)]
enum Value {
    Bits(u64),
    Bytes(Vec<u8>),
}

/// A decoded message.
#[derive(Debug)]
struct Message(Vec<(u64, Value)>);

fn varint(bytes: &mut &[u8]) -> u64 {
    let length = bytes.iter().position(|byte| *byte < 0x80).unwrap() + 1;
    let (number, rest) = bytes.split_at(length);
    *bytes = rest;
    number.iter().rev().fold(0, |sum, byte| sum << 7 | u64::from(byte & 0x7f))
}

impl Message {
    fn of(mut bytes: &[u8]) -> Self {
        let mut fields = Vec::new();
        while !bytes.is_empty() {
            let tag = varint(&mut bytes);
            let length = match tag & 7 {
                0 => {
                    fields.push((tag >> 3, Value::Bits(varint(&mut bytes))));
                    continue;
                }
                1 => 8,
                5 => 4,
                2 => varint(&mut bytes) as usize,
                kind => panic!("wire type {kind}"),
            };
            let (value, rest) = bytes.split_at(length);
            bytes = rest;
            let mut bits = [0; 8];
            bits[..length.min(8)].copy_from_slice(&value[..length.min(8)]);
            fields.push(match tag & 7 {
                2 => (tag >> 3, Value::Bytes(value.to_vec())),
                _ => (tag >> 3, Value::Bits(u64::from_le_bytes(bits))),
            });
        }
        Self(fields)
    }

    fn all(&self, field: u64) -> impl Iterator<Item = &Value> {
        self.0.iter().filter(move |(number, _)| *number == field).map(|(_, value)| value)
    }

    fn bits(&self, field: u64) -> u64 {
        match self.all(field).next() {
            Some(Value::Bits(bits)) => *bits,
            other => panic!("{field}: {other:?}"),
        }
    }

    fn bytes(&self, field: u64) -> &[u8] {
        match self.all(field).next() {
            Some(Value::Bytes(bytes)) => bytes,
            other => panic!("{field}: {other:?}"),
        }
    }

    fn text(&self, field: u64) -> &str {
        std::str::from_utf8(self.bytes(field)).unwrap()
    }

    fn message(&self, field: u64) -> Self {
        Self::of(self.bytes(field))
    }

    fn messages(&self, field: u64) -> Vec<Self> {
        let inner = |value: &Value| match value {
            Value::Bytes(bytes) => Self::of(bytes),
            Value::Bits(_) => panic!("{field}: a number"),
        };
        self.all(field).map(inner).collect()
    }

    fn double(&self, field: u64) -> f64 {
        f64::from_bits(self.bits(field))
    }

    fn time(&self) -> Timestamp {
        let stamp = self.message(1);
        Timestamp((stamp.bits(1) * 1_000_000_000 + stamp.bits(2)) as i64)
    }
}

fn pose(translation: &Message, rotation: &Message) -> Pose {
    let [x, y, z] = [1, 2, 3].map(|field| translation.double(field));
    let [i, j, k, w] = [1, 2, 3, 4].map(|field| rotation.double(field));
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
    Pose::from_parts(Translation3::new(x, y, z), rotation)
}

/// Messages by topic.
fn messages(file: &[u8]) -> BTreeMap<String, Vec<Message>> {
    let mut found: BTreeMap<String, Vec<Message>> = BTreeMap::new();
    let mut last = 0;
    for message in mcap::MessageStream::new(file).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.as_ref().unwrap();
        assert_eq!((schema.encoding.as_str(), message.log_time >= last), ("protobuf", true));
        last = message.log_time;
        found.entry(message.channel.topic.clone()).or_default().push(Message::of(&message.data));
    }
    found
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let drive = drive();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| logged(&drive))
    };
    assert!(on(1) == on(2));
}

#[test]
fn transforms_are_the_drives_to_the_last_digit() {
    let drive = drive();
    let found = messages(&logged(&drive));
    let mut placed = BTreeMap::new();
    let mut mounted = BTreeMap::new();
    for message in &found["/tf"] {
        let transform = pose(&message.message(4), &message.message(5));
        match (message.text(2), message.text(3)) {
            ("map", "base_link") => placed.insert(message.time(), transform).map(drop),
            ("base_link", sensor) => mounted.insert(sensor.to_owned(), transform).map(drop),
            other => panic!("{other:?}"),
        };
    }
    let scene = drive.scene();
    for sweep in &scene.sweeps {
        assert_eq!(placed[&sweep.time], sweep.world_from_ego);
        assert_eq!(mounted[&sweep.lidar], sweep.ego_from_lidar);
    }
    for exposure in scene.keyframes.iter().flat_map(|keyframe| &keyframe.exposures) {
        assert_eq!(placed[&exposure.time] * mounted["CAM_FRONT"], exposure.world_from_camera);
    }
}

#[test]
fn clouds_have_points_labels_rings_and_times() {
    let drive = drive();
    let found = messages(&logged(&drive));
    let mut labelled = 0;
    for (lidar, stride) in [("LIDAR_TOP", [14, 15]), ("ROSETTE", [18, 19])] {
        let clouds = &found[&format!("/{lidar}/points")];
        let headers = drive.scene().sweeps.iter().enumerate().filter(|(_, h)| h.lidar == lidar);
        assert_eq!(clouds.len(), headers.clone().count());
        for (message, (sweep, header)) in clouds.iter().zip(headers) {
            let fields = message.messages(5);
            let names: Vec<_> = fields.iter().map(|field| field.text(1)).collect();
            assert_eq!((message.time(), message.text(2)), (header.time, lidar));
            assert_eq!(names.contains(&"label"), header.labelled);
            assert_eq!(names.contains(&"offset_ns"), lidar == "ROSETTE");
            let step = stride[usize::from(header.labelled)];
            assert_eq!(message.bits(4), step as u64);
            let (data, cloud) = (message.bytes(6), drive.points(sweep));
            assert_eq!(data.len(), step * cloud.len());
            for (point, told) in data.chunks_exact(step).zip(&cloud.positions) {
                let number = |at: usize| f32::from_le_bytes(point[at..at + 4].try_into().unwrap());
                assert_eq!(Point3::new(number(0), number(4), number(8)), told.cast::<f32>());
            }
            labelled += usize::from(header.labelled);
        }
    }
    assert_eq!(labelled, 5);
}

#[test]
fn boxes_stand_at_keyframes_under_their_tracks_names() {
    let drive = drive();
    let found = messages(&logged(&drive));
    let (scene, mut count) = (drive.scene(), 0);
    for (update, keyframe) in found["/annotations"].iter().zip(&scene.keyframes) {
        for (entity, track) in update.messages(2).iter().zip(&scene.tracks) {
            let (_, boxed) = track.boxes.iter().find(|(time, _)| *time == keyframe.time).unwrap();
            let (cube, category) = (entity.message(8), entity.message(6));
            let size_m: [f64; 3] = boxed.size_m.into();
            assert_eq!((entity.time(), entity.text(3)), (keyframe.time, track.source_id.as_str()));
            assert_eq!((category.text(1), category.text(2)), ("category", track.category.as_str()));
            let standing = cube.message(1);
            assert_eq!(pose(&standing.message(1), &standing.message(2)), boxed.world_from_box);
            assert_eq!([1, 2, 3].map(|side| cube.message(2).double(side)), size_m);
            count += 1;
        }
    }
    assert_eq!(count, 20);
}

#[test]
fn cameras_tell_their_optics_and_pictures() {
    let drive = drive();
    let found = messages(&logged(&drive));
    let (optics, pictures) = (&found["/CAM_FRONT/calibration"], &found["/CAM_FRONT/image"]);
    let keyframes = &drive.scene().keyframes;
    assert_eq!((optics.len(), pictures.len()), (keyframes.len(), keyframes.len()));
    for ((lens, picture), keyframe) in optics.iter().zip(pictures).zip(keyframes) {
        assert_eq!(
            (lens.bits(2), lens.bits(3), lens.text(4), lens.text(9)),
            (80, 45, "", "CAM_FRONT")
        );
        let matrix: Vec<f64> = lens
            .bytes(6)
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(matrix, [40.0, 0.0, 40.0, 0.0, 40.0, 22.5, 0.0, 0.0, 1.0]);
        assert_eq!(picture.time(), keyframe.exposures[0].time);
        let decoded = image::load_from_memory(picture.bytes(2)).unwrap().into_rgb8();
        assert_eq!(decoded.into_raw(), render(&drive, &keyframe.exposures[0]).rgb);
    }
}
