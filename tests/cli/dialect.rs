//! Labels written in other dialects.

use std::fs;
use std::path::Path;

use occlabel_dialects::{Annotations, KeyframeLabels, LabelSet, Wanted};
use serde_json::json;

use crate::labelled::labelled;
use crate::support::{
    Label, SCENE, SMALL, TestLog, files_under, leftovers, manifest, nano_spec, occlabel, text,
    tree_hash,
};

/// A label set of a dialect, in the small grid.
fn in_dialect(log: &TestLog, name: &str) -> Label {
    let label = Label::new(&log.root(), &log.beside(name)).small().with(&["--dialect", name]);
    label.run().exits(0);
    label
}

fn read(folder: &Path) -> Vec<KeyframeLabels> {
    let set = LabelSet::open(folder, None).expect("a label set");
    set.keyframes().iter().map(|key| set.read_with(key, &Wanted::ALL).expect("labels")).collect()
}

/// Voxels that are not free: of any class, or of one that the dialect has no label for.
fn occupied(labels: &KeyframeLabels, free: u8) -> Vec<bool> {
    labels.semantics.values().iter().map(|id| *id != free).collect()
}

#[test]
fn every_dialect_says_the_same_of_where_things_are() {
    let (log, own) = labelled(&[]);
    let free = LabelSet::open(&own.output, None).unwrap().classes().free_index();
    let mut compared = 0;
    let expected: Vec<_> = read(&own.output).iter().map(|one| occupied(one, free)).collect();
    let dialects = [
        "occ3d-nuscenes",
        "occ3d-waymo",
        "surroundocc",
        "openoccupancy",
        "openocc-v2",
        "openscene",
        "semantickitti",
        "sscbench-waymo",
        "uniocc",
    ];
    for name in dialects {
        let label = in_dialect(&log, name);
        let set = LabelSet::open(&label.output, None).unwrap();
        assert_eq!(set.dialect().name, name);
        let free = set.classes().free_index();
        let found: Vec<_> = read(&label.output).iter().map(|one| occupied(one, free)).collect();
        assert!(found.iter().flatten().any(|occupied| *occupied), "{name} is empty");
        assert!(found == expected || set.frame() == "lidar", "{name}");
        compared += u32::from(set.frame() == "ego");
        assert_eq!(leftovers(&label.output), [""; 0], "{name}");
        let listed = manifest(&label.output)["files"].as_array().map_or(0, Vec::len);
        assert_eq!(listed + 2, files_under(&label.output).len(), "{name}");
    }
    assert_eq!(compared, 4, "in the ego frame");
}

#[test]
fn the_published_grid_is_taken_unless_one_is_set() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).with(&["--dialect", "surroundocc"]);
    label.run().exits(0);
    let grid = manifest(&label.output)["grid"].clone();
    assert_eq!(grid["frame"], "lidar");
    assert_eq!(grid["min_m"], json!([-50.0, -50.0, -5.0]));
    assert_eq!(grid["shape"], json!([200, 200, 16]));
    assert!(!label.output.join("gts").exists(), "a folder of locks is left");
    assert!(!manifest(&label.output)["notes"].to_string().contains("grid:"));
    let file = format!("dense_voxels_with_semantic/{}.npy", log.keyframes()[0]);
    assert!(label.output.join(&file).is_file(), "{file}");
}

#[test]
fn what_a_dialect_cannot_say_stands_in_its_manifest() {
    let log = TestLog::nano();
    let notes = |name: &str| manifest(&in_dialect(&log, name).output)["notes"].to_string();
    assert!(notes("surroundocc").contains("mask_lidar"), "{}", notes("surroundocc"));
    assert!(notes("occ3d-waymo").contains("become vehicle"), "{}", notes("occ3d-waymo"));
    let occ3d = manifest(&in_dialect(&log, "occ3d-nuscenes").output)["notes"].clone();
    assert_eq!(occ3d.as_array().map(Vec::len), Some(1), "{occ3d}");
    assert!(occ3d[0].as_str().is_some_and(|note| note.starts_with("grid: 40 x 40 x 8")), "{occ3d}");
}

#[test]
fn what_the_log_knows_goes_along() {
    let log = TestLog::nano();
    let waymo = &read(&in_dialect(&log, "occ3d-waymo").output)[0];
    let pose = waymo.extras["ego2global"].floats();
    assert_eq!(pose[12..], [0.0, 0.0, 0.0, 1.0], "row by row");
    let whole: f64 = waymo.extras["infov"].floats().iter().sum();
    assert!(whole > 100.0 && whole < waymo.spec.len() as f64, "{whole} in view");
    let kitti = &read(&in_dialect(&log, "semantickitti").output)[0];
    let hit: f64 = kitti.extras["input"].floats().iter().sum();
    assert!(hit > 20.0, "{hit} voxels hit by the keyframe's own sweep");
}

#[test]
fn objects_and_their_flow_are_those_of_the_evidence() {
    let (log, own) = labelled(&["--evidence"]);
    let (own, theirs) = (read(&own.output), read(&in_dialect(&log, "openocc-v2").output));
    let mut moving = 0;
    for (own, theirs) in own.iter().zip(&theirs) {
        assert_eq!(own.instances, theirs.instances);
        let (own, theirs) = (own.flow.as_ref().unwrap(), theirs.flow.as_ref().unwrap());
        for (own, theirs) in own.values().iter().zip(theirs.values()) {
            assert_eq!(own[0].to_bits(), theirs[0].to_bits());
            assert_eq!(theirs[2], 0.0, "the dialect says two components");
            moving += u32::from(own[0] != 0.0);
        }
    }
    assert!(moving > 0, "{moving} voxels flow");
}

#[test]
fn a_dialect_and_others_come_from_one_aggregation() {
    let log = TestLog::nano();
    let both = Label::new(&log.root(), &log.beside("both")).small();
    both.clone().with(&["--also", "openocc-v2,1.6"]).run().exits(0);
    let alone = Label::new(&log.root(), &log.beside("alone")).with(&["--dialect", "openocc-v2"]);
    alone.run().exits(0);
    let files = |root: &Path| files_under(&root.join("openocc_v2"));
    assert!(files(&both.output.join("in-openocc-v2")) == files(&alone.output));
    assert_eq!(files(&alone.output).len(), 3);
    let hash = tree_hash(&both.output);
    both.clone().with(&["--also", "openocc-v2,1.6"]).run().exits(0);
    assert_eq!(tree_hash(&both.output), hash);
}

#[test]
fn an_unknown_dialect_exits_with_2_and_lists_those_there_are() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).with(&SMALL);
    label.clone().with(&["--dialect", "occ3d"]).run().exits(2).tells(&["occ3d-nuscenes", "uniocc"]);
    label.clone().with(&["--dialect", "uniocc", "--evidence"]).run().exits(2);
    assert!(!label.output.exists() && !SCENE.is_empty());
}

#[test]
fn occ3d_comes_with_its_list_of_keyframes() {
    let log = TestLog::nano();
    let label = in_dialect(&log, "occ3d-nuscenes");
    let list: Annotations =
        serde_json::from_slice(&fs::read(label.output.join("annotations.json")).unwrap()).unwrap();
    assert_eq!(list.train_split, [SCENE]);
    let (infos, tokens) = (&list.scene_infos[SCENE], log.keyframes());
    assert_eq!(infos.len(), 3);
    let mut at = &infos[&tokens[0]];
    for (here, next) in tokens.iter().zip(&tokens[1..]) {
        assert_eq!(at.next, *next);
        at = &infos[next];
        assert_eq!(at.prev, *here);
        assert!(label.output.join(&at.gt_path).is_file());
    }
    assert_eq!((at.next.as_str(), infos[&tokens[0]].prev.as_str()), ("", ""));
    let images = log.rows("sample_data");
    for camera in infos.values().flat_map(|info| info.camera_sensor.values()) {
        assert!(images.iter().any(|row| row["filename"] == camera.img_path.as_str()));
        assert!(camera.intrinsic.is_some_and(|k| k[0][0] > 100.0));
        assert!(camera.extrinsic.translation[2] > 0.5, "above the ground");
    }
    assert!(infos.values().all(|info| !info.camera_sensor.is_empty()));
    let listed = manifest(&label.output)["files"].to_string();
    assert!(listed.contains("annotations.json"));
}

#[test]
fn shards_are_one_set_to_whoever_reads_them() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.clone().with(&["--shard", "0/2"]).run().exits(0);
    let tree = text(&label.output);
    occlabel(&["describe", tree]).exits(1).tells(&["1-of-2"]);
    label.clone().with(&["--shard", "1/2"]).run().exits(0);
    let whole = Label::new(&log.root(), &log.beside("whole")).small();
    whole.run().exits(0);
    occlabel(&["compare", tree, text(&whole.output)]).exits(0);
    let told = occlabel(&["describe", tree]).exits(0).stdout;
    assert!(told.contains("40 x 40 x 8") && told.contains("nothing suspicious"), "{told}");
}
