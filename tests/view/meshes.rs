//! PLY and GLB files.

use std::fs;

use crate::outside::{node, python};
use crate::street::street;
use crate::support::{manifest, text};

#[test]
fn solids_and_points_are_the_voxels() {
    let street = street();
    let tokens = manifest(&street.labels)["scenes"]["street"]["poses"].clone();
    let token = tokens[1]["token"].as_str().expect("a token");
    let middle = street.view("middle.glb", &[]).0;
    let kinds: [(&str, &[&str]); 3] =
        [("a.glb", &[]), ("b.ply", &["--mesh", "cubes"]), ("c.ply", &[])];
    let files = kinds.map(|(name, args)| {
        let (file, ended) = street.view(name, &[args, &["--keyframes", token]].concat());
        ended.exits(0);
        file
    });
    assert_eq!(fs::read(middle).expect("a file"), fs::read(&files[0]).expect("a file"));
    let [glb, cubes, points] = files.each_ref().map(|file| text(file));
    let args = [text(&street.labels), token, glb, cubes, points];
    let Some(compared) = python("mesh_agrees.py", &args) else { return };
    let count = |what: &str| compared[what].as_u64().unwrap_or_default();
    let at_least = [("points", 400), ("triangles", 500), ("quads", 200), ("nodes", 3)];
    assert!(at_least.iter().all(|&(what, few)| count(what) >= few), "{compared}");
}

#[test]
fn khronos_validator_has_nothing_to_say() {
    let (file, ended) = street().view("valid.glb", &[]);
    ended.exits(0);
    let Some(issues) = node("gltf_issues.js", &[text(&file)]) else { return };
    for kind in ["errors", "warnings", "infos", "hints"] {
        assert_eq!(issues[kind], 0, "{issues}");
    }
    assert!(issues["draws"].as_u64() >= Some(3), "{issues}");
}

#[test]
fn flags_that_a_mesh_has_no_use_for_are_refused() {
    let street = street();
    let refused = |output: &str, args: &[&str], told: &[&str]| {
        let (file, ended) = street.view(output, args);
        ended.exits(2).tells(told);
        assert!(!file.exists());
    };
    refused("x.glb", &["--mesh", "points"], &["--mesh", "ends in .ply"]);
    refused("x.ply", &street.with_log(), &["--input", "ends in .mcap"]);
    refused("x.ply", &["--keyframes", "a,b"], &["one keyframe", "2 of them"]);
    refused("x.obj", &[], &[".glb", "another ending"]);
}
