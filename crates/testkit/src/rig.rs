//! The recording car: how it drives, and where its sensors sit.
//!
//! The ego frame stands on the ground under the middle of the rear axle, x forward, y left, z up.
//! Mounting places are those of nuScenes' cars, rounded; angles are the nominal ones.

use crate::pose::{Pose, pose, yaw_pose};
use std::f64::consts::FRAC_PI_2;

/// The lane in which the ego drives.
const EGO_LANE_Y_M: f64 = -2.0;
const LIDAR_PLACE_M: [f64; 3] = [0.94, 0.0, 1.84];
/// Turns camera axes (x right, y down, z forward) into ego axes, for a camera that looks ahead.
const EGO_FROM_OPTICAL: [f64; 4] = [0.5, -0.5, 0.5, -0.5];

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    /// Channel name.
    pub(crate) channel: &'static str,
    /// Place in the ego frame.
    pub(crate) place_m: [f64; 3],
    /// Direction of view, in degrees left of ahead.
    pub(crate) yaw_deg: f64,
    /// Horizontal field of view.
    pub(crate) fov_deg: f64,
    /// Its exposure, from the lidar's key sweep.
    pub(crate) delay_us: i64,
}

impl Camera {
    /// Image width.
    pub(crate) const WIDTH: u32 = 1600;
    /// Image height.
    pub(crate) const HEIGHT: u32 = 900;

    /// Where it sits and looks.
    pub(crate) fn ego_from_camera(&self) -> Pose {
        yaw_pose(self.place_m, self.yaw_deg.to_radians()) * pose([0.0; 3], EGO_FROM_OPTICAL)
    }

    /// The intrinsic matrix, by rows.
    pub(crate) fn intrinsic(&self) -> [[f64; 3]; 3] {
        let (cx, cy) = (f64::from(Self::WIDTH) / 2.0, f64::from(Self::HEIGHT) / 2.0);
        let focal = cx / libm::tan(self.fov_deg.to_radians() / 2.0);
        [[focal, 0.0, cx], [0.0, focal, cy], [0.0, 0.0, 1.0]]
    }
}

/// The six cameras of nuScenes.
pub(crate) fn cameras() -> [Camera; 6] {
    let camera = |channel, place_m, yaw_deg, fov_deg, delay_us| Camera {
        channel,
        place_m,
        yaw_deg,
        fov_deg,
        delay_us,
    };
    [
        camera("CAM_FRONT", [1.70, 0.02, 1.51], 0.0, 70.0, 4_000),
        camera("CAM_FRONT_LEFT", [1.52, 0.49, 1.51], 55.0, 70.0, -4_000),
        camera("CAM_FRONT_RIGHT", [1.55, -0.49, 1.50], -55.0, 70.0, 12_000),
        camera("CAM_BACK", [0.03, 0.0, 1.58], 180.0, 110.0, -20_000),
        camera("CAM_BACK_LEFT", [1.04, 0.48, 1.59], 110.0, 70.0, -12_000),
        camera("CAM_BACK_RIGHT", [1.01, -0.48, 1.56], -110.0, 70.0, 20_000),
    ]
}

/// Where the lidar sits: its x axis points to the car's right, its y axis ahead.
pub(crate) fn ego_from_lidar() -> Pose {
    yaw_pose(LIDAR_PLACE_M, -FRAC_PI_2)
}

/// The ego at a time: along world x, at the world's origin (but for its lane) at time zero.
pub(crate) fn world_from_ego(speed_mps: f64, time_s: f64) -> Pose {
    yaw_pose([speed_mps * time_s, EGO_LANE_Y_M, 0.0], 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    #[track_caller]
    fn assert_near(found: Vector3<f64>, expected: [f64; 3]) {
        let error = (found - Vector3::from(expected)).norm();
        assert!(error < 1e-12, "expected {expected:?}, found {found:?}");
    }

    #[test]
    fn the_left_camera_looks_left_ahead_and_sees_down_as_down() {
        let ego_from_camera = cameras()[1].ego_from_camera();
        let yaw = 55.0_f64.to_radians();
        assert_near(ego_from_camera * Vector3::z(), [libm::cos(yaw), libm::sin(yaw), 0.0]);
        assert_near(ego_from_camera * Vector3::y(), [0.0, 0.0, -1.0]);
    }

    #[test]
    fn the_lidars_y_axis_points_ahead() {
        assert_near(ego_from_lidar() * Vector3::y(), [1.0, 0.0, 0.0]);
        assert_near((ego_from_lidar() * Point3::origin()).coords, LIDAR_PLACE_M);
    }

    #[test]
    fn the_field_of_view_ends_at_the_images_edge() {
        let [[focal, _, cx], ..] = cameras()[3].intrinsic();
        let half_deg = libm::atan(cx / focal).to_degrees();
        assert!((half_deg - 55.0).abs() < 1e-9, "{half_deg}");
    }
}
