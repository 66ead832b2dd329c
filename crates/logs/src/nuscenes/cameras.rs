//! The cameras of a scene, and what of them serves a keyframe.

use std::collections::BTreeMap;

use occlabel_core::{
    EXPOSURE_WITHIN_S, Exposure, Fault, Loss, NamedCamera, Pose, nearest_exposure,
};

use super::NuScenesLog;
use super::captures::{Capture, Captures};
use super::keyframes::Moment;
use super::optics::camera_of;
use super::tables::{SceneRows, Tables};
use crate::ImageFile;
use crate::notes::Notes;

/// `camera_bits` has one bit for each camera.
const MAX_CAMERAS: usize = 16;

/// A camera with all its images.
#[derive(Debug)]
pub(super) struct SceneCamera<'a> {
    pub(super) named: NamedCamera,
    /// Ordered by time, then token; at least one.
    images: Vec<Capture<'a>>,
}

/// The usable cameras, in byte order of their channels. The first image's calibration and size count;
/// a camera that these do not describe is refused.
///
/// # Errors
/// If there are more than 16 channels.
pub(super) fn scene_cameras<'a>(
    log: &NuScenesLog,
    images: BTreeMap<&'a str, Vec<Capture<'a>>>,
    notes: &mut Notes,
) -> Result<Vec<SceneCamera<'a>>, Fault> {
    if images.len() > MAX_CAMERAS {
        let (expected, found) = (format!("at most {MAX_CAMERAS} cameras"), images.len());
        return Err(Fault::new("camera-count", "sample_data.json", expected, found.to_string()));
    }
    let mut cameras = Vec::new();
    for (channel, images) in images {
        let Some(first) = images.first() else { continue };
        let camera = camera_of(&log.root, first)
            .and_then(|camera| ego_from_camera(log, first, notes).map(|_| camera));
        if let Some(camera) = notes.accept(Loss::Camera, camera) {
            let named = NamedCamera { name: channel.to_owned(), camera };
            cameras.push(SceneCamera { named, images });
        }
    }
    if cameras.is_empty() {
        notes.warn(Fault::new("camera-absent", "sample_data.json", "images of a camera", "none"));
    }
    Ok(cameras)
}

/// What the cameras saw at a moment: at most one exposure each. What is absent is noted, what is
/// unusable is refused.
///
/// # Errors
/// If an ego pose is not there at all.
pub(super) fn exposures(
    log: &NuScenesLog,
    cameras: &[SceneCamera<'_>],
    moment: &Moment<'_>,
    notes: &mut Notes,
) -> Result<Vec<Exposure>, Fault> {
    let mut exposures = Vec::with_capacity(cameras.len());
    for (index, camera) in cameras.iter().enumerate() {
        let Some(image) = camera.image_at(moment) else {
            notes.warn(absent(camera, moment));
            continue;
        };
        let pose = world_from_camera(log, camera, image, notes)?;
        let pose = notes.accept(Loss::Camera, pose);
        exposures.extend(pose.map(|pose| exposure(index, image, pose)));
    }
    Ok(exposures)
}

/// Of each camera everything that it saw and that can be used, in order of time.
pub(super) fn all_exposures(log: &NuScenesLog, cameras: &[SceneCamera<'_>]) -> Vec<Vec<Exposure>> {
    let of_camera = |(index, camera): (usize, &SceneCamera<'_>)| {
        // What is odd about them is told of keyframes, which need them.
        let mut unheard = Notes::default();
        let expose = |image: &Capture<'_>| {
            let pose = world_from_camera(log, camera, image, &mut unheard).ok()?.ok()?;
            Some(exposure(index, image, pose))
        };
        camera.images.iter().filter_map(expose).collect()
    };
    cameras.iter().enumerate().map(of_camera).collect()
}

fn exposure(camera: usize, image: &Capture<'_>, world_from_camera: Pose) -> Exposure {
    let file = Some(image.row.filename.clone());
    Exposure { camera, time: image.time, world_from_camera, image: file }
}

/// The files of a scene's images; none where the rows cannot be followed.
pub(super) fn image_files(tables: &Tables, rows: &SceneRows) -> Vec<ImageFile> {
    let captures = Captures::of_scene(tables, rows).unwrap_or_default();
    let image = |image: &Capture<'_>| {
        let size = [image.row.width?, image.row.height?];
        Some(ImageFile { file: image.row.filename.clone(), size })
    };
    captures.cameras.values().flatten().filter_map(image).collect()
}

impl<'a> SceneCamera<'a> {
    /// The image that the format names for the moment, else the nearest within 0.1 s.
    fn image_at(&self, moment: &Moment<'_>) -> Option<&Capture<'a>> {
        let is_named = |image: &&Capture<'_>| {
            image.row.is_key_frame && Some(&image.row.sample_token) == moment.sample
        };
        let named = self.images.iter().find(is_named);
        named.or_else(|| nearest_exposure(&self.images, |image| image.time, moment.time))
    }
}

fn absent(camera: &SceneCamera<'_>, moment: &Moment<'_>) -> Fault {
    let expected = format!("an image within {EXPOSURE_WITHIN_S} s of the keyframe");
    Fault::new("camera-absent", &camera.named.name, expected, "none").record(&moment.token)
}

/// Where the camera stood; the inner fault costs this exposure only.
fn world_from_camera(
    log: &NuScenesLog,
    camera: &SceneCamera<'_>,
    image: &Capture<'_>,
    notes: &mut Notes,
) -> Result<Result<Pose, Fault>, Fault> {
    let ego = image.row.follow(&log.tables.poses, &image.row.ego_pose_token)?;
    let world_from_ego = ego.pose(log.options.quaternion_order, notes);
    Ok(check_unchanged(log, camera, image).and_then(|()| {
        let ego_from_camera = ego_from_camera(log, image, notes)?;
        Ok(world_from_ego? * ego_from_camera)
    }))
}

fn ego_from_camera(
    log: &NuScenesLog,
    image: &Capture<'_>,
    notes: &mut Notes,
) -> Result<Pose, Fault> {
    image.calibration.pose(log.options.quaternion_order, notes)
}

/// A scene has one model and one size for each camera: an image by another is refused.
fn check_unchanged(
    log: &NuScenesLog,
    camera: &SceneCamera<'_>,
    image: &Capture<'_>,
) -> Result<(), Fault> {
    let first = &camera.images[0];
    let key =
        |image: &Capture<'_>| (image.calibration.token.clone(), image.row.width, image.row.height);
    if key(first) == key(image) || camera_of(&log.root, image)? == camera.named.camera {
        return Ok(());
    }
    let expected = format!("the optics and size of the scene's first image of {}", image.channel);
    Err(image.row.fault("camera-changed", expected, "others"))
}
