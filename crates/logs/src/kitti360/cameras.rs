//! Two rectified cameras ahead, two fisheyes to the sides.

use std::path::Path;

use occlabel_core::camera::{CameraError, CameraModel, Intrinsics, Mei, Pinhole};
use occlabel_core::{Camera, Exposure, Fault, Loss, NamedCamera, Pose};

use super::calibration::{Calibration, LENSES, named_line};
use super::layout::Drive;
use super::poses::{At, Poses};
use super::stamps::Stamps;
use crate::notes::Notes;
use crate::number_rows::{numbers, read_lines};
use crate::transform::pose_from_rows;

/// All cameras; those from the third on are fisheyes.
const CAMERAS: [&str; 4] = ["image_00", "image_01", "image_02", "image_03"];
/// Cameras that are rectified.
const RECTIFIED: usize = 2;

/// The cameras, and the exposures of each in order of time. One that cannot be used is refused; one
/// without a list of its images' times has no exposures, and is noted.
pub(super) fn read_cameras(
    root: &Path,
    drive: &Drive,
    calibration: &Calibration,
    poses: &Poses,
    notes: &mut Notes,
) -> (Vec<NamedCamera>, Vec<Vec<Exposure>>) {
    let (mut cameras, mut exposures) = (Vec::new(), Vec::new());
    for (number, name) in CAMERAS.into_iter().enumerate() {
        let camera = camera(root, calibration, number);
        let (camera, ego_from_camera) = match camera {
            Ok(camera) => camera,
            Err(absent) if absent.rule == "missing-file" => {
                notes.warn(Fault { rule: "camera-absent", ..absent });
                continue;
            }
            Err(fault) => {
                notes.refuse(Loss::Camera, fault);
                continue;
            }
        };
        let stamps = Stamps::read(root, drive.image_stamps(name));
        let stamps = stamps.map_err(|absent| notes.warn(Fault { rule: "camera-absent", ..absent }));
        let of_camera = (cameras.len(), &ego_from_camera);
        let image = |frame| drive.image(name, number < RECTIFIED, frame);
        let expose = |stamps| expose(of_camera, poses, &stamps, image);
        exposures.push(stamps.map_or(Vec::new(), expose));
        cameras.push(NamedCamera { name: name.to_owned(), camera });
    }
    (cameras, exposures)
}

/// At the frames that have a pose and a time.
fn expose(
    (camera, ego_from_camera): (usize, &Pose),
    poses: &Poses,
    stamps: &Stamps,
    image: impl Fn(usize) -> String,
) -> Vec<Exposure> {
    let expose = |frame| {
        let At::Known(world_from_ego) = poses.at(frame, stamps) else { return None };
        let world_from_camera = world_from_ego * ego_from_camera;
        let (time, image) = (stamps.time(frame).ok()?, Some(image(frame)));
        Some(Exposure { camera, time, world_from_camera, image })
    };
    let mut exposures: Vec<_> = poses.frames().filter_map(expose).collect();
    exposures.sort_by_key(|exposure| exposure.time);
    exposures
}

/// A camera, and `ego_from_camera`.
fn camera(root: &Path, calibration: &Calibration, number: usize) -> Result<(Camera, Pose), Fault> {
    let imu_from_camera = calibration.imu_from_camera(CAMERAS[number])?;
    let mut ego_from_camera = calibration.ego_from_imu * imu_from_camera;
    let (model, [width, height], file) = if number < RECTIFIED {
        ego_from_camera *= rectification(root, number)?.inverse();
        let (model, size) = pinhole(root, number)?;
        (model, size, LENSES.to_owned())
    } else {
        let file = format!("calibration/{}.yaml", CAMERAS[number]);
        let (model, size) = fisheye(root, &file)?;
        (model, size, file)
    };
    let side = |side: f64| (1.0..=f64::from(u16::MAX)).contains(&side).then_some(side as u32);
    let (Some(width), Some(height)) = (side(width), side(height)) else {
        let found = format!("{width} x {height}");
        return Err(Fault::new("camera-size", file, "a width and a height", found));
    };
    let camera = Camera { model, width, height, body_mask: None, rolling_shutter: None };
    Ok((camera, ego_from_camera))
}

/// `rectified_from_camera` of a rectified camera.
///
/// # Errors
/// If the file does not tell.
pub(super) fn rectification(root: &Path, number: usize) -> Result<Pose, Fault> {
    let [a, b, c, d, e, f, g, h, i] = lens_line(root, &format!("R_rect_{number:02}:"))?;
    let rows = [a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0];
    let expected = "9 numbers of a rotation";
    pose_from_rows(&rows).map_err(|found| Fault::new("calibration", LENSES, expected, found))
}

fn pinhole(root: &Path, number: usize) -> Result<(CameraModel, [f64; 2]), Fault> {
    let p = lens_line::<12>(root, &format!("P_rect_{number:02}:"))?;
    let size = lens_line(root, &format!("S_rect_{number:02}:"))?;
    let matrix = [[p[0], p[1], p[2]], [p[4], p[5], p[6]], [p[8], p[9], p[10]]];
    let lens = Intrinsics::from_matrix(&matrix).map_err(|error| no_model(LENSES, &error))?;
    Ok((CameraModel::Pinhole(Pinhole::new(lens)), size))
}

fn lens_line<const N: usize>(root: &Path, name: &str) -> Result<[f64; N], Fault> {
    let lines = read_lines(root, LENSES)?;
    numbers(named_line(LENSES, &lines, name)?).map_err(|found| {
        Fault::new("calibration", LENSES, format!("{N} numbers"), found).record(name)
    })
}

/// From OpenCV's YAML, which names each number once.
fn fisheye(root: &Path, file: &str) -> Result<(CameraModel, [f64; 2]), Fault> {
    let lines = read_lines(root, file)?;
    let number = |name: &str| {
        let text = named_line(file, &lines, &format!("{name}:"))?;
        let number = numbers(text).map(|[number]: [f64; 1]| number);
        number.map_err(|found| Fault::new("calibration", file, "a number", found).record(name))
    };
    let (f_u, f_v) = (number("gamma1")?, number("gamma2")?);
    let matrix = [[f_u, 0.0, number("u0")?], [0.0, f_v, number("v0")?], [0.0, 0.0, 1.0]];
    let distortion = [number("xi")?, number("k1")?, number("k2")?, number("p1")?, number("p2")?];
    let lens = Intrinsics::from_matrix(&matrix);
    let lens = lens.and_then(|lens| Mei::new(lens, &distortion));
    let model = CameraModel::Mei(lens.map_err(|error| no_model(file, &error))?);
    Ok((model, [number("image_width")?, number("image_height")?]))
}

fn no_model(file: &str, error: &CameraError) -> Fault {
    Fault::new("camera-model", file, "a lens", error.to_string())
}
