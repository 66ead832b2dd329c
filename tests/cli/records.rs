//! The manifest.

use std::fs;

use serde_json::{Value, json};

use crate::labelled::{labelled, strings};
use crate::support::{Label, SCENE, TestLog, files_under, manifest, occlabel, text};

#[test]
fn the_manifest_says_how_to_read_the_arrays() {
    let (log, label) = labelled(&["--evidence"]);
    let manifest = manifest(&label.output);
    assert_eq!(
        manifest["program"],
        json!({"name": "occlabel", "version": env!("CARGO_PKG_VERSION")})
    );
    assert_eq!(manifest["preset"], "precise");
    assert_eq!(manifest["config_hash"].as_str().map(str::len), Some(64));
    let grid = json!({
        "frame": "ego", "axes": "xyz",
        "min_m": [-16.0, -16.0, -1.0], "max_m": [16.0, 16.0, 5.4],
        "voxel_size_m": [0.8, 0.8, 0.8], "shape": [40, 40, 8],
    });
    assert_eq!(manifest["grid"], grid);
    assert_eq!(
        (&manifest["free"], &manifest["classes"][4]),
        (&json!(17), &json!({"id": 4, "name": "car"}))
    );
    let ids: Vec<_> =
        manifest["classes"].as_array().expect("a list").iter().map(|c| c["id"].clone()).collect();
    assert_eq!(ids, (0..17).map(|id| json!(id)).collect::<Vec<_>>());
    let scene = &manifest["scenes"][SCENE];
    let cameras = strings(&scene["cameras"]);
    assert!(cameras.len() == 6 && cameras.is_sorted());
    assert_eq!(strings(&scene["keyframes"]), log.keyframes());
    assert_eq!(manifest["config"]["grid"]["voxel_size_m"], 0.8);
}

#[test]
fn the_manifests_tracks_are_numbered_in_the_order_of_their_ids() {
    let (log, label) = labelled(&[]);
    let manifest = manifest(&label.output);
    let tracks = manifest["scenes"][SCENE]["tracks"].as_array().expect("a list").clone();
    let ids: Vec<_> = tracks.iter().map(|track| track["id"].as_str()).collect();
    assert!(ids.is_sorted() && ids.len() == log.rows("instance").len());
    for (track, index) in tracks.iter().zip(1..) {
        assert_eq!(track["index"], index);
    }
    let car = json!({"category": "vehicle.car", "class": "car"});
    let is_car = |t: &&Value| t["category"] == car["category"] && t["class"] == car["class"];
    assert!(tracks.iter().find(is_car).is_some());
}

#[test]
fn the_manifest_lists_every_file_with_its_size_and_hash() {
    let (_log, label) = labelled(&["--evidence"]);
    let files = files_under(&label.output);
    let manifest = manifest(&label.output);
    let listed = manifest["files"].as_array().expect("a list");
    let paths: Vec<&str> = listed.iter().filter_map(|file| file["path"].as_str()).collect();
    let written: Vec<&String> = files.keys().filter(|name| name.starts_with("gts/")).collect();
    assert_eq!(paths, written);
    for file in listed {
        let bytes = &files[file["path"].as_str().expect("a path")];
        assert_eq!(file["bytes"], bytes.len());
        assert_eq!(file["blake3"], blake3::hash(bytes).to_hex().to_string());
    }
}

#[test]
fn the_manifest_knows_no_machine_and_leaves_nothing_to_guess() {
    let (log, label) = labelled(&["--jobs", "2", "--memory", "3GiB"]);
    let text = fs::read_to_string(label.output.join("manifest.json")).expect("a manifest");
    let folder = log.beside("");
    assert!(!text.contains(folder.to_str().expect("UTF-8")), "a path of the machine");
    assert!(!text.contains("\"auto\"") && !text.contains("\"taxonomy\": \"taxonomy\""));
    for word in ["jobs", "memory", "threads", "\"host\"", "seconds", "mtime", "3221225472"] {
        assert!(!text.contains(word), "{word}");
    }
}

#[test]
fn an_own_taxonomy_file_is_named_without_its_folders() {
    let log = TestLog::nano();
    let file = log.beside("my-classes.toml");
    let shipped = occlabel(&["presets", "taxonomies/occ3d-nuscenes"]).exits(0).stdout;
    fs::write(&file, shipped).expect("written");
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.clone().with(&["--set", &format!("taxonomy.file={}", text(&file))]).run().exits(0);
    let manifest = manifest(&label.output);
    assert_eq!(manifest["taxonomy"]["name"], "my-classes.toml");
    assert_eq!(manifest["config"]["taxonomy"]["file"], "my-classes.toml");
}
