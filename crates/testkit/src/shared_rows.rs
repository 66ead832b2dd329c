//! The rows that all scenes of a log share: categories, attributes, sensors.

use crate::categories::{categories, category_index};
use crate::log_spec::LogSpec;
use crate::pose::{Pose, rotation_of, translation_of};
use crate::rig::{cameras, ego_from_lidar};
use crate::table_set::TableSet;
use crate::tables::{Attribute, CalibratedSensor, Category, Sensor, Visibility};
use crate::token::token;
use std::io;

/// The lidar's channel name.
pub(crate) const LIDAR: &str = "LIDAR_TOP";
/// Attribute names; tokens go by name.
const ATTRIBUTES: [&str; 4] =
    ["vehicle.moving", "vehicle.parked", "pedestrian.moving", "pedestrian.standing"];
/// Visibility tokens are these numbers, not hex digits.
const VISIBILITIES: [(&str, &str); 4] =
    [("1", "v0-40"), ("2", "v40-60"), ("3", "v60-80"), ("4", "v80-100")];
/// The token of the highest visibility.
pub(crate) const VISIBLE: &str = VISIBILITIES[3].0;

pub(crate) fn category_token(name: &str) -> String {
    token("category", category_index(name) as u64)
}

/// The attribute of an annotation, as far as its category has one.
pub(crate) fn attribute_tokens(category: &str, moves: bool) -> Vec<String> {
    let name = match category.split('.').next() {
        Some("vehicle") if moves => "vehicle.moving",
        Some("vehicle") => "vehicle.parked",
        Some("human") if moves => "pedestrian.moving",
        Some("human") => "pedestrian.standing",
        _ => return Vec::new(),
    };
    ATTRIBUTES.iter().position(|known| *known == name).map(attribute_token).into_iter().collect()
}

fn attribute_token(index: usize) -> String {
    token("attribute", index as u64)
}

/// The token of a channel's calibration; the lidar is channel 0, the cameras follow.
pub(crate) fn calibration_token(channel: usize) -> String {
    token("calibrated_sensor", channel as u64)
}

pub(crate) fn push_shared_rows(tables: &mut TableSet, spec: &LogSpec) -> io::Result<()> {
    tables.category.extend(category_rows(spec.labels))?;
    tables.attribute.extend(attributes())?;
    tables.visibility.extend(visibilities())?;
    push_sensor(tables, 0, LIDAR, "lidar", &ego_from_lidar(), Vec::new())?;
    if spec.cameras {
        push_cameras(tables)?;
    }
    Ok(())
}

fn category_rows(labels: bool) -> impl Iterator<Item = Category> {
    categories().enumerate().map(move |(index, name)| Category {
        token: category_token(name),
        name,
        description: "",
        index: labels.then_some(index),
    })
}

fn attributes() -> impl Iterator<Item = Attribute> {
    ATTRIBUTES.into_iter().enumerate().map(|(index, name)| Attribute {
        token: attribute_token(index),
        name,
        description: "",
    })
}

fn visibilities() -> impl Iterator<Item = Visibility> {
    let description = "visibility of whole object in percent";
    VISIBILITIES.into_iter().map(move |(token, level)| Visibility { token, level, description })
}

fn push_cameras(tables: &mut TableSet) -> io::Result<()> {
    cameras().iter().zip(1..).try_for_each(|(camera, channel)| {
        let intrinsic = camera.intrinsic().to_vec();
        let pose = camera.ego_from_camera();
        push_sensor(tables, channel, camera.channel, "camera", &pose, intrinsic)
    })
}

fn push_sensor(
    tables: &mut TableSet,
    channel: usize,
    name: &'static str,
    modality: &'static str,
    ego_from_sensor: &Pose,
    camera_intrinsic: Vec<[f64; 3]>,
) -> io::Result<()> {
    let sensor_token = token("sensor", channel as u64);
    tables.sensor.push(&Sensor { token: sensor_token.clone(), channel: name, modality })?;
    tables.calibrated_sensor.push(&CalibratedSensor {
        token: calibration_token(channel),
        sensor_token,
        translation: translation_of(ego_from_sensor),
        rotation: rotation_of(ego_from_sensor),
        camera_intrinsic,
    })
}
