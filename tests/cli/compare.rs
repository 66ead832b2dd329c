//! Two label sets, compared.

use std::fs;

use serde_json::Value;

use crate::labelled::labelled;
use crate::support::{Ended, Label, SCENE, occlabel, text};

fn compare(line: &[&str]) -> Ended {
    occlabel(&[&["compare"], line].concat())
}

fn json(ended: &Ended) -> Value {
    serde_json::from_str(&ended.stdout).expect("one JSON object")
}

#[test]
fn a_set_is_equal_to_itself() {
    let (_log, label) = labelled(&[]);
    let tree = text(&label.output);
    let ended = compare(&[tree, tree, "--json"]).exits(0);
    let json = json(&ended);
    assert_eq!((&json["equal"], &json["comparison"]["differing"]), (&true.into(), &0.into()));
    assert_eq!(json["comparison"]["keyframes"], 3);
    assert_eq!(json["comparison"]["semantic"]["miou"], 1.0);
    assert_eq!(json["comparison"]["rays"]["mean"], 1.0);
    let rays = json["comparison"]["rays"]["truth_rays"].as_array().expect("rays by class");
    let rays: u64 = rays.iter().filter_map(Value::as_u64).sum();
    assert!(rays > 10_000, "{rays} rays");
}

#[test]
fn sets_that_differ_exit_with_1_and_name_the_worst_keyframe() {
    let (log, label) = labelled(&[]);
    let other = Label::new(&log.root(), &log.beside("other")).small();
    other.clone().with(&["--set", "states.occupied_min_hits=3"]).run().exits(0);
    let (a, b) = (text(&label.output), text(&other.output));
    let ended = compare(&[a, b]).exits(1).tells(&["at most 0 of the voxels", SCENE]);
    for part in
        ["By class", "mask_lidar", "occupied to free", "RayIoU", "Keyframes that differ most"]
    {
        assert!(ended.stdout.contains(part), "{part} in\n{}", ended.stdout);
    }
    compare(&[a, b, "--tolerance", "0.5", "--quick"]).exits(0);
    let json = json(&compare(&[a, b, "--quick", "--json", "--worst", "1"]).exits(1));
    assert_eq!(json["worst"].as_array().map(Vec::len), Some(1));
    let share = json["worst"][0]["differing_share"].as_f64().expect("a share");
    compare(&[a, b, "--quick", "--tolerance", &share.to_string()]).exits(0);
    compare(&[a, b, "--quick", "--tolerance", &(share * 0.999).to_string()]).exits(1);
}

#[test]
fn a_keyframe_that_one_set_lacks_is_a_difference() {
    let (log, label) = labelled(&[]);
    let some = Label::new(&log.root(), &log.beside("some")).small();
    some.clone().with(&["--keyframes", &log.keyframes()[0]]).run().exits(0);
    let (all, some) = (text(&label.output), text(&some.output));
    compare(&[all, some, "--tolerance", "1"]).exits(1).tells(&["2 absent", &log.keyframes()[1]]);
    compare(&[some, all, "--tolerance", "1"]).exits(1).tells(&["2 more"]);
}

#[test]
fn sets_of_other_grids_or_classes_exit_with_2() {
    let (log, label) = labelled(&[]);
    let coarse = Label::new(&log.root(), &log.beside("coarse")).small();
    coarse.clone().with(&["--set", "grid.voxel_size_m=1.6"]).run().exits(0);
    let (a, b) = (text(&label.output), text(&coarse.output));
    compare(&[a, b]).exits(2).tells(&["40 x 40 x 8", "20 x 20 x 4"]);
    compare(&[a, text(&log.root())]).exits(2);
    compare(&[a, a, "--tolerance", "2"]).exits(2);
}

#[test]
fn origins_of_rays_can_be_told() {
    let (log, label) = labelled(&[]);
    let (tree, file) = (text(&label.output), log.beside("origins.json"));
    let of = |token: &String| (token.clone(), Value::from(vec![vec![0.0, 0.0, 1.0]]));
    let origins: serde_json::Map<_, _> = log.keyframes().iter().map(of).collect();
    fs::write(&file, Value::from(origins).to_string()).unwrap();
    compare(&[tree, tree, "--ray-origins", text(&file)]).exits(0);
    fs::write(&file, "{}").unwrap();
    compare(&[tree, tree, "--ray-origins", text(&file)]).exits(1).tells(&["RayIoU", "none of"]);
    fs::write(&file, "[]").unwrap();
    compare(&[tree, tree, "--ray-origins", text(&file)]).exits(1).tells(&["origins.json"]);
}

#[test]
fn evidence_is_compared_where_both_have_it() {
    let (log, label) = labelled(&["--evidence"]);
    let (tree, bare) = (text(&label.output), log.beside("bare"));
    Label::new(&log.root(), &bare).small().run().exits(0);
    let arrays = |b: &str| {
        json(&compare(&[tree, b, "--quick", "--json"]).exits(0))["comparison"]["arrays"].clone()
    };
    assert_eq!((&arrays(tree)["flow"], &arrays(tree)["instances"]), (&0.into(), &0.into()));
    let bare = text(&bare);
    compare(&[tree, bare, "--quick"]).exits(1).tells(&["flow in A only", "--shared-arrays"]);
    let shared = json(&compare(&[tree, bare, "--quick", "--json", "--shared-arrays"]).exits(0));
    assert_eq!(shared["comparison"]["arrays"]["flow"], Value::Null);
    let other = Label::new(&log.root(), &log.beside("other")).small();
    other.clone().with(&["--evidence", "--set", "boxes.max_gap_s=0.1"]).run().exits(0);
    let ended = compare(&[tree, text(&other.output), "--quick", "--json"]).exits(1);
    assert!(json(&ended)["comparison"]["arrays"]["flow"].as_u64() > Some(0), "{}", ended.stdout);
}
