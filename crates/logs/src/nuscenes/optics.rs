//! A camera from its calibration (labels.md section 2).

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, ImageReader, Limits};
use occlabel_core::camera::{
    BodyMask, BrownConrady, CameraError, CameraModel, Intrinsics, KannalaBrandt, Mei, Ocam, Pinhole,
};
use occlabel_core::{Camera, Fault};
use serde::Deserialize;

use super::captures::Capture;
use super::number::{Number, plain};
use super::rows::{Affine, CalibratedSensor, OcamFields};
use super::table::Row;
use crate::files::{name_defect, read_file};

/// The camera that took an image: model, size and body mask.
///
/// # Errors
/// If the size is 0 or absent, the calibration is none of the named model, or the mask cannot be
/// read or is of another size.
pub(super) fn camera_of(root: &Path, image: &Capture<'_>) -> Result<Camera, Fault> {
    let (width, height) = (image.row.width.unwrap_or(0), image.row.height.unwrap_or(0));
    if width == 0 || height == 0 {
        let found = format!("{width} x {height} of {}", image.channel);
        return Err(image.row.fault("camera-size", "a width and a height above 0", found));
    }
    let model = model_of(image.calibration)?;
    let body_mask = match &image.calibration.mask {
        Some(file) => Some(read_mask(root, image.calibration, file, [width, height])?),
        None => None,
    };
    Ok(Camera { model, width, height, body_mask, rolling_shutter: None })
}

fn model_of(calibration: &Row<CalibratedSensor>) -> Result<CameraModel, Fault> {
    let lens = LensFields {
        camera_intrinsic: calibration.camera_intrinsic.clone(),
        camera_model: calibration.camera_model.clone(),
        camera_distortion: calibration.camera_distortion.clone(),
        ocam: calibration.ocam.clone(),
    };
    lens.model().map_err(|found| calibration.fault("camera-model", lens.expected(), found))
}

/// A camera's lens, as calibrations tell it.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct LensFields {
    #[serde(default)]
    camera_intrinsic: Vec<Vec<Number>>,
    camera_model: Option<String>,
    camera_distortion: Option<Vec<Number>>,
    ocam: Option<OcamFields>,
}

impl LensFields {
    /// The model.
    ///
    /// # Errors
    /// What was found, if the calibration is none of the named model.
    pub(crate) fn model(&self) -> Result<CameraModel, String> {
        model_named(self.name(), self).map_err(|Defect(found)| found)
    }

    /// What a calibration has to be.
    pub(crate) fn expected(&self) -> String {
        format!("a calibration of the camera model `{}`", self.name())
    }

    fn name(&self) -> &str {
        self.camera_model.as_deref().unwrap_or("pinhole")
    }
}

/// What an absent `camera_distortion` means.
const NO_DISTORTION: [f64; 4] = [0.0; 4];

fn model_named(name: &str, calibration: &LensFields) -> Result<CameraModel, Defect> {
    let distortion = calibration.camera_distortion.as_deref().map_or(NO_DISTORTION.into(), reals);
    let intrinsics = || intrinsics(&calibration.camera_intrinsic);
    Ok(match name {
        "pinhole" if distortion.iter().any(|coefficient| *coefficient != 0.0) => {
            return Err("a distortion, which needs another `camera_model`".into());
        }
        "pinhole" => CameraModel::Pinhole(Pinhole::new(intrinsics()?)),
        "brown-conrady" => {
            CameraModel::BrownConrady(BrownConrady::new(intrinsics()?, &distortion)?)
        }
        "kannala-brandt" => {
            CameraModel::KannalaBrandt(KannalaBrandt::new(intrinsics()?, &distortion)?)
        }
        "mei" => CameraModel::Mei(Mei::new(intrinsics()?, &distortion)?),
        "ocam" => CameraModel::Ocam(ocam(calibration.ocam.as_ref())?),
        _ => return Err("none of pinhole, brown-conrady, kannala-brandt, mei, ocam".into()),
    })
}

/// What is wrong with a calibration.
struct Defect(String);

impl From<CameraError> for Defect {
    fn from(error: CameraError) -> Self {
        Self(error.to_string())
    }
}

impl From<&str> for Defect {
    fn from(defect: &str) -> Self {
        Self(defect.to_owned())
    }
}

fn intrinsics(rows: &[Vec<Number>]) -> Result<Intrinsics, Defect> {
    let triples = rows.iter().map(|row| <[f64; 3]>::try_from(reals(row)));
    let triples = triples.collect::<Result<Vec<_>, _>>().unwrap_or_default();
    match <[[f64; 3]; 3]>::try_from(triples) {
        Ok(matrix) => Ok(Intrinsics::from_matrix(&matrix)?),
        Err(_) => Err("a `camera_intrinsic` that is not 3 x 3".into()),
    }
}

fn ocam(fields: Option<&OcamFields>) -> Result<Ocam, Defect> {
    let Some(fields) = fields else { return Err("no field `ocam`".into()) };
    let (poly, centre) = (reals(&fields.poly), plain(&fields.centre));
    Ok(Ocam::new(&poly, centre, affine(&fields.affine)?, fields.max_angle_rad.0)?)
}

/// c, d, e.
fn affine(affine: &Affine) -> Result<[f64; 3], Defect> {
    match affine {
        Affine::Short(numbers) => Ok(plain(numbers)),
        Affine::Matrix([[c, d], [e, one]]) if one.0 == 1.0 => Ok([c.0, d.0, e.0]),
        Affine::Matrix(_) => Err("an `affine` matrix that does not end in 1".into()),
    }
}

fn reals(numbers: &[Number]) -> Vec<f64> {
    numbers.iter().map(|number| number.0).collect()
}

/// An 8-bit image of the camera's size: what is not 0 is the vehicle's own body.
fn read_mask(
    root: &Path,
    calibration: &Row<CalibratedSensor>,
    file: &str,
    [width, height]: [u32; 2],
) -> Result<BodyMask, Fault> {
    if let Some(defect) = name_defect(file) {
        let found = format!("`{file}`, {defect}");
        return Err(calibration.fault("file-name", "a path below the log's root", found));
    }
    let record = |fault: Fault| match fault.rule {
        "camera-mask" => fault.record(calibration.token.to_string()),
        _ => fault,
    };
    mask_of(root, file, [width, height]).map_err(record)
}

/// The body mask of a file below the log's root.
///
/// # Errors
/// If it cannot be read, or is of another size.
pub(crate) fn mask_of(
    root: &Path,
    file: &str,
    [width, height]: [u32; 2],
) -> Result<BodyMask, Fault> {
    let expected = format!("a mask of {width} x {height} pixels");
    let fault = |found: String| Fault::new("camera-mask", file, &expected, found);
    let bytes = read_file(root, file)?;
    let pixels = decode(bytes, width, height).map_err(fault)?;
    let covered = pixels.iter().map(|&value| value != 0).collect();
    BodyMask::new(width, height, covered).map_err(|error| fault(error.to_string()))
}

/// The grey values of a PNG of this size.
pub(crate) fn decode(bytes: Vec<u8>, width: u32, height: u32) -> Result<Vec<u8>, String> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(width), Some(height));
    reader.limits(limits);
    let pixels = reader.decode().map_err(|error| error.to_string())?.into_luma8();
    match pixels.dimensions() == (width, height) {
        true => Ok(pixels.into_raw()),
        false => Err(format!("{} x {} pixels", pixels.width(), pixels.height())),
    }
}
