//! The cameras of a log, and when they were exposed: its images are named by their times.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use occlabel_core::camera::{CameraModel, Intrinsics, Pinhole};
use occlabel_core::{Camera, Exposure, Fault, Loss, NamedCamera, Pose, Timestamp};
use occlabel_disk as disk;

use super::poses::Mountings;
use super::table::Table;
use super::times::files_by_time;
use crate::notes::Notes;

/// The lenses of all cameras.
pub(super) const LENSES: &str = "calibration/intrinsics.feather";
/// A folder of images for each camera.
const IMAGES: &str = "sensors/cameras/";
/// How images end.
const ENDINGS: [&str; 2] = [".jpg", ".png"];

/// The cameras in byte order of their names, and the exposures of each in order of time. One that
/// cannot be used is refused; that there are none, or no images, is noted.
///
/// # Errors
/// If the table of lenses is broken, or a folder of images cannot be listed.
pub(super) fn read_cameras(
    (root, folder): (&Path, &str),
    mountings: &Mountings,
    ego_poses: &HashMap<i64, Pose>,
    notes: &mut Notes,
) -> Result<(Vec<NamedCamera>, Vec<Vec<Exposure>>), Fault> {
    let file = format!("{folder}{LENSES}");
    if !disk::is_file(&root.join(&file)) {
        notes.warn(Fault::new("camera-absent", file, "the lenses of cameras", "none"));
        return Ok(Default::default());
    }
    let (mut cameras, mut exposures) = (Vec::new(), Vec::new());
    for (name, lens) in lenses(root, &file)? {
        let camera = camera(&file, &name, &lens);
        let both = camera.and_then(|camera| Ok((camera, mountings.pose(&name)?)));
        let Some((camera, ego_from_camera)) = notes.accept(Loss::Camera, both) else { continue };
        let place = format!("{folder}{IMAGES}{name}/");
        let images = files_by_time(root, &place, &ENDINGS)?;
        let expose = |(time_ns, file, pose): (i64, String, &Pose)| Exposure {
            camera: cameras.len(),
            time: Timestamp(time_ns),
            world_from_camera: pose * ego_from_camera,
            image: Some(file),
        };
        let posed = posed(images, &place, ego_poses, notes);
        exposures.push(posed.into_iter().map(expose).collect());
        cameras.push(NamedCamera { name, camera });
    }
    if exposures.iter().all(Vec::is_empty) {
        let expected = "images, whose names tell when cameras were exposed";
        notes.warn(Fault::new("camera-absent", format!("{folder}{IMAGES}"), expected, "none"));
    }
    Ok((cameras, exposures))
}

/// Images with the ego's poses at their times; one without is noted.
fn posed<'a>(
    images: BTreeMap<i64, String>,
    place: &str,
    ego_poses: &'a HashMap<i64, Pose>,
    notes: &mut Notes,
) -> Vec<(i64, String, &'a Pose)> {
    let mut posed = Vec::new();
    for (time_ns, file) in images {
        match ego_poses.get(&time_ns) {
            Some(pose) => posed.push((time_ns, file, pose)),
            None => {
                let fault =
                    Fault::new("ego-pose", place, "an ego pose of the image's time", "none");
                notes.warn(fault.record(time_ns.to_string()));
            }
        }
    }
    posed
}

/// By name: fx, fy, cx, cy, width, height, pixels.
fn lenses(root: &Path, file: &str) -> Result<Vec<(String, [f64; 6])>, Fault> {
    let table = Table::read(root, file)?;
    let names = ["fx_px", "fy_px", "cx_px", "cy_px", "width_px", "height_px"];
    let columns: Vec<Vec<f64>> =
        names.iter().map(|name| table.reals(name)).collect::<Result<_, _>>()?;
    let lens = |row: usize| [0, 1, 2, 3, 4, 5].map(|column| columns[column][row]);
    let named = table.texts("sensor_name")?.into_iter().enumerate();
    let mut lenses: Vec<_> = named.map(|(row, name)| (name, lens(row))).collect();
    lenses.sort_by(|(a, _), (b, _)| a.cmp(b));
    Ok(lenses)
}

/// A pinhole: the format's own tools project so, and leave k1 to k3 alone.
fn camera(file: &str, name: &str, lens: &[f64; 6]) -> Result<Camera, Fault> {
    let [fx, fy, cx, cy, width, height] = *lens;
    let side = |side: f64| (1.0..=f64::from(u16::MAX)).contains(&side).then_some(side as u32);
    let (Some(width), Some(height)) = (side(width), side(height)) else {
        let found = format!("{width} x {height}");
        return Err(Fault::new("camera-size", file, "a width and a height", found).record(name));
    };
    let matrix = [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]];
    let lens = Intrinsics::from_matrix(&matrix).map_err(|error| {
        Fault::new("camera-model", file, "a lens", error.to_string()).record(name)
    })?;
    let model = CameraModel::Pinhole(Pinhole::new(lens));
    Ok(Camera { model, width, height, body_mask: None, rolling_shutter: None })
}
