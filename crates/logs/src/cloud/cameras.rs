//! The cameras of a scene: `cameras.json`.

use std::path::Path;

use occlabel_core::{Camera, Exposure, Fault, Loss, NamedCamera, Pose, SweepHeader, Timestamp};
use serde::Deserialize;

use super::json::{A_PLACEMENT, Placement, read_json};
use crate::files::name_defect;
use crate::notes::Notes;
use crate::nuscenes::{LensFields, mask_of};

/// `camera_bits` has one bit for each camera.
const MAX_CAMERAS: usize = 16;
/// How many columns and rows an image may have.
const SIDES_PX: std::ops::RangeInclusive<u32> = 1..=65_535;

/// A camera of the file.
#[derive(Clone, Debug, Deserialize)]
struct CameraRow {
    name: String,
    width: u32,
    height: u32,
    #[serde(flatten)]
    lens: LensFields,
    mask: Option<String>,
    /// `ego_from_camera`; none if every exposure tells its own pose.
    #[serde(flatten)]
    mounting: Option<Placement>,
    /// None: one at each pose of the scene.
    exposures: Option<Vec<ExposureRow>>,
}

/// An exposure of a camera.
#[derive(Clone, Debug, Deserialize)]
struct ExposureRow {
    time_ns: i64,
    /// `world_from_camera`.
    #[serde(flatten)]
    placement: Placement,
    image: Option<String>,
}

/// A camera, and its exposures in order of time.
type Seen = (NamedCamera, Vec<Exposure>);

/// The cameras in byte order of their names, and of each its exposures in order of time: those that the
/// file tells, else one at each of the `poses`. A camera that cannot be used is refused.
///
/// # Errors
/// If the file is no list of cameras, or of more than 16.
pub(super) fn read_cameras(
    root: &Path,
    folder: &str,
    poses: &[SweepHeader],
    notes: &mut Notes,
) -> Result<(Vec<NamedCamera>, Vec<Vec<Exposure>>), Fault> {
    let file = format!("{folder}cameras.json");
    let mut rows: Vec<CameraRow> = read_json(root, &file)?;
    rows.sort_by(|a, b| a.name.cmp(&b.name));
    if rows.len() > MAX_CAMERAS {
        let (expected, found) = (format!("at most {MAX_CAMERAS} cameras"), rows.len().to_string());
        return Err(Fault::new("camera-count", file, expected, found));
    }
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].name == pair[1].name) {
        let found = format!("two of `{}`", pair[0].name);
        return Err(Fault::new("camera-name", file, "a name of its own for each camera", found));
    }
    let mut seen: Vec<Seen> = Vec::with_capacity(rows.len());
    for row in rows {
        let camera = row.seen(root, folder, &file, seen.len(), poses);
        seen.extend(notes.accept(Loss::Camera, camera));
    }
    Ok(seen.into_iter().unzip())
}

impl CameraRow {
    fn seen(
        &self,
        root: &Path,
        folder: &str,
        file: &str,
        number: usize,
        poses: &[SweepHeader],
    ) -> Result<Seen, Fault> {
        let fault = |rule, expected: String, found: String| {
            Fault::new(rule, file, expected, found).record(&self.name)
        };
        if ![self.width, self.height].iter().all(|side| SIDES_PX.contains(side)) {
            let found = format!("{} x {}", self.width, self.height);
            let expected = "a width and a height of 1 to 65535".into();
            return Err(fault("camera-size", expected, found));
        }
        let model = self.lens.model();
        let model = model.map_err(|found| fault("camera-model", self.lens.expected(), found))?;
        let mask = self.mask.as_ref().map(|mask| file_in(folder, mask, file)).transpose()?;
        let body_mask =
            mask.map(|mask| mask_of(root, &mask, [self.width, self.height])).transpose()?;
        let (width, height) = (self.width, self.height);
        let camera = Camera { model, width, height, body_mask, rolling_shutter: None };
        let exposures = match &self.exposures {
            Some(rows) => rows.iter().map(|row| row.exposure(number, folder, file)).collect(),
            None => self.at_poses(number, poses),
        };
        let mut exposures: Vec<Exposure> =
            exposures.map_err(|found| fault("camera-pose", A_PLACEMENT.into(), found))?;
        exposures.sort_by_key(|exposure| exposure.time);
        Ok((NamedCamera { name: self.name.clone(), camera }, exposures))
    }

    /// An exposure at each pose.
    fn at_poses(&self, camera: usize, poses: &[SweepHeader]) -> Result<Vec<Exposure>, String> {
        let mounting = self.mounting.as_ref().ok_or("neither a mounting nor exposures")?;
        let ego_from_camera: Pose = mounting.pose()?;
        let exposure = |pose: &SweepHeader| Exposure {
            camera,
            time: pose.time,
            world_from_camera: pose.world_from_ego * ego_from_camera,
            image: None,
        };
        Ok(poses.iter().map(exposure).collect())
    }
}

impl ExposureRow {
    fn exposure(&self, camera: usize, folder: &str, file: &str) -> Result<Exposure, String> {
        let image = self.image.as_ref().map(|image| file_in(folder, image, file));
        Ok(Exposure {
            camera,
            time: Timestamp(self.time_ns),
            world_from_camera: self.placement.pose()?,
            image: image.transpose().map_err(|fault| fault.found)?,
        })
    }
}

/// A file that a table of the scene names, relative to the log's root.
fn file_in(folder: &str, name: &str, table: &str) -> Result<String, Fault> {
    match name_defect(name) {
        None => Ok(format!("{folder}{name}")),
        Some(defect) => {
            let found = format!("`{name}`, {defect}");
            Err(Fault::new("file-name", table, "a path below the scene's folder", found))
        }
    }
}
