//! The rows of the nuScenes tables, field by field as the schema has them.

use serde::Serialize;

#[derive(Serialize)]
pub(crate) struct Attribute {
    pub(crate) token: String,
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
}

#[derive(Serialize)]
pub(crate) struct CalibratedSensor {
    pub(crate) token: String,
    pub(crate) sensor_token: String,
    pub(crate) translation: [f64; 3],
    pub(crate) rotation: [f64; 4],
    /// Three rows for a camera, none for a lidar.
    pub(crate) camera_intrinsic: Vec<[f64; 3]>,
}

#[derive(Serialize)]
pub(crate) struct Category {
    pub(crate) token: String,
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
    /// Present if there are point labels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) index: Option<usize>,
}

#[derive(Serialize)]
pub(crate) struct EgoPose {
    pub(crate) token: String,
    pub(crate) timestamp: i64,
    pub(crate) rotation: [f64; 4],
    pub(crate) translation: [f64; 3],
}

#[derive(Serialize)]
pub(crate) struct Instance {
    pub(crate) token: String,
    pub(crate) category_token: String,
    pub(crate) nbr_annotations: usize,
    pub(crate) first_annotation_token: String,
    pub(crate) last_annotation_token: String,
}

#[derive(Serialize)]
pub(crate) struct Lidarseg {
    pub(crate) token: String,
    pub(crate) sample_data_token: String,
    pub(crate) filename: String,
}

#[derive(Serialize)]
pub(crate) struct Log {
    pub(crate) token: String,
    pub(crate) logfile: String,
    pub(crate) vehicle: &'static str,
    pub(crate) date_captured: &'static str,
    pub(crate) location: &'static str,
}

#[derive(Serialize)]
pub(crate) struct Map {
    pub(crate) token: String,
    pub(crate) category: &'static str,
    pub(crate) filename: String,
    pub(crate) log_tokens: Vec<String>,
}

#[derive(Serialize)]
pub(crate) struct Sample {
    pub(crate) token: String,
    pub(crate) timestamp: i64,
    pub(crate) prev: String,
    pub(crate) next: String,
    pub(crate) scene_token: String,
}

#[derive(Serialize)]
pub(crate) struct SampleAnnotation {
    pub(crate) token: String,
    pub(crate) sample_token: String,
    pub(crate) instance_token: String,
    pub(crate) visibility_token: &'static str,
    pub(crate) attribute_tokens: Vec<String>,
    pub(crate) translation: [f64; 3],
    /// Width, length, height.
    pub(crate) size: [f64; 3],
    pub(crate) rotation: [f64; 4],
    pub(crate) prev: String,
    pub(crate) next: String,
    pub(crate) num_lidar_pts: usize,
    pub(crate) num_radar_pts: usize,
}

#[derive(Serialize)]
pub(crate) struct SampleData {
    pub(crate) token: String,
    pub(crate) sample_token: String,
    pub(crate) ego_pose_token: String,
    pub(crate) calibrated_sensor_token: String,
    pub(crate) timestamp: i64,
    pub(crate) fileformat: &'static str,
    pub(crate) is_key_frame: bool,
    pub(crate) height: u32,
    pub(crate) width: u32,
    pub(crate) filename: String,
    pub(crate) prev: String,
    pub(crate) next: String,
}

#[derive(Serialize)]
pub(crate) struct Scene {
    pub(crate) token: String,
    pub(crate) log_token: String,
    pub(crate) nbr_samples: usize,
    pub(crate) first_sample_token: String,
    pub(crate) last_sample_token: String,
    pub(crate) name: String,
    pub(crate) description: &'static str,
}

#[derive(Serialize)]
pub(crate) struct Sensor {
    pub(crate) token: String,
    pub(crate) channel: &'static str,
    pub(crate) modality: &'static str,
}

#[derive(Serialize)]
pub(crate) struct Visibility {
    pub(crate) token: &'static str,
    pub(crate) level: &'static str,
    pub(crate) description: &'static str,
}
