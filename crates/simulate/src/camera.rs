//! A camera of a world: mounting, model and exposure times.

use nalgebra::{Quaternion, UnitQuaternion};
use occlabel_core::camera::{
    BrownConrady, CameraError, CameraModel, Intrinsics, KannalaBrandt, Mei, Ocam, Pinhole,
    RollingShutter, ShutterDirection,
};
use occlabel_core::{Camera, Fault, NamedCamera, Pose};
use serde::Deserialize;

use crate::body_mask::{MaskPart, body_mask};
use crate::check::{inside, need, within};
use crate::clock::Clock;
use crate::rotation::PoseFile;

/// A `[[camera]]` of a world file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    name: String,
    mounting: PoseFile,
    model: ModelFile,
    width: u32,
    height: u32,
    rate_hz: f64,
    #[serde(default)]
    pub(crate) offset_s: f64,
    #[serde(default)]
    body_mask: Vec<MaskPart>,
    rolling_shutter: Option<ShutterFile>,
}

/// How a rolling shutter reads an image. The log tells it; images are rendered as if all lines were
/// exposed at once.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ShutterFile {
    #[serde(with = "DirectionFile")]
    direction: ShutterDirection,
    readout_s: f64,
}

/// The order in which lines are read, as a world file says it.
#[derive(Deserialize)]
#[serde(remote = "ShutterDirection", rename_all = "kebab-case")]
enum DirectionFile {
    TopToBottom,
    BottomToTop,
    LeftToRight,
    RightToLeft,
}

/// A camera model as a world file says it: its calibration matrix by rows, then its coefficients in
/// the order of the models of `occlabel_core::camera`.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum ModelFile {
    Pinhole { matrix: [[f64; 3]; 3] },
    BrownConrady { matrix: [[f64; 3]; 3], distortion: Vec<f64> },
    KannalaBrandt { matrix: [[f64; 3]; 3], distortion: Vec<f64> },
    Mei { matrix: [[f64; 3]; 3], distortion: Vec<f64> },
    Ocam { polynomial: Vec<f64>, centre: [f64; 2], affine: [f64; 3], max_angle_rad: f64 },
}

/// A camera of a world.
#[derive(Clone, Debug)]
pub struct WorldCamera {
    /// Its name, model and size.
    pub named: NamedCamera,
    /// Its mounting: camera axes x right, y down, z forward. In the world file a mounting turned by
    /// nothing looks ahead along the ego's x axis.
    pub ego_from_camera: Pose,
    /// When it is exposed.
    pub clock: Clock,
}

impl TryFrom<CameraFile> for WorldCamera {
    type Error = Fault;

    fn try_from(file: CameraFile) -> Result<Self, Fault> {
        let CameraFile { name, width, height, .. } = file;
        let clock = Clock::new(file.rate_hz, file.offset_s)?;
        let sized = (1..=16384).contains(&width) && (1..=16384).contains(&height);
        need("width, height", sized, "1 to 16384 pixels", format!("{width} x {height}"))?;
        let model = CameraModel::try_from(file.model)
            .map_err(|error| Fault::new("world", "model", "a calibration", error.to_string()))?;
        let mounting: Pose = inside("mounting", file.mounting.try_into())?;
        let body_mask = body_mask(&file.body_mask, width, height)?;
        let rolling_shutter = file.rolling_shutter.map(ShutterFile::build).transpose()?;
        let camera = Camera { model, width, height, body_mask, rolling_shutter };
        let named = NamedCamera { name, camera };
        Ok(Self { named, ego_from_camera: mounting * body_from_optical(), clock })
    }
}

impl ShutterFile {
    fn build(self) -> Result<RollingShutter, Fault> {
        within("rolling_shutter.readout_s", self.readout_s, 0.0, 10.0)?;
        Ok(RollingShutter { direction: self.direction, readout_s: self.readout_s })
    }
}

impl TryFrom<ModelFile> for CameraModel {
    type Error = CameraError;

    fn try_from(file: ModelFile) -> Result<Self, CameraError> {
        let lens = |matrix: &[[f64; 3]; 3]| Intrinsics::from_matrix(matrix);
        Ok(match file {
            ModelFile::Pinhole { matrix } => Self::Pinhole(Pinhole::new(lens(&matrix)?)),
            ModelFile::BrownConrady { matrix, distortion } => {
                Self::BrownConrady(BrownConrady::new(lens(&matrix)?, &distortion)?)
            }
            ModelFile::KannalaBrandt { matrix, distortion } => {
                Self::KannalaBrandt(KannalaBrandt::new(lens(&matrix)?, &distortion)?)
            }
            ModelFile::Mei { matrix, distortion } => {
                Self::Mei(Mei::new(lens(&matrix)?, &distortion)?)
            }
            ModelFile::Ocam { polynomial, centre, affine, max_angle_rad } => {
                Self::Ocam(Ocam::new(&polynomial, centre, affine, max_angle_rad)?)
            }
        })
    }
}

/// Camera axes (x right, y down, z forward) in body axes (x forward, y left, z up).
pub(crate) fn body_from_optical() -> Pose {
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, 0.5, -0.5));
    Pose::from_parts(nalgebra::Translation3::identity(), rotation)
}
