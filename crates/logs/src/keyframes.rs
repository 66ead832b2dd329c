//! Keyframes of logs that name none of their own (labels.md section 2).

use occlabel_core::{
    Exposure, Fault, Keyframe, KeyframeSettings, KeyframeSource, SweepHeader, nearest_exposure,
};

use crate::notes::Notes;

/// The keyframes of a scene, their tokens the sweeps' times in nanoseconds. Of sweeps of one time
/// the first is taken.
///
/// `is_annotated` tells the sweeps that the format annotates; where there is none, all are taken.
/// `exposures` holds, for each camera, its exposures in order of time.
///
/// # Errors
/// If the scene has no sweep of the wanted lidar; `notes` may tell why.
pub(crate) fn keyframes(
    settings: &KeyframeSettings,
    scene: &str,
    sweeps: &[SweepHeader],
    is_annotated: impl Fn(&SweepHeader) -> bool,
    exposures: &[Vec<Exposure>],
    notes: &Notes,
) -> Result<Vec<Keyframe>, Fault> {
    let reference =
        reference_lidar(settings, scene, sweeps).map_err(|fault| notes.explain(fault))?;
    let all = settings.source == KeyframeSource::Sweeps || !sweeps.iter().any(&is_annotated);
    let is_chosen = |sweep: &SweepHeader| sweep.lidar == reference && (all || is_annotated(sweep));
    let mut chosen: Vec<_> =
        sweeps.iter().enumerate().filter(|(_, sweep)| is_chosen(sweep)).collect();
    // Sweeps are ordered by time; one token names one folder.
    chosen.dedup_by_key(|(_, sweep)| sweep.time);
    let nearest = |time, camera: &Vec<Exposure>| {
        nearest_exposure(camera, |exposure| exposure.time, time).cloned()
    };
    let keyframe = |(place, sweep): (usize, &SweepHeader)| Keyframe {
        token: sweep.time.0.to_string(),
        time: sweep.time,
        sweep: place,
        exposures: exposures.iter().filter_map(|camera| nearest(sweep.time, camera)).collect(),
    };
    Ok(chosen.into_iter().step_by(settings.stride.max(1)).map(keyframe).collect())
}

fn reference_lidar(
    settings: &KeyframeSettings,
    scene: &str,
    sweeps: &[SweepHeader],
) -> Result<String, Fault> {
    let mut names: Vec<String> = sweeps.iter().map(|sweep| sweep.lidar.clone()).collect();
    names.sort_unstable();
    names.dedup();
    settings.choose_lidar(&names).ok_or_else(|| {
        let expected = format!("sweeps of the reference lidar `{}`", settings.reference_lidar);
        if names.is_empty() {
            return Fault::new("no-sweeps", scene, expected, "no sweeps");
        }
        let fault = Fault::new("reference-lidar", scene, expected, names.join(", "));
        fault.hint(
            "`--set keyframes.reference_lidar=NAME` takes another, `--scenes` leaves scenes out",
        )
    })
}
