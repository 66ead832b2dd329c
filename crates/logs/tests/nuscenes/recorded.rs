//! A recorded drive: KITTI 0005 in the layout of nuScenes.

use std::path::PathBuf;

use occlabel_logs::{
    Inventory, NuScenesLog, NuScenesOptions, QuaternionOrder, ReadOptions, SceneSource,
};

use crate::tiny_log::{CAR, taxonomy};

/// The recorded drive: in `$OCCLABEL_DATA`, else in `shared/data` beside the workspace.
fn drive() -> Option<PathBuf> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("OCCLABEL_DATA").map_or_else(beside, PathBuf::from);
    let drive = data.join("kitti0005_nuscenes");
    drive.is_dir().then_some(drive)
}

#[test]
fn a_recorded_drive_is_read_as_its_makers_counted_it() {
    let Some(root) = drive() else {
        println!("skipped: no kitti0005_nuscenes in $OCCLABEL_DATA or ../shared/data");
        return;
    };
    let options = NuScenesOptions {
        read: ReadOptions { unknown_as: Some(CAR), ..ReadOptions::of(taxonomy()) },
        version: None,
        quaternion_order: QuaternionOrder::Wxyz,
        columns: None,
    };
    let log = NuScenesLog::open(&root, options).unwrap();
    let scene = log.load(&log.scene_names()[0]).unwrap();
    let points: usize =
        scene.sweeps.iter().map(|sweep| log.read_sweep(sweep).unwrap().cloud.len()).sum();
    assert_eq!((scene.sweeps.len(), points), (21, 2_504_840));
    assert_eq!((scene.keyframes.len(), scene.tracks.len()), (5, 12));
    assert_eq!(scene.tracks.iter().map(|track| track.boxes.len()).sum::<usize>(), 47);
    let camera = &scene.cameras[0];
    assert_eq!(camera.name, "CAM_FRONT");
    assert_eq!((camera.camera.width, camera.camera.height), (1242, 375));
    assert!(scene.keyframes.iter().all(|keyframe| keyframe.exposures.len() == 1));
    assert!(scene.refused.is_empty() && Inventory::take(&log, &root, &scene).missing.is_empty());
}
