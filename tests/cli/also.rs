//! Several grids of one aggregation.

use std::fs;

use occlabel_core::{Blocks, VoxelState};
use occlabel_labels::Manifest;

use crate::labelled::labelled;
use crate::support::{
    Label, SCENE, SMALL, TestLog, files_under, leftovers, manifest, read_arrays, text, tree_hash,
};

/// The grid of [`SMALL`] as a file, with voxels twice as large.
const COARSE: &str = "[grid]\nframe = \"ego\"\nmin_m = [-16.0, -16.0, -1.0]\n\
    max_m = [16.0, 16.0, 5.4]\nvoxel_size_m = 1.6\n";

#[test]
fn pooled_labels_say_what_the_fine_ones_do() {
    let (log, label) = labelled(&["--evidence", "--also", "1.6,3.2"]);
    let token = &log.keyframes()[0];
    let fine = read_arrays(&label.output, SCENE, token);
    let pooled = read_arrays(&label.output.join("at-1.6m"), SCENE, token);
    let manifest = Manifest::load(&label.output.join("manifest.json")).unwrap().unwrap();
    let blocks = Blocks::of(&manifest.grid.spec().unwrap(), [1.6; 3]).unwrap();
    let state = |state: VoxelState| fine.evidence.state.map(|&s| s == state as u8);
    let occupied = state(VoxelState::Occupied);
    let some = blocks.map(|places| places.iter().any(|&at| occupied.values()[at]));
    assert_eq!(pooled.evidence.state.map(|&s| s == 2), some);
    let hits: u64 = fine.evidence.hits.values().iter().map(|&hits| u64::from(hits)).sum();
    let kept: u64 = pooled.evidence.hits.values().iter().map(|&hits| u64::from(hits)).sum();
    assert_eq!((hits, hits > 1000), (kept, true));
}

#[test]
fn each_grid_has_a_tree_of_its_own_and_the_whole_is_listed_above() {
    let (_log, label) = labelled(&["--also", "1.6,3.2"]);
    let files = files_under(&label.output);
    for (folder, size_m, shape) in [("at-1.6m", 1.6, [20, 20, 4]), ("at-3.2m", 3.2, [10, 10, 2])] {
        let manifest = manifest(&label.output.join(folder));
        assert_eq!(manifest["grid"]["voxel_size_m"][0], size_m);
        assert_eq!(manifest["grid"]["shape"], serde_json::json!(shape));
        assert_eq!(manifest["notes"][0], "pooled from voxels of 0.8 x 0.8 x 0.8 m");
        for file in manifest["files"].as_array().unwrap() {
            assert!(files.contains_key(&format!("{folder}/{}", file["path"].as_str().unwrap())));
        }
    }
    let main = manifest(&label.output);
    let listed: Vec<_> = main["files"].as_array().unwrap().iter().map(|f| &f["path"]).collect();
    assert_eq!(listed.len(), 3 * 3 + 2, "three keyframes thrice, and two manifests");
    assert_eq!(listed.len() + 2, files.len(), "manifest and report are not listed");
    assert_eq!(leftovers(&label.output), [""; 0]);
}

#[test]
fn another_grid_is_labelled_as_if_alone() {
    let log = TestLog::nano();
    let file = log.beside("coarse.toml");
    fs::write(&file, COARSE).unwrap();
    let both = Label::new(&log.root(), &log.beside("both")).small().with(&["--also", text(&file)]);
    both.run().exits(0);
    let alone = Label::new(&log.root(), &log.beside("alone")).small();
    let alone = alone.with(&["--set", "grid.voxel_size_m=1.6"]);
    alone.run().exits(0);
    let gts = |root: &std::path::Path| files_under(&root.join("gts"));
    assert!(gts(&both.output.join("in-coarse")) == gts(&alone.output));
    let config = |root: &std::path::Path| manifest(root)["config_hash"].clone();
    assert_eq!(config(&both.output.join("in-coarse")), config(&alone.output));
}

#[test]
fn grids_asked_for_later_are_added_and_the_same_command_again_keeps_all() {
    let (log, label) = labelled(&["--also", "1.6"]);
    let (hash, fine) = (tree_hash(&label.output), files_under(&label.output.join("gts")));
    label.run().exits(0);
    assert_eq!(tree_hash(&label.output), hash);
    let later = Label::new(&log.root(), &log.beside("later")).small();
    later.run().exits(0);
    later.clone().with(&["--also", "1.6"]).run().exits(0);
    assert_eq!(tree_hash(&later.output), hash);
    assert!(files_under(&later.output.join("gts")) == fine);
    later.clone().with(&["--also", "3.2"]).run().exits(0);
    let listed = |folder: &str| {
        let main = manifest(&later.output)["files"].to_string();
        main.matches(&format!("\"{folder}/")).count()
    };
    assert_eq!((listed("at-1.6m"), listed("at-3.2m")), (4, 4), "three keyframes and a manifest");
    later.clone().with(&["--resume", "never"]).run().exits(0);
    assert!(!later.output.join("at-1.6m").exists() && !later.output.join("at-3.2m").exists());
}

#[test]
fn a_grid_that_cannot_be_exits_with_2_before_anything_is_written() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).with(&SMALL);
    let also = |also: &str| label.clone().with(&["--also", also]).run().exits(2);
    also("1.2").tells(&["--also", "1.2", "whole multiple"]);
    also("0.8").tells(&["--also", "whole multiple"]);
    also("1.6,1.6").tells(&["--also", "at-1.6m", "twice"]);
    also("absent.toml").tells(&["absent.toml"]);
    let file = log.beside("none.toml");
    fs::write(&file, "[states]\n").unwrap();
    also(text(&file)).tells(&["none.toml", "[grid]"]);
    assert!(!label.output.exists());
}
