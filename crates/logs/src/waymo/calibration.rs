//! The `Context` message of v1: what all frames of a segment share.

use std::io::{Read, Seek};

use occlabel_core::Fault;

use super::frame::{broken, transform};
use super::segment::{
    CameraCalibration, Inclinations, Lidar, LidarCalibration, Place, camera_name,
};
use crate::transform::{A_POSE, pose_from_matrix};
use crate::wire::{Defect, Fields, Span};

/// A segment's sensors.
#[derive(Clone, Debug, Default)]
pub(super) struct Context {
    pub(super) lidars: Vec<LidarCalibration>,
    pub(super) cameras: Vec<CameraCalibration>,
}

/// Reads a context; an absent one has no sensors.
///
/// # Errors
/// If it is no such message, or a lidar's mounting is no rigid transform.
pub(super) fn read_context<S: Read + Seek>(
    source: &mut S,
    span: Option<Span>,
    place: &Place,
) -> Result<Context, Fault> {
    let Some(span) = span else { return Ok(Context::default()) };
    let broken = |defect| broken(place, 0, defect);
    let context = Fields::read(source, span).map_err(broken)?;
    let mut lidars = Vec::new();
    for span in context.all(3) {
        let numbers = lidar(source, span).map_err(broken)?;
        lidars.extend(numbers.map(|numbers| numbers.check(place)).transpose()?);
    }
    let cameras = context.all(2).map(|span| camera(source, span, place));
    let cameras = cameras.filter_map(Result::transpose).collect::<Result<_, _>>();
    Ok(Context { lidars, cameras: cameras.map_err(broken)? })
}

/// A lidar's calibration as the format has it.
pub(super) struct LidarNumbers {
    pub(super) lidar: Lidar,
    pub(super) ego_from_lidar: Vec<f64>,
    pub(super) inclinations: Inclinations,
}

impl LidarNumbers {
    /// The calibration, if its mounting is a rigid transform.
    ///
    /// # Errors
    /// If it is not.
    pub(super) fn check(self, place: &Place) -> Result<LidarCalibration, Fault> {
        let ego_from_lidar = pose_from_matrix(&self.ego_from_lidar).map_err(|found| {
            let expected = format!("an extrinsic of {} of {A_POSE}", self.lidar.name());
            place.fault("lidar-extrinsic", expected, found)
        })?;
        let Self { lidar, inclinations, .. } = self;
        Ok(LidarCalibration { lidar, ego_from_lidar, inclinations })
    }
}

/// A lidar that has a name.
fn lidar<S: Read + Seek>(source: &mut S, span: Span) -> Result<Option<LidarNumbers>, Defect> {
    let fields = Fields::read(source, span)?;
    let Some(lidar) = fields.integer(1).and_then(Lidar::of_number) else { return Ok(None) };
    let ego_from_lidar = transform(source, fields.bytes(5))?;
    let each = fields.doubles(source, 2)?;
    let edge = |number| fields.double(number).unwrap_or(f64::NAN);
    let inclinations = match each.is_empty() {
        true => Inclinations::Between { min_rad: edge(3), max_rad: edge(4) },
        false => Inclinations::Each(each),
    };
    Ok(Some(LidarNumbers { lidar, ego_from_lidar, inclinations }))
}

/// A camera that has a name.
fn camera<S: Read + Seek>(
    source: &mut S,
    span: Span,
    place: &Place,
) -> Result<Option<CameraCalibration>, Defect> {
    let fields = Fields::read(source, span)?;
    let Some(name) = fields.integer(1).and_then(camera_name) else { return Ok(None) };
    Ok(Some(CameraCalibration {
        name,
        intrinsic: fields.doubles(source, 2)?,
        ego_from_camera: transform(source, fields.bytes(3))?,
        width: fields.integer(4).unwrap_or(0),
        height: fields.integer(5).unwrap_or(0),
        shutter_direction: fields.integer(6).unwrap_or(0),
        place: place.clone(),
    }))
}
