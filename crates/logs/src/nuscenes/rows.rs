//! The tables' fields, as nuScenes names them (devkit, `docs/schema_nuscenes.md`).

use serde::Deserialize;

use super::number::Number;
use super::table::Table;
use super::token::Token;

/// Ties each row type to its file.
macro_rules! tables {
    ($($row:ty: $file:literal),* $(,)?) => {
        $(impl Table for $row { const FILE: &'static str = $file; })*
    };
}

tables! {
    SceneRow: "scene.json",
    Sample: "sample.json",
    SampleData: "sample_data.json",
    SampleAnnotation: "sample_annotation.json",
    EgoPose: "ego_pose.json",
    CalibratedSensor: "calibrated_sensor.json",
    Sensor: "sensor.json",
    Instance: "instance.json",
    Category: "category.json",
    Lidarseg: "lidarseg.json",
    Panoptic: "panoptic.json",
}

/// A drive.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct SceneRow {
    pub(super) name: String,
}

/// An annotated moment.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Sample {
    /// Microseconds.
    pub(super) timestamp: i64,
    pub(super) scene_token: Token,
    #[serde(default)]
    pub(super) prev: Option<Token>,
    #[serde(default)]
    pub(super) next: Option<Token>,
}

/// A sweep of a lidar, or an image.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct SampleData {
    pub(super) sample_token: Token,
    pub(super) ego_pose_token: Token,
    pub(super) calibrated_sensor_token: Token,
    pub(super) filename: String,
    /// Microseconds.
    pub(super) timestamp: i64,
    pub(super) is_key_frame: bool,
    #[serde(default)]
    pub(super) width: Option<u32>,
    #[serde(default)]
    pub(super) height: Option<u32>,
    #[serde(default)]
    pub(super) prev: Option<Token>,
    #[serde(default)]
    pub(super) next: Option<Token>,
}

/// A box at a moment. World frame, metres.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct SampleAnnotation {
    pub(super) sample_token: Token,
    pub(super) instance_token: Token,
    pub(super) translation: [Number; 3],
    /// Width, length, height.
    pub(super) size: [Number; 3],
    pub(super) rotation: [Number; 4],
    #[serde(default)]
    pub(super) prev: Option<Token>,
    #[serde(default)]
    pub(super) next: Option<Token>,
}

/// `world_from_ego` at a moment, metres.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct EgoPose {
    pub(super) translation: [Number; 3],
    pub(super) rotation: [Number; 4],
}

/// A sensor's mounting, `ego_from_sensor`, metres, and a camera's optics.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct CalibratedSensor {
    pub(super) sensor_token: Token,
    pub(super) translation: [Number; 3],
    pub(super) rotation: [Number; 4],
    /// Rows of the camera matrix; none for other sensors.
    #[serde(default)]
    pub(super) camera_intrinsic: Vec<Vec<Number>>,
    #[serde(default)]
    pub(super) camera_model: Option<String>,
    #[serde(default)]
    pub(super) camera_distortion: Option<Vec<Number>>,
    #[serde(default)]
    pub(super) ocam: Option<OcamFields>,
    /// File of an image that is not zero on the vehicle's own body.
    #[serde(default)]
    pub(super) mask: Option<String>,
}

/// Scaramuzza's omnidirectional model.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct OcamFields {
    /// Ascending powers of the radius.
    pub(super) poly: Vec<Number>,
    /// Column and row, pixels.
    pub(super) centre: [Number; 2],
    pub(super) affine: Affine,
    pub(super) max_angle_rad: Number,
}

/// The affine part of the model: pixel = [c d; e 1] sensor + centre.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Affine {
    /// c, d, e.
    Short([Number; 3]),
    /// The whole matrix, row by row.
    Matrix([[Number; 2]; 2]),
}

/// A sensor of the vehicle.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Sensor {
    pub(super) channel: String,
    /// `lidar`, `camera` or `radar`.
    pub(super) modality: String,
}

/// A track.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Instance {
    pub(super) category_token: Token,
}

/// What boxes and points can be.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Category {
    pub(super) name: String,
    /// The raw point label.
    #[serde(default)]
    pub(super) index: Option<u16>,
}

/// A file of one raw label a point.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Lidarseg {
    pub(super) sample_data_token: Token,
    pub(super) filename: String,
}

/// A file of one raw label and instance a point.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Panoptic {
    pub(super) sample_data_token: Token,
    pub(super) filename: String,
}
