//! The points of a sweep as every log format has them.

use nalgebra::Point3;
use occlabel_core::{Fault, Timestamp};

use crate::{Drive, What};

/// One point of a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoggedPoint<'a> {
    /// In the frame of its lidar at the sweep's time, metres.
    pub(crate) position_m: Point3<f32>,
    /// From the lidar at its own time, metres.
    pub(crate) range_m: f32,
    /// Number of its shot within the sweep.
    pub(crate) shot: usize,
    /// Number of its ray within the shot: its beam.
    pub(crate) ring: u16,
    /// When it was measured.
    pub(crate) time: Timestamp,
    /// Its raw label; empty if it has none.
    pub(crate) label: &'a str,
    /// The mover it belongs to.
    pub(crate) mover: Option<usize>,
}

/// The sweeps of the lidar that keyframes refer to, by their numbers in the scene: there is one at least.
///
/// # Errors
/// If the drive has no keyframe.
pub(crate) fn reference_sweeps(drive: &Drive) -> Result<Vec<usize>, Fault> {
    let scene = drive.scene();
    let Some(keyframe) = scene.keyframes.first() else {
        return Err(Fault::new("world", "keyframe_hz", "at least one keyframe", "none"));
    };
    let lidar = &scene.reference_sweep(keyframe).lidar;
    Ok((0..scene.sweeps.len()).filter(|&sweep| scene.sweeps[sweep].lidar == *lidar).collect())
}

/// The points of a sweep of the scene, in the order of its rays.
pub(crate) fn logged_points(drive: &Drive, sweep: usize) -> Vec<LoggedPoint<'_>> {
    let returns = drive.returns(sweep);
    let cloud = drive.points_of(sweep, &returns);
    let measured = returns.into_iter().zip(cloud.positions).zip(cloud.labels);
    let point = |((found, position_m), label): ((crate::Return, Point3<f64>), _)| LoggedPoint {
        position_m: position_m.cast(),
        range_m: found.position_m.coords.norm() as f32,
        shot: found.shot,
        ring: found.ring as u16,
        time: found.time,
        label: drive.raw_label(found.hit.what, label).unwrap_or_default(),
        mover: match found.hit.what {
            What::Mover(mover) => Some(mover),
            _ => None,
        },
    };
    measured.map(point).collect()
}
