//! Where a keyframe's grid stands, written down.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Pose, SweepHeader, Timestamp};
use serde::{Deserialize, Serialize};

/// Where the ego and the reference lidar stood at a keyframe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseRecord {
    /// The keyframe.
    pub token: String,
    /// The reference sweep's time, nanoseconds.
    pub time_ns: i64,
    /// The ego's pose at that time.
    pub world_from_ego: RigidRecord,
    /// The reference lidar's mounting.
    pub ego_from_lidar: RigidRecord,
}

/// A rigid transform as numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RigidRecord {
    /// Metres.
    pub translation: [f64; 3],
    /// A unit quaternion w, x, y, z.
    pub rotation: [f64; 4],
}

impl PoseRecord {
    /// The record of a keyframe with this reference sweep.
    pub fn new(token: &str, reference: &SweepHeader) -> Self {
        Self {
            token: token.to_owned(),
            time_ns: reference.time.0,
            world_from_ego: (&reference.world_from_ego).into(),
            ego_from_lidar: (&reference.ego_from_lidar).into(),
        }
    }

    /// Where a grid in the lidar's frame, or else in the ego's, stands.
    pub fn world_from_grid(&self, in_lidar_frame: bool) -> Pose {
        let world_from_ego = Pose::from(&self.world_from_ego);
        match in_lidar_frame {
            true => world_from_ego * Pose::from(&self.ego_from_lidar),
            false => world_from_ego,
        }
    }

    /// When it was.
    pub fn time(&self) -> Timestamp {
        Timestamp(self.time_ns)
    }
}

impl From<&Pose> for RigidRecord {
    fn from(pose: &Pose) -> Self {
        let q = &pose.rotation;
        Self { translation: pose.translation.vector.into(), rotation: [q.w, q.i, q.j, q.k] }
    }
}

impl From<&RigidRecord> for Pose {
    fn from(record: &RigidRecord) -> Self {
        let [w, x, y, z] = record.rotation;
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        Self::from_parts(Translation3::from(record.translation), rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    #[test]
    fn a_pose_survives_its_record() {
        let turn = UnitQuaternion::from_euler_angles(0.1, -0.2, 3.0);
        let pose = Pose::from_parts(Translation3::new(1.0, -2.0, 3.5), turn);
        let back = Pose::from(&RigidRecord::from(&pose));
        let p = Point3::new(10.0, 20.0, -5.0);
        assert!((back * p - pose * p).norm() < 1e-12);
        let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 90_f64.to_radians());
        let [w, _, _, z] =
            RigidRecord::from(&Pose::from_parts(Translation3::identity(), quarter)).rotation;
        assert!((w - z).abs() < 1e-12, "w first: {w}, {z}");
    }
}
