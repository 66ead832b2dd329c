//! The sweeps of a scene: points, labels, and their rows.

use std::collections::BTreeMap;

use occlabel_core::{Fault, Keyframe, Pose, Scene, SweepHeader, Timestamp};
use serde_json::{Value, json};

use crate::Drive;
use crate::write::files::Output;
use crate::write::points::{LoggedPoint, logged_points};
use crate::write::raw_names::RawNames;

use super::VERSION;
use super::calibrations::calibration_token;
use super::scene::{micros, sample_at, sample_token};
use super::tables::{Tables, neighbours, rotation, translation};

/// The intensity of every return: materials have none here.
const INTENSITY: f32 = 40.0;

/// A key sweep of a lidar other than the reference one is at most this far from its keyframe,
/// seconds: as near as an image has to be (labels.md section 2).
const KEY_WITHIN_S: f64 = 0.1;

/// What writing the sweeps told.
#[derive(Debug, Default)]
pub(super) struct Swept {
    /// Points of all sweeps.
    pub(super) points: usize,
    /// By keyframe's sweep and mover: how many of its returns.
    pub(super) hits: BTreeMap<(usize, usize), usize>,
}

/// Something that a sensor took once.
pub(super) struct Capture {
    pub(super) channel: String,
    pub(super) time: Timestamp,
    /// The sample, and whether it is one of its key captures.
    pub(super) sample: (String, bool),
    pub(super) world_from_ego: Pose,
    pub(super) fileformat: &'static str,
    pub(super) file: String,
    /// Columns and rows of an image, 0 else.
    pub(super) size: [u32; 2],
}

pub(super) fn write_sweeps(
    drive: &Drive,
    names: &RawNames,
    tables: &mut Tables,
    output: &Output,
) -> Result<Swept, Fault> {
    let scene = drive.scene();
    let keys = key_sweeps(scene);
    let mut swept = Swept::default();
    let mut captures: BTreeMap<&str, Vec<Capture>> = BTreeMap::new();
    for (sweep, header) in scene.sweeps.iter().enumerate() {
        let capture = capture(drive, header, keys.get(&sweep).copied());
        let points = logged_points(drive, sweep);
        output.write(&capture.file, &cloud_bytes(&points))?;
        if header.labelled {
            write_labels(&scene.name, &capture, &label_bytes(&points, names), tables, output)?;
        }
        swept.points += points.len();
        if scene.keyframes.iter().any(|keyframe| keyframe.sweep == sweep) {
            count_hits(&mut swept, sweep, &points);
        }
        captures.entry(&header.lidar).or_default().push(capture);
    }
    captures.values().try_for_each(|captures| push_captures(tables, &scene.name, captures))?;
    Ok(swept)
}

/// By sweep: the keyframe whose key sweep of its lidar it is.
fn key_sweeps(scene: &Scene) -> BTreeMap<usize, &Keyframe> {
    let mut keys: BTreeMap<_, _> = scene.keyframes.iter().map(|key| (key.sweep, key)).collect();
    for keyframe in &scene.keyframes {
        let reference = &scene.reference_sweep(keyframe).lidar;
        let mut nearest: BTreeMap<&str, (f64, usize)> = BTreeMap::new();
        for (sweep, header) in scene.sweeps.iter().enumerate() {
            let apart_s = header.time.seconds_apart(keyframe.time);
            let near = apart_s <= KEY_WITHIN_S && header.lidar != *reference;
            let best = nearest.get(header.lidar.as_str()).is_none_or(|best| apart_s < best.0);
            if near && best && !keys.contains_key(&sweep) {
                nearest.insert(&header.lidar, (apart_s, sweep));
            }
        }
        keys.extend(nearest.into_values().map(|(_, sweep)| (sweep, keyframe)));
    }
    keys
}

fn capture(drive: &Drive, header: &SweepHeader, key: Option<&Keyframe>) -> Capture {
    let scene = &drive.scene().name;
    let sample = match key {
        Some(keyframe) => (sample_token(scene, keyframe), true),
        None => (sample_at(drive, header.time), false),
    };
    Capture {
        channel: header.lidar.clone(),
        time: header.time,
        file: capture_file(scene, &header.lidar, header.time, sample.1, "pcd.bin"),
        sample,
        world_from_ego: header.world_from_ego,
        fileformat: "pcd",
        size: [0, 0],
    }
}

/// The file of a capture, as nuScenes names it.
pub(super) fn capture_file(
    scene: &str,
    channel: &str,
    time: Timestamp,
    key: bool,
    ending: &str,
) -> String {
    let folder = if key { "samples" } else { "sweeps" };
    format!("{folder}/{channel}/{scene}__{channel}__{}.{ending}", micros(time))
}

/// Adds the rows of all captures of a channel, in order of time.
pub(super) fn push_captures(
    tables: &mut Tables,
    scene: &str,
    captures: &[Capture],
) -> Result<(), Fault> {
    let token = |at: usize| captures[at].token(scene);
    for (at, capture) in captures.iter().enumerate() {
        tables.push("ego_pose", &capture.ego_pose(scene))?;
        tables.push("sample_data", &capture.row(scene, neighbours(at, captures.len(), token)))?;
    }
    Ok(())
}

impl Capture {
    /// A sweep's token may name a keyframe: it ends in its time in nanoseconds.
    fn token(&self, scene: &str) -> String {
        format!("{scene}-{}-{}", self.channel, self.time.0)
    }

    fn ego_pose(&self, scene: &str) -> Value {
        json!({
            "token": self.token(scene), "timestamp": micros(self.time),
            "rotation": rotation(&self.world_from_ego),
            "translation": translation(&self.world_from_ego),
        })
    }

    fn row(&self, scene: &str, [prev, next]: [String; 2]) -> Value {
        let (token, [width, height]) = (self.token(scene), self.size);
        json!({
            "token": token, "sample_token": self.sample.0, "ego_pose_token": token,
            "calibrated_sensor_token": calibration_token(scene, &self.channel),
            "timestamp": micros(self.time), "fileformat": self.fileformat,
            "is_key_frame": self.sample.1, "height": height, "width": width,
            "filename": self.file, "prev": prev, "next": next,
        })
    }
}

/// Little-endian f32: x, y, z, intensity, ring.
fn cloud_bytes(points: &[LoggedPoint]) -> Vec<u8> {
    let columns = points.iter().flat_map(|point| {
        let [x, y, z] = point.position_m.into();
        [x, y, z, INTENSITY, f32::from(point.ring)]
    });
    columns.flat_map(f32::to_le_bytes).collect()
}

fn label_bytes(points: &[LoggedPoint], names: &RawNames) -> Vec<u8> {
    points.iter().map(|point| names.number(point.label)).collect()
}

fn write_labels(
    scene: &str,
    capture: &Capture,
    labels: &[u8],
    tables: &mut Tables,
    output: &Output,
) -> Result<(), Fault> {
    let token = capture.token(scene);
    let file = format!("lidarseg/{VERSION}/{token}_lidarseg.bin");
    output.write(&file, labels)?;
    // nuScenes gives the row the token of the sample_data that it labels.
    let row = json!({ "token": token, "sample_data_token": token, "filename": file });
    tables.push("lidarseg", &row)
}

fn count_hits(swept: &mut Swept, sweep: usize, points: &[LoggedPoint]) {
    for mover in points.iter().filter_map(|point| point.mover) {
        *swept.hits.entry((sweep, mover)).or_default() += 1;
    }
}
