//! Sensors of a scene, and how they are mounted.

use image::ExtendedColorType;
use occlabel_core::camera::{BodyMask, CameraModel};
use occlabel_core::{Camera, Fault, Pose};
use serde_json::{Value, json};

use crate::Drive;
use crate::write::files::Output;
use crate::write::png::png;

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
    for lidar in &drive.world().lidars {
        let Some(sweep) = scene.sweeps.iter().find(|sweep| sweep.lidar == lidar.name) else {
            continue;
        };
        let row = mounting(&scene.name, &lidar.name, &sweep.ego_from_lidar);
        push_sensor(tables, &lidar.name, "lidar", row)?;
    }
    for (at, named) in scene.cameras.iter().enumerate() {
        let mut row = mounting(&scene.name, &named.name, &drive.ego_from_camera(at));
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
fn add_optics(row: &mut Value, model: &CameraModel) {
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

/// A mask as an 8-bit PNG: 255 on the vehicle's own body.
pub(crate) fn mask_png(mask: &BodyMask) -> Vec<u8> {
    let (width, height) = (mask.width(), mask.height());
    let row = |row| (0..width).map(move |column| 255 * u8::from(mask.covers(column, row)));
    let pixels: Vec<u8> = (0..height).flat_map(row).collect();
    png(&pixels, [width, height], ExtendedColorType::L8)
}
