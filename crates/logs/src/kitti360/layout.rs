//! The drives of a folder, and the names of their files.
//!
//! ```text
//!   data_3d_raw/<drive>/velodyne_points/data/NNNNNNNNNN.bin      and timestamps.txt
//!   data_3d_raw/<drive>/velodyne_points/labels/NNNNNNNNNN.label  optional
//!   data_poses/<drive>/poses.txt, or cam0_to_world.txt
//!   data_2d_raw/<drive>/image_NN/timestamps.txt                  optional
//!   data_2d_raw/<drive>/image_NN/data_rect/NNNNNNNNNN.png        optional; data_rgb of fisheyes
//!   data_3d_bboxes/train/<drive>.xml                             optional
//!   data_3d_semantics/train/<drive>/static/FIRST_LAST.ply        optional
//!   calibration/
//! ```

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::ops::RangeInclusive;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;

use crate::files::unreadable;

/// The folder of all drives' points.
pub(super) const POINTS: &str = "data_3d_raw";

/// One drive: a scene, under the name of its folder.
#[derive(Clone, Debug)]
pub(super) struct Drive<'a>(pub(super) &'a str);

impl Drive<'_> {
    fn velodyne(&self) -> String {
        format!("{POINTS}/{}/velodyne_points", self.0)
    }

    /// The scans' times.
    pub(super) fn stamps(&self) -> String {
        format!("{}/timestamps.txt", self.velodyne())
    }

    /// The images' times.
    pub(super) fn image_stamps(&self, camera: &str) -> String {
        format!("data_2d_raw/{}/{camera}/timestamps.txt", self.0)
    }

    /// The image of a frame: rectified, or as a fisheye took it.
    pub(super) fn image(&self, camera: &str, is_rectified: bool, frame: usize) -> String {
        let folder = if is_rectified { "data_rect" } else { "data_rgb" };
        format!("data_2d_raw/{}/{camera}/{folder}/{frame:010}.png", self.0)
    }

    /// The points of a scan.
    pub(super) fn scan(&self, frame: usize) -> String {
        format!("{}/data/{frame:010}.bin", self.velodyne())
    }

    /// The labels of a scan's points.
    pub(super) fn labels(&self, frame: usize) -> String {
        format!("{}/labels/{frame:010}.label", self.velodyne())
    }

    /// Poses of the vehicle, or else of camera 0.
    pub(super) fn poses(&self) -> [String; 2] {
        ["poses.txt", "cam0_to_world.txt"].map(|file| format!("data_poses/{}/{file}", self.0))
    }

    /// The boxes.
    pub(super) fn boxes(&self) -> String {
        format!("data_3d_bboxes/train/{}.xml", self.0)
    }

    /// The frames whose scans are there.
    ///
    /// # Errors
    /// If their folder cannot be listed.
    pub(super) fn frames(&self, root: &Path) -> Result<BTreeSet<usize>, Fault> {
        let frame = |name: String| {
            let frame = name.strip_suffix(".bin")?.parse().ok()?;
            (format!("{frame:010}.bin") == name).then_some(frame)
        };
        let folder = format!("{}/data", self.velodyne());
        Ok(entries(root, &folder)?.into_iter().filter_map(frame).collect())
    }

    /// The fused clouds of what stands still: file, and first and last frame.
    ///
    /// # Errors
    /// If their folder cannot be listed.
    pub(super) fn windows(
        &self,
        root: &Path,
    ) -> Result<Vec<(String, RangeInclusive<usize>)>, Fault> {
        let folder = format!("data_3d_semantics/train/{}/static", self.0);
        let window = |name: String| {
            let (first, last) = name.strip_suffix(".ply")?.split_once('_')?;
            let frames = first.parse().ok()?..=last.parse().ok()?;
            Some((format!("{folder}/{name}"), frames))
        };
        let mut windows: Vec<_> = entries(root, &folder)?.into_iter().filter_map(window).collect();
        windows.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(windows)
    }
}

/// Whether a folder is a log of this layout.
pub(super) fn is_log(root: &Path) -> bool {
    disk::is_dir(&root.join(POINTS))
}

/// The names of the drives that have scans, in byte order.
///
/// # Errors
/// If the folder cannot be listed, or there is none.
pub(super) fn drives(root: &Path) -> Result<Vec<String>, Fault> {
    let mut names = entries(root, POINTS)?;
    names.retain(|name| disk::is_dir(&root.join(Drive(name).velodyne()).join("data")));
    names.sort_unstable();
    if names.is_empty() {
        let expected = "data_3d_raw/<drive>/velodyne_points/data";
        return Err(Fault::new("semantickitti-layout", POINTS, expected, "none"));
    }
    Ok(names)
}

/// The names in a folder; none if it is absent. One that is no UTF-8 is left out.
fn entries(root: &Path, folder: &str) -> Result<Vec<String>, Fault> {
    let listed = match disk::list(&root.join(folder)) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        listed => listed.map_err(|error| unreadable(folder, &error))?,
    };
    Ok(listed.into_iter().filter_map(|entry| entry.file_name().into_string().ok()).collect())
}
