//! Where the sensors are mounted.
//!
//! ```text
//!   IMU       x ahead, y right, z down: poses.txt tells where it is
//!   ego       x ahead, y left,  z up: on the road below the IMU
//!   velodyne  1.73 m above the road
//! ```

use std::path::Path;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Fault, Pose};

use crate::number_rows::{numbers, read_lines};
use crate::transform::pose_from_rows;

/// Mountings of cameras on the IMU, and of camera 0 on the lidar.
const CAMERAS: &str = "calibration/calib_cam_to_pose.txt";
const LIDAR: &str = "calibration/calib_cam_to_velo.txt";
/// The lenses of cameras 0 and 1.
pub(super) const LENSES: &str = "calibration/perspective.txt";
/// All of them.
pub(super) const FILES: [&str; 3] = [CAMERAS, LIDAR, LENSES];

/// How high the lidar stands above the road, metres (KITTI's drawing of the sensors' setup).
const LIDAR_HEIGHT_M: f64 = 1.73;

/// The mountings of a log: all its drives were driven with the same.
#[derive(Debug)]
pub(super) struct Calibration {
    pub(super) ego_from_imu: Pose,
    pub(super) ego_from_lidar: Pose,
    cameras: Vec<String>,
}

impl Calibration {
    /// Reads the mountings.
    ///
    /// # Errors
    /// If a file cannot be used.
    pub(super) fn read(root: &Path) -> Result<Self, Fault> {
        let cameras = read_lines(root, CAMERAS)?;
        let imu_from_camera = named_pose(CAMERAS, &cameras, "image_00:")?;
        let lidar = read_lines(root, LIDAR)?.join(" ");
        let lidar_from_camera = numbers(&lidar).and_then(|rows| pose_from_rows(&rows));
        let lidar_from_camera = lidar_from_camera.map_err(|found| no_pose(LIDAR, found))?;
        let imu_from_lidar = imu_from_camera * lidar_from_camera.inverse();
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0));
        let up_m = (turn * imu_from_lidar.translation.vector).z;
        let height = Translation3::new(0.0, 0.0, LIDAR_HEIGHT_M - up_m);
        let ego_from_imu = Pose::from_parts(height, turn);
        let ego_from_lidar = ego_from_imu * imu_from_lidar;
        Ok(Self { ego_from_imu, ego_from_lidar, cameras })
    }

    /// `imu_from_camera`, the camera as it was mounted, not rectified.
    ///
    /// # Errors
    /// If the file does not tell.
    pub(super) fn imu_from_camera(&self, camera: &str) -> Result<Pose, Fault> {
        named_pose(CAMERAS, &self.cameras, &format!("{camera}:"))
    }
}

/// The rest of the first line that begins so.
///
/// # Errors
/// If there is none.
pub(super) fn named_line<'a>(
    file: &str,
    lines: &'a [String],
    name: &str,
) -> Result<&'a str, Fault> {
    let line = lines.iter().find_map(|line| line.trim_start().strip_prefix(name));
    line.ok_or_else(|| Fault::new("calibration", file, format!("a line {name}"), "no such line"))
}

fn named_pose(file: &str, lines: &[String], name: &str) -> Result<Pose, Fault> {
    let rows = numbers(named_line(file, lines, name)?);
    let pose = rows.and_then(|rows| pose_from_rows(&rows));
    pose.map_err(|found| no_pose(file, found).record(name))
}

fn no_pose(file: &str, found: String) -> Fault {
    Fault::new("calibration", file, "12 numbers of a rigid transform", found)
}
