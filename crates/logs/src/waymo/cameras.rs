//! The cameras of a segment, and what they saw.

use nalgebra::{Quaternion, UnitQuaternion};
use occlabel_core::camera::{
    BrownConrady, CameraError, CameraModel, Intrinsics, RollingShutter, ShutterDirection,
};
use occlabel_core::{Camera, Exposure, Fault, Keyframe, Loss, NamedCamera, Pose};

use super::segment::{CameraCalibration, Frame, Image};
use crate::notes::Notes;
use crate::transform::{A_POSE, pose_from_matrix};

/// A camera of the segment that can be used.
pub(super) struct SceneCamera {
    pub(super) named: NamedCamera,
    ego_from_camera: Pose,
}

/// From our camera frame (x right, y down, z forward) to the format's (x forward, y left, z up).
const FORMAT_FROM_OURS: Quaternion<f64> = Quaternion::new(0.5, -0.5, 0.5, -0.5);

/// The cameras that have images, in byte order of their names. One that cannot be used is refused.
pub(super) fn scene_cameras(
    calibrations: &[CameraCalibration],
    frames: &[Frame],
    notes: &mut Notes,
) -> Vec<SceneCamera> {
    let mut cameras = Vec::new();
    for calibration in calibrations {
        let images = || frames.iter().flat_map(|frame| &frame.images);
        let mut images = images().filter(|image| image.camera == calibration.name);
        let Some(first) = images.next() else { continue };
        cameras.extend(notes.accept(Loss::Camera, scene_camera(calibration, first)));
    }
    cameras.sort_by(|a, b| a.named.name.cmp(&b.named.name));
    if cameras.is_empty() {
        let place = frames.first().map_or("no frame", |frame| &frame.place.file);
        notes.warn(Fault::new("camera-absent", place, "images of a camera", "none"));
    }
    cameras
}

/// Gives keyframes what the cameras saw in the frame of their reference sweep.
pub(super) fn expose(
    keyframes: &mut [Keyframe],
    frames: &[Frame],
    cameras: &[SceneCamera],
    notes: &mut Notes,
) {
    for keyframe in keyframes {
        let frame = frames.iter().find(|frame| frame.time == keyframe.time);
        let Some(frame) = frame else { continue };
        for (index, camera) in cameras.iter().enumerate() {
            let exposure = exposure(camera, index, frame, notes);
            keyframe.exposures.extend(exposure);
        }
    }
}

/// Of each camera what it saw in the frames, in order of time.
pub(super) fn all_exposures(frames: &[Frame], cameras: &[SceneCamera]) -> Vec<Vec<Exposure>> {
    let of_camera = |(index, camera): (usize, &SceneCamera)| {
        // What is odd about them is told of keyframes, which need them.
        let mut unheard = Notes::default();
        let exposure = |frame| exposure(camera, index, frame, &mut unheard);
        let mut exposures: Vec<Exposure> = frames.iter().filter_map(exposure).collect();
        exposures.sort_by_key(|exposure| exposure.time);
        exposures
    };
    cameras.iter().enumerate().map(of_camera).collect()
}

/// What a camera saw in a frame. What is absent is noted, what is unusable is refused.
fn exposure(
    camera: &SceneCamera,
    index: usize,
    frame: &Frame,
    notes: &mut Notes,
) -> Option<Exposure> {
    let name = &camera.named.name;
    let Some(image) = frame.images.iter().find(|image| image.camera == name) else {
        let expected = "an image in the keyframe's frame";
        notes.warn(Fault::new("camera-absent", name, expected, "none").record(&frame.place.record));
        return None;
    };
    let pose = pose_from_matrix(&image.world_from_ego);
    let pose = pose.map_err(|found| {
        image.place.fault("camera-pose", format!("a pose of {name} of {A_POSE}"), found)
    });
    let world_from_ego = notes.accept(Loss::Camera, pose)?;
    let world_from_camera = world_from_ego * camera.ego_from_camera;
    let time = image.exposed(frame.time);
    Some(Exposure { camera: index, time, world_from_camera, image: None })
}

fn scene_camera(calibration: &CameraCalibration, first: &Image) -> Result<SceneCamera, Fault> {
    let name = calibration.name;
    let ego_from_format = pose_from_matrix(&calibration.ego_from_camera).map_err(|found| {
        let expected = format!("an extrinsic of {name} of {A_POSE}");
        calibration.place.fault("camera-extrinsic", expected, found)
    })?;
    let model = model(&calibration.intrinsic).map_err(|error| {
        let expected = format!("9 numbers of {name}'s lens");
        calibration.place.fault("camera-model", expected, error.to_string())
    })?;
    let (width, height) = size(calibration)?;
    let rolling_shutter = rolling_shutter(calibration.shutter_direction, first.readout_s);
    let camera = Camera { model, width, height, body_mask: None, rolling_shutter };
    Ok(SceneCamera {
        named: NamedCamera { name: name.to_owned(), camera },
        ego_from_camera: ego_from_format * UnitQuaternion::new_normalize(FORMAT_FROM_OURS),
    })
}

/// From `f_u f_v c_u c_v k1 k2 p1 p2 k3`; pixel 0 begins at the image's edge, as ours does.
fn model(intrinsic: &[f64]) -> Result<CameraModel, CameraError> {
    let &[f_u, f_v, c_u, c_v, ref distortion @ ..] = intrinsic else {
        return Err(CameraError::Count {
            name: "camera intrinsic",
            expected: "9",
            found: intrinsic.len(),
        });
    };
    let matrix = [[f_u, 0.0, c_u], [0.0, f_v, c_v], [0.0, 0.0, 1.0]];
    let lens = BrownConrady::new(Intrinsics::from_matrix(&matrix)?, distortion)?;
    Ok(CameraModel::BrownConrady(lens))
}

fn size(calibration: &CameraCalibration) -> Result<(u32, u32), Fault> {
    let side = |side: i64| u32::try_from(side).ok().filter(|side| *side > 0);
    match (side(calibration.width), side(calibration.height)) {
        (Some(width), Some(height)) => Ok((width, height)),
        _ => {
            let CameraCalibration { name, width, height, .. } = calibration;
            let found = format!("{width} x {height} of {name}");
            Err(calibration.place.fault("camera-size", "a width and a height above 0", found))
        }
    }
}

/// By the format's number of the direction; `None` if all lines are read at once, or if that is not
/// known.
fn rolling_shutter(direction: i64, readout_s: f64) -> Option<RollingShutter> {
    let direction = match direction {
        1 => ShutterDirection::TopToBottom,
        2 => ShutterDirection::LeftToRight,
        3 => ShutterDirection::BottomToTop,
        4 => ShutterDirection::RightToLeft,
        _ => return None,
    };
    let is_known = readout_s.is_finite() && readout_s > 0.0;
    is_known.then_some(RollingShutter { direction, readout_s })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn our_camera_looks_along_the_formats_x() {
        let turn = UnitQuaternion::new_normalize(FORMAT_FROM_OURS);
        assert!((turn * Vector3::z() - Vector3::x()).norm() < 1e-12, "forward");
        assert!((turn * Vector3::x() + Vector3::y()).norm() < 1e-12, "right");
        assert!((turn * Vector3::y() + Vector3::z()).norm() < 1e-12, "down");
    }

    #[test]
    fn a_shutter_needs_a_direction_and_a_span() {
        let rows = RollingShutter { direction: ShutterDirection::BottomToTop, readout_s: 0.02 };
        assert_eq!(rolling_shutter(3, 0.02), Some(rows));
        assert!(
            [(0, 0.02), (5, 0.02), (1, 0.0), (1, f64::NAN)]
                .into_iter()
                .all(|(direction, span)| rolling_shutter(direction, span).is_none())
        );
    }
}
