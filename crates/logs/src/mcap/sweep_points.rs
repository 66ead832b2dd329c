//! The points of a sweep, in the frame of its lidar at the sweep's time.

use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::{Fault, PointCloud, PointLabel, Pose, RigidMap, Timestamp};

use super::classes::label_name;
use super::frames::checked_pose;
use super::messages::{Cloud, Defect};
use super::options::McapOptions;
use super::points::Points;
use super::recording::Recording;
use super::sweeps::label_field;
use crate::SweepPoints;
use crate::raw_labels::RawLabels;

/// What can be done about labels that the taxonomy does not name.
const LABELS_HINT: &str = "`reader.mcap.taxonomy` names another taxonomy, \
    `[reader.mcap.classes]` what numbers are called, `--unknown-as CLASS` a class for all";
/// Times of points from here on are counted from the epoch, seconds; below, from the sweep's time.
const EPOCH_TIMES_FROM_S: f64 = 1e6;

/// Decodes a cloud's points; `place` is its file and record.
///
/// # Errors
/// If bytes and points do not fit each other, a label means nothing, or a point's time has no pose.
pub(super) fn sweep_points(
    cloud: &Cloud,
    (recording, world): (&Recording, &str),
    options: &McapOptions,
    (file, record): (&str, &str),
) -> Result<SweepPoints, Fault> {
    let located = |fault: Fault| fault.record(record);
    let refuse =
        |Defect { expected, found }| located(Fault::new("cloud-fields", file, expected, found));
    let points = Points::new(cloud).map_err(refuse)?;
    let name = |raw| Some(label_name(raw, &options.settings, recording));
    let mut raw_labels = RawLabels::new(&options.read, name);
    let names: Vec<String> = cloud.fields.iter().map(|field| field.name.clone()).collect();
    let labels = match label_field(&options.settings, &names) {
        Some(field) => {
            let raw = points.numbers(field).map_err(refuse)?;
            raw_labels.labels(raw.map(|raw| raw as i64))
        }
        None => vec![PointLabel::Unlabelled; points.len()],
    };
    let positions = points.positions().collect();
    let cloud = match options.settings.time_field.as_str() {
        "none" => PointCloud::from_one_origin(Point3::origin(), positions, labels),
        field => {
            let times = point_times(cloud, &points, field, options).map_err(refuse)?;
            let stays = Deskew::new(cloud, recording, world).map_err(refuse)?;
            stays.apply(positions, labels, &times).map_err(refuse)?
        }
    };
    let mut warnings = Vec::new();
    let hinted = |fault: Fault| located(fault).hint(LABELS_HINT);
    let unknown = raw_labels.finish(file, &mut warnings).map_err(hinted)?;
    Ok(SweepPoints { cloud, warnings, unknown }.located(hinted))
}

fn point_times(
    cloud: &Cloud,
    points: &Points<'_>,
    field: &str,
    options: &McapOptions,
) -> Result<Vec<Timestamp>, Defect> {
    let unit_s = options.settings.time_unit_s;
    let time = |number: f64| {
        let begin_ns = if number * unit_s < EPOCH_TIMES_FROM_S { cloud.header.time.0 } else { 0 };
        Timestamp(begin_ns.saturating_add((number * unit_s * 1e9).round() as i64))
    };
    Ok(points.numbers(field)?.map(time).collect())
}

/// Moves points from where their lidar stood to where it stands at the sweep's time.
struct Deskew<'a> {
    recording: &'a Recording,
    world: &'a str,
    frame: &'a str,
    frame_from_lidar: Pose,
    lidar_from_world: Pose,
}

impl<'a> Deskew<'a> {
    fn new(cloud: &'a Cloud, recording: &'a Recording, world: &'a str) -> Result<Self, Defect> {
        let frame = cloud.header.frame.as_str();
        let no_pose = |found| Defect::new("a pose of the lidar", found);
        let (frame_from_lidar, _) = checked_pose(&cloud.pose).map_err(no_pose)?;
        let world_from_frame = recording.frames.pose(world, frame, cloud.header.time);
        let world_from_lidar = world_from_frame.map_err(no_pose)? * frame_from_lidar;
        let lidar_from_world = world_from_lidar.inverse();
        Ok(Self { recording, world, frame, frame_from_lidar, lidar_from_world })
    }

    /// Each time has an origin of its own.
    fn apply(
        &self,
        positions: Vec<Point3<f64>>,
        labels: Vec<PointLabel>,
        times: &[Timestamp],
    ) -> Result<PointCloud<PointLabel>, Defect> {
        let mut cloud = PointCloud::with_origins(Vec::new());
        let mut moves: BTreeMap<Timestamp, (u32, RigidMap)> = BTreeMap::new();
        for ((position, label), time) in positions.into_iter().zip(labels).zip(times) {
            let (origin, then) = match moves.get(time) {
                Some(known) => *known,
                None => {
                    let then = RigidMap::from(&self.lidar_from_lidar(*time)?);
                    let origin = cloud.origins.len() as u32;
                    cloud.origins.push(then.apply(&Point3::origin()));
                    moves.insert(*time, (origin, then));
                    (origin, then)
                }
            };
            cloud.push(then.apply(&position), label, origin);
        }
        Ok(cloud)
    }

    /// From the lidar at a time to the lidar at the sweep's.
    fn lidar_from_lidar(&self, time: Timestamp) -> Result<Pose, Defect> {
        let world_from_frame = self.recording.frames.pose(self.world, self.frame, time);
        let world_from_frame = world_from_frame
            .map_err(|found| Defect::new("a pose of the lidar at each point's time", found))?;
        Ok(self.lidar_from_world * world_from_frame * self.frame_from_lidar)
    }
}
