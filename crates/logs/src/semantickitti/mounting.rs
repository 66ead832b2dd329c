//! Where the ego vehicle stands, of which the format says nothing: it knows a camera and a lidar.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::Pose;

/// How high KITTI's camera 0 stands above the road, metres (KITTI's drawing of the sensors' setup).
const CAMERA_HEIGHT_M: f64 = 1.65;

/// The ego vehicle's origin is on the road below camera 0, its axes the camera's, turned.
///
/// ```text
///   camera     z forward, x right, y down
///   ego        x forward, y left,  z up
/// ```
pub(super) fn ego_from_camera() -> Pose {
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, 0.5, -0.5));
    Pose::from_parts(Translation3::new(0.0, 0.0, CAMERA_HEIGHT_M), turn)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;

    #[test]
    fn ahead_right_and_down_of_the_camera_are_ahead_right_and_down_of_the_ego() {
        let moved = ego_from_camera() * Point3::new(1.0, 2.0, 3.0);
        assert!((moved - Point3::new(3.0, -1.0, CAMERA_HEIGHT_M - 2.0)).norm() < 1e-12);
    }
}
