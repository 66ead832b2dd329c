//! The parsers of logs in nuScenes' layout, for whoever throws bytes at them.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use occlabel_testkit::{LidarPattern, LogSpec, in_folder, write_log};

use super::{NuScenesLog, NuScenesOptions, QuaternionOrder};
use crate::doors::read_options;
use crate::{SceneSource, check_poses};

/// The files of a sound drive of two keyframes: tables, points, labels.
static FILES: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let root = std::env::temp_dir().join(format!("occlabel-drive-{}", std::process::id()));
    let lidar = LidarPattern { beams: 4, azimuths: 8, max_range_m: 70.0 };
    let spec = LogSpec {
        keyframes: 2,
        sweeps_per_keyframe: 1,
        lidar,
        annotations: Some(5),
        ..LogSpec::nano()
    };
    write_log(&root, &spec).unwrap();
    let mut files = Vec::new();
    collect(&root, "", &mut files);
    fs::remove_dir_all(&root).unwrap();
    files.sort();
    files
});

fn collect(folder: &Path, prefix: &str, files: &mut Vec<(String, Vec<u8>)>) {
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        match entry.path().is_dir() {
            true => collect(&entry.path(), &format!("{name}/"), files),
            false => files.push((name, fs::read(entry.path()).unwrap())),
        }
    }
}

/// The drive with other bytes in the file that the first byte tells; whether all of it was read.
pub(crate) fn drive(bytes: &[u8]) -> bool {
    let Some((&place, bytes)) = bytes.split_first() else { return false };
    let mut files: Vec<(&str, &[u8])> =
        FILES.iter().map(|(name, bytes)| (&name[..], &bytes[..])).collect();
    let place = usize::from(place) % files.len();
    files[place].1 = bytes;
    in_folder(&files, |root| {
        let _ = NuScenesLog::reference_faults(root, None);
        let options = NuScenesOptions {
            read: read_options(),
            version: None,
            quaternion_order: QuaternionOrder::Wxyz,
            columns: None,
        };
        NuScenesLog::open(root, options).is_ok_and(|log| is_whole(&log))
    })
}

fn is_whole(log: &NuScenesLog) -> bool {
    log.scene_names().iter().all(|name| {
        let Ok(scene) = log.load(name) else { return false };
        let _ = (check_poses(&scene, Some(0.5)), log.image_files(name), log.scene_points(&scene));
        let read = scene.sweeps.iter().filter(|sweep| log.read_sweep(sweep).is_ok()).count();
        scene.refused.is_empty() && read == scene.sweeps.len()
    })
}

/// Every file, behind its number.
pub(crate) fn files() -> Vec<Vec<u8>> {
    (0..).zip(FILES.iter()).map(|(place, (_, bytes))| [&[place], &bytes[..]].concat()).collect()
}
