//! The sweeps of a recording.

use std::collections::BTreeMap;

use occlabel_core::{Fault, Loss, McapSettings, PointsOf, Pose, SweepHeader, Timestamp};

use super::container::MessageAt;
use super::frames::checked_pose;
use super::layout::FrameRoles;
use super::recording::{CloudHead, Recording};
use crate::notes::Notes;

/// The field of points that holds their labels, if it is among those that are there.
pub(super) fn label_field<'a>(settings: &'a McapSettings, fields: &[String]) -> Option<&'a str> {
    let name = settings.label_field.as_str();
    fields.iter().any(|field| field == name).then_some(name)
}

/// The sweeps in order of time, lidar and place; one that has no place is refused.
pub(super) fn sweep_headers(
    recording: &Recording,
    settings: &McapSettings,
    roles: &FrameRoles,
    lidars: &BTreeMap<String, String>,
    notes: &mut Notes,
) -> Vec<SweepHeader> {
    let mut sweeps: Vec<(SweepHeader, MessageAt)> = Vec::new();
    let loss = recording.loss_without_pose(Loss::Sweep);
    for cloud in distinct(recording, notes) {
        let placed = place(recording, roles, cloud).map_err(|found| {
            let expected = format!("a pose of frame `{}` in `{}`", cloud.header.frame, roles.world);
            fault(recording, cloud, "transform", expected, found)
        });
        let Some((world_from_ego, ego_from_lidar)) = notes.accept(loss, placed) else {
            continue;
        };
        let header = SweepHeader {
            time: cloud.header.time,
            lidar: lidars[&cloud.topic].clone(),
            source_id: source_id(cloud.at),
            file: recording.file.clone(),
            world_from_ego,
            ego_from_lidar,
            labelled: label_field(settings, &cloud.fields).is_some(),
            points_of: PointsOf::Moment,
        };
        sweeps.push((header, cloud.at));
    }
    sweeps.sort_by(|(a, at), (b, bt)| (a.time, &a.lidar, at).cmp(&(b.time, &b.lidar, bt)));
    sweeps.into_iter().map(|(header, _)| header).collect()
}

/// A sweep's id: where its message stands.
pub(super) fn source_id(at: MessageAt) -> String {
    format!("{}:{}", at.block, at.place)
}

/// `world_from_ego` and `ego_from_lidar` at the cloud's time.
fn place(
    recording: &Recording,
    roles: &FrameRoles,
    cloud: &CloudHead,
) -> Result<(Pose, Pose), String> {
    let (time, frames) = (cloud.header.time, &recording.frames);
    let world_from_ego = frames.pose(&roles.world, &roles.ego, time)?;
    let ego_from_frame = frames.pose(&roles.ego, &cloud.header.frame, time)?;
    let (frame_from_lidar, _) = checked_pose(&cloud.pose)?;
    Ok((world_from_ego, ego_from_frame * frame_from_lidar))
}

/// The clouds without copies. Different ones of one topic at one time stay, with a word; so do
/// those whose time goes back.
fn distinct<'a>(recording: &'a Recording, notes: &mut Notes) -> Vec<&'a CloudHead> {
    let mut latest: BTreeMap<&str, Timestamp> = BTreeMap::new();
    let mut seen: BTreeMap<(&str, Timestamp), &CloudHead> = BTreeMap::new();
    let mut kept = Vec::new();
    for cloud in &recording.clouds {
        let (topic, time) = (cloud.topic.as_str(), cloud.header.time);
        if let Some(before) = seen.insert((topic, time), cloud) {
            let is_copy = before.digest == cloud.digest;
            let found = if is_copy { "a copy" } else { "another cloud" };
            let expected = "one cloud of a topic at a time";
            notes.warn(fault(recording, cloud, "sweep-time", expected.into(), found.into()));
            if is_copy {
                continue;
            }
        }
        let newest = latest.entry(topic).or_insert(time);
        if time < *newest {
            let (expected, found) =
                ("times that go on", format!("{} ns before", newest.0.saturating_sub(time.0)));
            notes.warn(fault(recording, cloud, "sweep-order", expected.into(), found));
        }
        *newest = time.max(*newest);
        kept.push(cloud);
    }
    kept
}

fn fault(
    recording: &Recording,
    cloud: &CloudHead,
    rule: &'static str,
    expected: String,
    found: String,
) -> Fault {
    let record = format!("{} at {} ns", cloud.topic, cloud.header.time.0);
    Fault::new(rule, &recording.file, expected, found).record(record).offset(cloud.at.block)
}
