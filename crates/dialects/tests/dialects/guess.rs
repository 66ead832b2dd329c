//! Which dialect a folder is in, and which keyframes it holds.

use std::path::Path;

use occlabel_core::{Fault, VoxelGrid};
use occlabel_dialects::{Dialect, KeyframeKey, LabelSet, Layout};

use crate::support::{dialect, free, spec, write};

/// A set of two keyframes in two scenes, on a grid that the dialect's files can tell.
fn set(root: &Path, dialect: &Dialect) {
    let spec = match dialect.layout {
        Layout::Npz(_) => spec(),
        _ => dialect.grid.spec().unwrap(),
    };
    let mut labels = free(dialect, &spec);
    labels.semantics.values_mut()[3] = 1;
    labels.mask_lidar = Some(VoxelGrid::filled(&spec, 1));
    for (scene, token) in [("b", "1"), ("a", "2")] {
        write(root, dialect, &labels, scene, token);
    }
}

fn opened(folder: &Path) -> Result<LabelSet, Fault> {
    LabelSet::open(folder, None)
}

#[test]
fn each_dialect_is_told_by_its_files() {
    let mut told = 0;
    for dialect in Dialect::all() {
        let folder = tempfile::tempdir().unwrap();
        set(folder.path(), &dialect);
        let found =
            opened(folder.path()).unwrap_or_else(|fault| panic!("{}: {fault}", dialect.name));
        assert_eq!(found.dialect().name, dialect.name);
        assert_eq!(found.keyframes().len(), 2, "{}", dialect.name);
        assert_eq!(found.read(&found.keyframes()[0]).unwrap().semantics.values()[3], 1);
        told += 1;
    }
    assert_eq!(told, 14);
}

#[test]
fn a_set_is_found_from_any_of_its_folders() {
    let folder = tempfile::tempdir().unwrap();
    set(folder.path(), &dialect("occ3d-nuscenes"));
    let keys = |below: &str| {
        let set = opened(&folder.path().join(below)).unwrap();
        let told = |key: &KeyframeKey| format!("{}/{}", key.scene, key.token);
        set.keyframes().iter().map(|key| (told(key), set.read(key).is_ok())).collect::<Vec<_>>()
    };
    let both = [("a/2".to_owned(), true), ("b/1".to_owned(), true)];
    assert_eq!(keys(""), both);
    assert_eq!(keys("gts"), both);
    assert_eq!(keys("gts/a"), both[..1]);
    assert_eq!(keys("gts/a/2"), both[..1]);
}

#[test]
fn the_names_of_folders_above_decide_between_dialects_alike() {
    let folder = tempfile::tempdir().unwrap();
    set(folder.path(), &dialect("semantickitti"));
    let name = |below: &str| opened(&folder.path().join(below)).unwrap().dialect().name.clone();
    assert_eq!(name("sequences"), "semantickitti");
    std::fs::rename(folder.path().join("sequences"), folder.path().join("data_2d_raw")).unwrap();
    assert_eq!(name("data_2d_raw"), "sscbench-kitti360");
    std::fs::rename(folder.path().join("data_2d_raw"), folder.path().join("other")).unwrap();
    let fault = opened(&folder.path().join("other")).unwrap_err();
    assert!(fault.found.contains("semantickitti, sscbench-kitti360"), "{fault}");
    assert!(fault.hint.unwrap().contains("--dialect"));
}

#[test]
fn a_split_may_stand_above_the_scenes() {
    let (folder, waymo) = (tempfile::tempdir().unwrap(), dialect("occ3d-waymo"));
    let training = folder.path().join("training");
    set(&training, &waymo);
    let found = opened(folder.path()).unwrap();
    assert_eq!(found.dialect().name, "occ3d-waymo");
    assert_eq!(found.keyframes().len(), 2);
    assert!(found.read(&found.keyframes()[1]).is_ok());
    set(&folder.path().join("validation"), &waymo);
    let fault = LabelSet::open(folder.path(), Some("occ3d-waymo")).unwrap_err();
    assert!(fault.found.contains("twice"), "{fault}");
    assert!(LabelSet::open(&training, Some("occ3d-waymo")).is_ok());
}

#[test]
fn a_file_tells_its_grid() {
    let folder = tempfile::tempdir().unwrap();
    set(folder.path(), &dialect("occ3d-nuscenes"));
    let set = opened(folder.path()).unwrap();
    assert_eq!(set.spec().shape(), [4, 3, 2]);
    assert_eq!(set.spec().min_m().x, -40.0);
    assert_eq!(set.dialect().grid.voxel_size_m[0], 20.0);
    assert_eq!((set.frame(), set.classes().list.len()), ("ego", 17));
}
