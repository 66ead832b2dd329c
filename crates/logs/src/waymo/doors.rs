//! Logs of v2 of the Waymo Open Dataset, for whoever throws bytes at them.

use occlabel_testkit::in_folder;

use super::WaymoLog;
use crate::SceneSource;
use crate::doors::read_options;

macro_rules! files {
    ($($component:literal)*) => {
        [$((
            concat!($component, "/10000000000000000001_0_000_20_000.parquet"),
            include_bytes!(concat!(
                "../../tests/waymo/fixtures/v2/",
                $component,
                "/10000000000000000001_0_000_20_000.parquet"
            )),
        )),*]
    };
}

/// The files of a sound segment.
const FILES: [(&str, &[u8]); 8] = files!(
    "camera_calibration" "camera_image" "lidar" "lidar_box" "lidar_calibration" "lidar_pose"
    "lidar_segmentation" "vehicle_pose"
);

/// The segment with other bytes in the file that the first byte tells; whether all of it was read.
pub(crate) fn segment(bytes: &[u8]) -> bool {
    let Some((&place, bytes)) = bytes.split_first() else { return false };
    let mut files = FILES;
    files[usize::from(place) % FILES.len()].1 = bytes;
    in_folder(&files, |root| {
        let Ok(log) = WaymoLog::open(root, read_options()) else { return false };
        log.scene_names().iter().all(|name| {
            let Ok(scene) = log.load(name) else { return false };
            let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
            scene.refused.is_empty() && read == scene.sweeps.len()
        })
    })
}

/// Every file, behind its number.
pub(crate) fn files() -> Vec<Vec<u8>> {
    (0..).zip(FILES).map(|(place, (_, bytes))| [&[place], bytes].concat()).collect()
}
