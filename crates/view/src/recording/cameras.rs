//! Cameras and what they took.

use foxglove::messages::{CameraCalibration, CompressedImage};
use occlabel_core::camera::{CameraModel, Ocam};
use occlabel_core::{NamedCamera, Timestamp};

use super::common::stamp;

/// A camera's optics.
pub(super) fn calibration(time: Timestamp, named: &NamedCamera) -> CameraCalibration {
    let camera = &named.camera;
    let (model, distortion) = distortion(&camera.model);
    let matrix = camera.model.intrinsics().map_or([[0.0; 3]; 3], |lens| lens.matrix());
    CameraCalibration {
        timestamp: Some(stamp(time)),
        frame_id: named.name.clone(),
        width: camera.width,
        height: camera.height,
        distortion_model: model.to_owned(),
        d: distortion,
        k: matrix.as_flattened().to_vec(),
        r: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: matrix.iter().flat_map(|&[a, b, c]| [a, b, c, 0.0]).collect(),
    }
}

/// The name of a model, and its coefficients. `mei` and `ocam` are names of ours, as the schema has none.
fn distortion(model: &CameraModel) -> (&'static str, Vec<f64>) {
    let coefficients = model.coefficients();
    match model {
        CameraModel::Pinhole(_) => ("", coefficients),
        CameraModel::BrownConrady(_) if coefficients.len() == 5 => ("plumb_bob", coefficients),
        CameraModel::BrownConrady(_) => ("rational_polynomial", coefficients),
        CameraModel::KannalaBrandt(_) => ("kannala_brandt", coefficients),
        CameraModel::Mei(_) => ("mei", coefficients),
        CameraModel::Ocam(ocam) => ("ocam", ocam_numbers(ocam)),
    }
}

fn ocam_numbers(ocam: &Ocam) -> Vec<f64> {
    let fixed = ocam.centre().into_iter().chain(ocam.affine()).chain([ocam.max_angle_rad()]);
    fixed.chain(ocam.polynomial().iter().copied()).collect()
}

/// An image of a camera.
pub(super) fn image(time: Timestamp, camera: &str, bytes: Vec<u8>) -> CompressedImage {
    let format = if bytes.starts_with(b"\x89PNG") { "png" } else { "jpeg" };
    CompressedImage {
        timestamp: Some(stamp(time)),
        frame_id: camera.to_owned(),
        format: format.to_owned(),
        data: bytes.into(),
    }
}
