//! The points of a sweep as every log format has them.

use nalgebra::Point3;
use occlabel_core::Timestamp;

use crate::{Drive, What};

use super::raw_names::RawNames;

/// One point of a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoggedPoint {
    /// In the frame of its lidar at the sweep's time, metres.
    pub(crate) position_m: Point3<f32>,
    /// Number of its ray within the shot: its beam.
    pub(crate) ring: u16,
    /// When it was measured.
    pub(crate) time: Timestamp,
    /// The number of its raw label.
    pub(crate) raw: u8,
    /// The mover it belongs to.
    pub(crate) mover: Option<usize>,
}

/// The points of a sweep of the scene, in the order of its rays.
pub(crate) fn logged_points(drive: &Drive, names: &RawNames, sweep: usize) -> Vec<LoggedPoint> {
    let cloud = drive.points(sweep);
    let measured = drive.returns(sweep).into_iter().zip(cloud.positions).zip(cloud.labels);
    measured
        .map(|((found, position_m), label)| LoggedPoint {
            position_m: position_m.cast(),
            ring: found.ring as u16,
            time: found.time,
            raw: names.raw(drive.world().class_of(found.hit.what), label),
            mover: match found.hit.what {
                What::Mover(mover) => Some(mover),
                _ => None,
            },
        })
        .collect()
}
