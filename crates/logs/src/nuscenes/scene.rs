//! A scene from its rows: the reader's conductor.

use occlabel_core::{Fault, Keyframe, Loss, Scene, SweepHeader};

use super::NuScenesLog;
use super::cameras::{SceneCamera, all_exposures, exposures, scene_cameras};
use super::captures::Captures;
use super::chains::report_chains;
use super::copies::without_copies;
use super::keyframes::{KeySweeps, Moment, moments, reference_lidar};
use super::label_names::label_names;
use super::sweeps::{report_jumps, sweep_headers};
use super::tables::SceneRows;
use super::tracks::scene_tracks;
use crate::notes::Notes;

/// Everything of a scene but its points (labels.md section 2).
pub(super) fn build_scene(log: &NuScenesLog, rows: &SceneRows) -> Result<Scene, Fault> {
    if let Some(fault) = &rows.name_fault {
        return Err(fault.clone());
    }
    let (settings, mut notes) = (&log.options.read.keyframes, Notes::default());
    let captures = Captures::of_scene(&log.tables, rows)?;
    report_chains(rows, &captures, &mut notes);
    report_jumps(&captures.lidars, &mut notes);
    let sweeps = without_copies(&captures.lidars, &log.root, &mut notes);
    let reference = reference_lidar(settings, &rows.name, &sweeps)?;
    let keys = KeySweeps::find(&rows.samples, &sweeps, &reference, &mut notes);
    let moments = moments(settings, &sweeps, &reference, &keys)?;
    let headers = sweep_headers(log, &sweeps, &mut notes)?;
    check_labels(log, &headers)?;
    let cameras = scene_cameras(log, captures.cameras, &mut notes)?;
    let keyframes = keyframes(log, &moments, &headers, &cameras, &mut notes)?;
    let exposures = all_exposures(log, &cameras);
    let tracks = scene_tracks(log, rows, &keys, &mut notes)?;
    let (warnings, refused) = notes.finish();
    Ok(Scene {
        name: rows.name.clone(),
        sweeps: headers.into_iter().map(|(_, header)| header).collect(),
        tracks,
        cameras: cameras.into_iter().map(|camera| camera.named).collect(),
        keyframes,
        exposures,
        warnings,
        refused,
    })
}

/// Whether raw labels can be told at all, if any sweep has them.
fn check_labels(log: &NuScenesLog, headers: &[(usize, SweepHeader)]) -> Result<(), Fault> {
    match headers.iter().any(|(_, header)| header.labelled) {
        true => label_names(log).map(drop),
        false => Ok(()),
    }
}

/// The keyframes whose reference sweep was not refused.
fn keyframes(
    log: &NuScenesLog,
    moments: &[Moment<'_>],
    headers: &[(usize, SweepHeader)],
    cameras: &[SceneCamera<'_>],
    notes: &mut Notes,
) -> Result<Vec<Keyframe>, Fault> {
    let mut keyframes = Vec::with_capacity(moments.len());
    for moment in moments {
        match headers.binary_search_by_key(&moment.sweep, |(place, _)| *place) {
            Err(_) => notes.refuse(Loss::Keyframe, lost(moment)),
            Ok(sweep) => {
                let exposures = exposures(log, cameras, moment, notes)?;
                let (token, time) = (moment.token.clone(), moment.time);
                keyframes.push(Keyframe { token, time, sweep, exposures });
            }
        }
    }
    Ok(keyframes)
}

fn lost(moment: &Moment<'_>) -> Fault {
    let expected = "a usable reference sweep";
    Fault::new("keyframe-sweep", "sample_data.json", expected, "a refused one")
        .record(&moment.token)
}
