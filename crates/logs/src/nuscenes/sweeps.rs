//! The sweeps of a scene.

use std::collections::HashMap;
use std::path::Path;

use occlabel_core::{Fault, Loss, Pose, SweepHeader};

use super::NuScenesLog;
use super::captures::Capture;
use super::files::read_file;
use super::notes::Notes;
use super::token::Token;

/// Notes where a lidar's `next` goes back in time. The sweeps are sorted all the same.
pub(super) fn report_jumps(sweeps: &[Capture<'_>], notes: &mut Notes) {
    let by_token: HashMap<&Token, &Capture<'_>> =
        sweeps.iter().map(|sweep| (&sweep.row.token, sweep)).collect();
    for sweep in sweeps {
        let next = sweep.row.next.as_ref().and_then(|next| by_token.get(next));
        if let Some(next) = next.filter(|next| next.time < sweep.time) {
            let back_s = sweep.time.seconds_since(next.time);
            let found = format!("`{}` earlier by {back_s} s", next.row.token);
            notes.warn(sweep.row.fault("time-backwards", "a `next` later in time", found));
        }
    }
}

/// The sweeps without repetitions: of those of one lidar and time that hold the same bytes, one
/// stays, the key frame's if one is. Others of one lidar and time all stay. Both is noted.
pub(super) fn without_copies<'a>(
    sweeps: Vec<Capture<'a>>,
    root: &Path,
    notes: &mut Notes,
) -> Vec<Capture<'a>> {
    let mut kept: Vec<Capture<'a>> = Vec::with_capacity(sweeps.len());
    for moment in sweeps.chunk_by(|a, b| (a.time, a.channel) == (b.time, b.channel)) {
        let begin = kept.len();
        for &sweep in moment {
            let copied = kept[begin..].iter_mut().find(|other| is_copy(root, other, &sweep));
            let found = match copied {
                Some(other) if sweep.row.is_key_frame => std::mem::replace(other, sweep),
                Some(_) => sweep,
                None => {
                    kept.push(sweep);
                    continue;
                }
            };
            notes.warn(repeated(&found, "another of the same bytes, which is left out"));
        }
        for other in kept.iter().skip(begin + 1) {
            notes.warn(repeated(other, "another of other bytes: both are kept"));
        }
    }
    kept.sort_by_key(Capture::order);
    kept
}

fn repeated(sweep: &Capture<'_>, found: &str) -> Fault {
    sweep.row.fault("time-repeated", "one sweep of a lidar at a time", found)
}

/// Whether one of two sweeps can go: not if both are key frames', or a file cannot be read.
fn is_copy(root: &Path, a: &Capture<'_>, b: &Capture<'_>) -> bool {
    let same_bytes = || match (read_file(root, &a.row.filename), read_file(root, &b.row.filename)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    let both_key = a.row.is_key_frame && b.row.is_key_frame;
    !both_key && (a.row.filename == b.row.filename || same_bytes())
}

/// The headers of the readable sweeps, each with its place among `sweeps`. A sweep without a usable
/// ego pose is refused.
///
/// # Errors
/// If a lidar's mounting is unusable, or an ego pose is not there at all.
pub(super) fn sweep_headers(
    log: &NuScenesLog,
    sweeps: &[Capture<'_>],
    notes: &mut Notes,
) -> Result<Vec<(usize, SweepHeader)>, Fault> {
    let mut headers = Vec::with_capacity(sweeps.len());
    for (place, sweep) in sweeps.iter().enumerate() {
        let order = log.options.quaternion_order;
        let ego_from_lidar = sweep.calibration.pose(order, notes)?;
        let ego = sweep.row.follow(&log.tables.poses, &sweep.row.ego_pose_token)?;
        let world_from_ego = ego.pose(order, notes);
        if let Some(world_from_ego) = notes.accept(Loss::Sweep, world_from_ego) {
            headers.push((place, header(log, sweep, world_from_ego, ego_from_lidar)));
        }
    }
    Ok(headers)
}

fn header(
    log: &NuScenesLog,
    sweep: &Capture<'_>,
    world_from_ego: Pose,
    ego_from_lidar: Pose,
) -> SweepHeader {
    SweepHeader {
        time: sweep.time,
        lidar: sweep.channel.to_owned(),
        source_id: sweep.row.token.to_string(),
        file: sweep.row.filename.clone(),
        world_from_ego,
        ego_from_lidar,
        labelled: log.tables.labels.contains_key(&sweep.row.token),
    }
}
