//! The sweeps of a scene.

use std::collections::HashMap;

use occlabel_core::{Fault, Loss, PointsOf, Pose, SweepHeader};

use super::NuScenesLog;
use super::captures::Capture;
use super::token::Token;
use crate::notes::Notes;

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

/// The headers of the readable sweeps, each with its place among `sweeps`. A sweep without a usable
/// ego pose, or whose labels lie outside the root, is refused.
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
        let labels = log.tables.labels.get(&sweep.row.token);
        if let Some(defect) = labels.and_then(|labels| labels.defect.clone()) {
            notes.refuse(Loss::Sweep, defect);
        } else if let Some(world_from_ego) = notes.accept(Loss::Sweep, world_from_ego) {
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
        points_of: PointsOf::Moment,
    }
}
