//! Sensors of a scene, and how they are mounted.

use occlabel_core::camera::CameraModel;
use occlabel_core::{Camera, Fault, Pose};
use serde_json::{Value, json};

use crate::Drive;
use crate::write::files::Output;
use crate::write::png::mask_png;

use super::tables::{Tables, rotation, translation};

/// The token of a channel's sensor and calibration in a scene.
pub(super) fn calibration_token(scene: &str, channel: &str) -> String {
    format!("{scene}-{channel}")
}

pub(super) fn push_calibrations(
    tables: &mut Tables,
    drive: &Drive,
    output: &Output,
) -> Result<(), Fault> {
    let scene = drive.scene();
    let (lidars, poses) = (&drive.world().lidars, drive.poses());
    for (lidar, ego_from_lidar) in lidars.iter().zip(&poses.ego_from_lidar) {
        let row = mounting(&scene.name, &lidar.name, ego_from_lidar);
        push_sensor(tables, &lidar.name, "lidar", row)?;
    }
    for (named, ego_from_camera) in scene.cameras.iter().zip(&poses.ego_from_camera) {
        let mut row = mounting(&scene.name, &named.name, ego_from_camera);
        add_optics(&mut row, &named.camera.model);
        add_mask(&mut row, &scene.name, &named.name, &named.camera, output)?;
        push_sensor(tables, &named.name, "camera", row)?;
    }
    Ok(())
}

fn push_sensor(
    tables: &mut Tables,
    channel: &str,
    modality: &str,
    calibration: Value,
) -> Result<(), Fault> {
    let token = &calibration["token"];
    let sensor = json!({ "token": token, "channel": channel, "modality": modality });
    tables.push("sensor", &sensor)?;
    tables.push("calibrated_sensor", &calibration)
}

fn mounting(scene: &str, channel: &str, ego_from_sensor: &Pose) -> Value {
    let token = calibration_token(scene, channel);
    json!({
        "token": token, "sensor_token": token, "translation": translation(ego_from_sensor),
        "rotation": rotation(ego_from_sensor), "camera_intrinsic": [],
    })
}

/// The camera matrix, and the fields of models that nuScenes has not (labels.md section 2).
pub(in crate::write) fn add_optics(row: &mut Value, model: &CameraModel) {
    if let Some(lens) = model.intrinsics() {
        row["camera_intrinsic"] = json!(lens.matrix());
    }
    if !matches!(model, CameraModel::Pinhole(_)) {
        row["camera_model"] = json!(model.name());
    }
    match model {
        CameraModel::Pinhole(_) => {}
        CameraModel::Ocam(ocam) => {
            row["ocam"] = json!({
                "poly": ocam.polynomial(), "centre": ocam.centre(), "affine": ocam.affine(),
                "max_angle_rad": ocam.max_angle_rad(),
            });
        }
        _ => row["camera_distortion"] = json!(model.coefficients()),
    }
}

fn add_mask(
    row: &mut Value,
    scene: &str,
    channel: &str,
    camera: &Camera,
    output: &Output,
) -> Result<(), Fault> {
    let Some(mask) = &camera.body_mask else { return Ok(()) };
    let file = format!("body_masks/{scene}__{channel}.png");
    output.write(&file, &mask_png(mask))?;
    row["mask"] = json!(file);
    Ok(())
}
