//! The two cameras that the lidar triggers at each of its turns.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::camera::{BrownConrady, CameraError, CameraModel, Intrinsics, Pinhole};
use occlabel_core::{Camera, Exposure, Fault, Loss, NamedCamera, Pose, SweepHeader};
use occlabel_disk as disk;

use super::calibration::Calibration;
use super::sequence::Sequence;
use crate::notes::Notes;
use crate::transform::pose_from_rows;

/// The cameras; the others of the robot run by clocks of their own.
pub(super) const CAMERAS: [&str; 2] = ["cam0", "cam1"];
/// Lenses whose distortion is Brown's, by ROS's names.
const BROWN: [&str; 2] = ["plumb_bob", "rational_polynomial"];

/// The cameras that have a calibration, and the exposures of each in order of time: one at each sweep. One
/// that cannot be used is refused; that there are none is noted.
///
/// # Errors
/// If a folder of images cannot be listed.
pub(super) fn read_cameras(
    root: &Path,
    sequence: &Sequence,
    sweeps: &BTreeMap<usize, SweepHeader>,
    notes: &mut Notes,
) -> Result<(Vec<NamedCamera>, Vec<Vec<Exposure>>), Fault> {
    let (mut cameras, mut exposures) = (Vec::new(), Vec::new());
    let lens = |name: &str| sequence.calibration(&format!("{name}_intrinsics"));
    for name in CAMERAS.into_iter().filter(|name| disk::is_file(&root.join(lens(name)))) {
        let images = Images::find(root, sequence, name)?;
        let camera = camera(root, sequence, name, images.are_rectified);
        let Some((camera, lidar_from_camera)) = notes.accept(Loss::Camera, camera) else {
            continue;
        };
        let number = cameras.len();
        let expose = |(frame, sweep): (&usize, &SweepHeader)| Exposure {
            camera: number,
            time: sweep.time,
            world_from_camera: sweep.world_from_lidar() * lidar_from_camera,
            image: images.by_frame.get(frame).cloned(),
        };
        let mut exposed: Vec<Exposure> = sweeps.iter().map(expose).collect();
        exposed.sort_by_key(|exposure| exposure.time);
        exposures.push(exposed);
        cameras.push(NamedCamera { name: name.to_owned(), camera });
    }
    if cameras.is_empty() {
        notes.warn(Fault::new("camera-absent", lens(CAMERAS[0]), "the lens of a camera", "none"));
    }
    Ok((cameras, exposures))
}

/// The images of a camera.
struct Images {
    by_frame: BTreeMap<usize, String>,
    /// Whether they are rectified.
    are_rectified: bool,
}

impl Images {
    /// As the camera took them; else rectified, if there are any; else none.
    fn find(root: &Path, sequence: &Sequence, camera: &str) -> Result<Self, Fault> {
        let raw = sequence.images(root, "2d_raw", camera)?;
        if !raw.is_empty() {
            return Ok(Self { by_frame: raw, are_rectified: false });
        }
        let by_frame = sequence.images(root, "2d_rect", camera)?;
        Ok(Self { are_rectified: !by_frame.is_empty(), by_frame })
    }
}

/// A camera, and `lidar_from_camera`.
fn camera(
    root: &Path,
    sequence: &Sequence,
    name: &str,
    is_rectified: bool,
) -> Result<(Camera, Pose), Fault> {
    let lens = Calibration::read(root, sequence.calibration(&format!("{name}_intrinsics")))?;
    let mounting = Calibration::read(root, sequence.calibration(&format!("os1_to_{name}")))?;
    let mut lidar_from_camera = mounting.pose("extrinsic_matrix")?.inverse();
    let [width, height] = size(&lens)?;
    let model = match is_rectified {
        true => {
            lidar_from_camera *= rectified_from_camera(&lens)?.inverse();
            rectified(&lens)?
        }
        false => distorted(&lens)?,
    };
    let camera = Camera { model, width, height, body_mask: None, rolling_shutter: None };
    Ok((camera, lidar_from_camera))
}

fn size(lens: &Calibration) -> Result<[u32; 2], Fault> {
    let side = |name| {
        let side = lens.number(name)?;
        let fits = (1.0..=f64::from(u16::MAX)).contains(&side);
        let odd = || lens.fault(name, "pixels", side.to_string());
        fits.then_some(side as u32).ok_or_else(odd)
    };
    Ok([side("image_width")?, side("image_height")?])
}

/// The lens as it is.
fn distorted(lens: &Calibration) -> Result<CameraModel, Fault> {
    let kind = lens.word("distortion_model").unwrap_or(BROWN[0]);
    if !BROWN.contains(&kind) {
        return Err(lens.fault("distortion_model", &BROWN.join(" or "), kind));
    }
    let [a, b, c, d, e, f, g, h, i] = lens.matrix_of("camera_matrix")?;
    let pinhole = Intrinsics::from_matrix(&[[a, b, c], [d, e, f], [g, h, i]]);
    let distortion = lens.matrix("distortion_coefficients")?;
    let model = pinhole.and_then(|pinhole| BrownConrady::new(pinhole, &distortion));
    model.map(CameraModel::BrownConrady).map_err(|error| no_model(lens, &error))
}

/// The pinhole of rectified images. The fourth column places the other camera, and not this one.
fn rectified(lens: &Calibration) -> Result<CameraModel, Fault> {
    let [a, b, c, _, d, e, f, _, g, h, i, _] = lens.matrix_of("projection_matrix")?;
    let pinhole = Intrinsics::from_matrix(&[[a, b, c], [d, e, f], [g, h, i]]);
    let pinhole = pinhole.map_err(|error| no_model(lens, &error))?;
    Ok(CameraModel::Pinhole(Pinhole::new(pinhole)))
}

fn rectified_from_camera(lens: &Calibration) -> Result<Pose, Fault> {
    const NAME: &str = "rectification_matrix";
    let [a, b, c, d, e, f, g, h, i] = lens.matrix_of(NAME)?;
    let pose = pose_from_rows(&[a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0]);
    pose.map_err(|found| lens.fault(NAME, "9 numbers of a rotation", found))
}

fn no_model(lens: &Calibration, error: &CameraError) -> Fault {
    Fault { rule: "camera-model", ..lens.fault("camera_matrix", "a lens", error.to_string()) }
}
