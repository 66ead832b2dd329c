//! A scene from its segment: the reader's conductor.

use std::collections::BTreeSet;

use occlabel_core::{Fault, Loss, PointsOf, Scene, SweepHeader, Timestamp};

use super::cameras::{all_exposures, expose, scene_cameras};
use super::segment::{Frame, LidarCalibration, Segment};
use super::sweep_id::SweepId;
use super::tracks::scene_tracks;
use crate::ReadOptions;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;

/// Everything of a scene but its points (labels.md section 2).
///
/// # Errors
/// If the segment's name cannot be that of a folder, no sweep is of the reference lidar, a track has
/// two boxes at a time, or a box type is unknown.
pub(super) fn build_scene(
    options: &ReadOptions,
    name: &str,
    segment: Segment,
) -> Result<Scene, Fault> {
    if !is_folder_name(name) {
        let expected = "a context name of A-Z, a-z, 0-9, `.`, `_` and `-`";
        return Err(Fault::new("scene-name", name, expected, format!("`{name}`")));
    }
    let Segment { lidars, cameras, frames, warnings } = segment;
    let mut notes = Notes::default();
    warnings.into_iter().for_each(|warning| notes.warn(warning));
    let frames = usable_frames(frames, &mut notes);
    let sweeps = sweep_headers(name, &lidars, &frames, &mut notes);
    let cameras = scene_cameras(&cameras, &frames, &mut notes);
    let annotated: BTreeSet<Timestamp> =
        frames.iter().filter(|frame| !frame.boxes.is_empty()).map(|frame| frame.time).collect();
    let is_annotated = |sweep: &SweepHeader| annotated.contains(&sweep.time);
    let mut keyframes = keyframes(&options.keyframes, name, &sweeps, is_annotated, &[], &notes)?;
    expose(&mut keyframes, &frames, &cameras, &mut notes);
    let exposures = all_exposures(&frames, &cameras);
    let tracks = scene_tracks(options, &frames, &mut notes)?;
    let cameras = cameras.into_iter().map(|camera| camera.named).collect();
    let (warnings, refused) = notes.finish();
    let name = name.to_owned();
    Ok(Scene { name, sweeps, tracks, cameras, keyframes, exposures, warnings, refused })
}

/// The frames that can be used, one at a time.
fn usable_frames(frames: Vec<Result<Frame, Fault>>, notes: &mut Notes) -> Vec<Frame> {
    let mut usable: Vec<Frame> = Vec::with_capacity(frames.len());
    for frame in frames {
        let Some(frame) = notes.accept(Loss::Keyframe, frame) else { continue };
        if usable.last().is_some_and(|before| before.time == frame.time) {
            let fault = frame.place.fault("frame-time", "one frame at a time", "another frame");
            notes.refuse(Loss::Keyframe, fault);
        } else {
            usable.push(frame);
        }
    }
    usable
}

/// The sweeps of all lidars, in order of time and name. One of a lidar that is not calibrated is
/// refused.
fn sweep_headers(
    segment: &str,
    lidars: &[LidarCalibration],
    frames: &[Frame],
    notes: &mut Notes,
) -> Vec<SweepHeader> {
    let mut headers = Vec::new();
    for frame in frames {
        for &(lidar, labelled) in &frame.lidars {
            let calibration = lidars.iter().find(|calibration| calibration.lidar == lidar);
            let expected = || format!("a calibration of lidar {}", lidar.name());
            let uncalibrated = || frame.place.fault("lidar-calibration", expected(), "none");
            let calibration = calibration.ok_or_else(uncalibrated);
            let Some(calibration) = notes.accept(Loss::Sweep, calibration) else { continue };
            let id = SweepId { segment: segment.into(), micros: frame.time.0 / 1000, lidar };
            headers.push(SweepHeader {
                time: frame.time,
                lidar: lidar.name().to_owned(),
                source_id: id.to_string(),
                file: frame.place.file.clone(),
                world_from_ego: frame.world_from_ego,
                ego_from_lidar: calibration.ego_from_lidar,
                labelled,
                points_of: PointsOf::Moment,
            });
        }
    }
    headers.sort_by(|a, b| (a.time, &a.lidar, &a.file).cmp(&(b.time, &b.lidar, &b.file)));
    headers
}
