//! A camera as the format has it.

use occlabel_core::camera::{CameraModel, RollingShutter, ShutterDirection};
use occlabel_core::{Camera, Pose};

use crate::camera::body_from_optical;

/// A camera of at most five coefficients.
pub(super) struct RigCamera {
    pub(super) number: u64,
    /// `f_u f_v c_u c_v k1 k2 p1 p2 k3`.
    pub(super) intrinsic: [f64; 9],
    /// The format's camera looks along x, its left is y, its up z.
    pub(super) ego_from_format: Pose,
    pub(super) size: [u32; 2],
    /// The number of its shutter's direction, and how long it reads out an image.
    pub(super) shutter: (u64, f64),
}

impl RigCamera {
    /// The camera of that number; else what lens was found.
    pub(super) fn new(
        camera: &Camera,
        number: u64,
        ego_from_camera: &Pose,
    ) -> Result<Self, String> {
        Ok(Self {
            number,
            intrinsic: intrinsic(&camera.model)?,
            ego_from_format: ego_from_camera * body_from_optical().inverse(),
            size: [camera.width, camera.height],
            shutter: camera.rolling_shutter.map_or((GLOBAL_SHUTTER, 0.0), shutter),
        })
    }
}

/// Else what was found.
fn intrinsic(model: &CameraModel) -> Result<[f64; 9], String> {
    let (kind, lens) = match model {
        CameraModel::Pinhole(_) => ("pinhole", model.intrinsics()),
        CameraModel::BrownConrady(_) => ("brown-conrady", model.intrinsics()),
        CameraModel::KannalaBrandt(_) => ("kannala-brandt", None),
        CameraModel::Mei(_) => ("mei", None),
        CameraModel::Ocam(_) => ("ocam", None),
    };
    let Some(lens) = lens else { return Err(kind.into()) };
    let ([[fx, skew, cx], [_, fy, cy], _], coefficients) = (lens.matrix(), model.coefficients());
    if skew != 0.0 || coefficients.len() > 5 {
        return Err(format!("{kind} of skew {skew} with {} coefficients", coefficients.len()));
    }
    let mut intrinsic = [fx, fy, cx, cy, 0.0, 0.0, 0.0, 0.0, 0.0];
    intrinsic[4..4 + coefficients.len()].copy_from_slice(&coefficients);
    Ok(intrinsic)
}

/// The format's number of a shutter that reads all lines at once.
const GLOBAL_SHUTTER: u64 = 5;

fn shutter(shutter: RollingShutter) -> (u64, f64) {
    let direction = match shutter.direction {
        ShutterDirection::TopToBottom => 1,
        ShutterDirection::LeftToRight => 2,
        ShutterDirection::BottomToTop => 3,
        ShutterDirection::RightToLeft => 4,
    };
    (direction, shutter.readout_s)
}
