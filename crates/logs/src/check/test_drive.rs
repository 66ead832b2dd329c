//! A drive for the tests of the checks.

use nalgebra::{Translation3, UnitQuaternion};
use occlabel_core::{PointsOf, Pose, SweepHeader, Timestamp};

/// Sweeps at 10 Hz along x, on the ground, which is not at the world's height 0.
pub(super) fn straight(sweeps: usize, speed_mps: f64) -> Vec<SweepHeader> {
    let sweep = |place: usize| SweepHeader {
        time: Timestamp(place as i64 * 100_000_000),
        lidar: "TOP".into(),
        source_id: format!("s{place}"),
        file: format!("{place}.bin"),
        world_from_ego: pose([place as f64 * speed_mps / 10.0, 0.0, 5.0], [0.0; 3]),
        ego_from_lidar: pose([1.0, 0.0, 2.0], [0.0; 3]),
        labelled: false,
        points_of: PointsOf::Moment,
    };
    (0..sweeps).map(sweep).collect()
}

/// A pose by place, roll, pitch and yaw.
pub(super) fn pose(place_m: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Pose::from_parts(Translation3::from(place_m), turn)
}
