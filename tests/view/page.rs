//! The page that `view` makes, opened in a browser without a network: it shows what the arrays say.

use std::fs;
use std::path::Path;

use crate::outside::browser;
use crate::support::{labelled_drive, manifest, occlabel, read_arrays, text};
use serde_json::{Value, json};

const WORLD: &str = include_str!("../fixtures/mcap_world.toml");

/// A name that a log could hold.
const HOSTILE: &str = "</script><script>hacked = 1</script><img src=x onerror='hacked = 1'>";

#[test]
fn the_page_shows_what_the_arrays_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let labels = labelled_drive(folder.path(), WORLD, ["nuscenes"; 2], "occ3d-nuscenes");
    let manifest = with_hostile_names(&labels);
    let (page, expected) = (folder.path().join("labels.html"), folder.path().join("expected.json"));
    occlabel(&["view", text(&labels), "--output", text(&page)]).exits(0);
    fs::write(&expected, expected_of(&labels, &manifest).to_string()).expect("written");
    let Some(measured) = browser("page.mjs", &[&page, &expected]) else { return };
    println!("{measured}");
}

#[test]
fn the_page_offers_only_what_the_labels_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let labels = labelled_drive(folder.path(), WORLD, ["nuscenes"; 2], "occ3d-nuscenes");
    let (bare, page) = (folder.path().join("bare"), folder.path().join("bare.html"));
    occlabel(&["convert", text(&labels), "--to", "surroundocc", "--output", text(&bare)]);
    occlabel(&["view", text(&bare), "--output", text(&page)]).exits(0);
    browser("bare_page.mjs", &[&page]);
}

#[test]
fn the_page_is_the_same_each_time_and_names_nothing_outside() {
    let folder = tempfile::tempdir().expect("a folder");
    let labels = labelled_drive(folder.path(), WORLD, ["nuscenes"; 2], "occ3d-nuscenes");
    let made = ["once", "again"].map(|name| {
        let page = folder.path().join(format!("{name}.html"));
        occlabel(&["view", text(&labels), "--output", text(&page)]).exits(0);
        fs::read_to_string(page).expect("a page")
    });
    assert!(made[0] == made[1]);
    let policy = "default-src 'none'; script-src 'nonce-occlabel'; style-src 'nonce-occlabel'";
    assert!(
        made[0].contains(policy) && !made[0].contains(" src=\"") && !made[0].contains("<link href")
    );
}

/// Gives each track a name that looks like markup; the manifest as it is then.
fn with_hostile_names(labels: &Path) -> Value {
    let mut manifest = manifest(labels);
    let scenes = manifest["scenes"].as_object_mut().expect("scenes");
    for track in
        scenes.values_mut().flat_map(|scene| scene["tracks"].as_array_mut().expect("tracks"))
    {
        let id = format!("{HOSTILE}{}", track["index"]);
        (track["id"], track["category"]) = (id.into(), HOSTILE.into());
    }
    fs::write(labels.join("manifest.json"), manifest.to_string()).expect("written");
    manifest
}

/// All that the page must know of a tree with one scene.
fn expected_of(labels: &Path, manifest: &Value) -> Value {
    let (name, scene) =
        manifest["scenes"].as_object().and_then(|all| all.iter().next()).expect("a scene");
    let tokens = scene["keyframes"].as_array().expect("keyframes").iter();
    let keyframes = tokens.map(|token| keyframe(labels, name, token.as_str().expect("a token")));
    let classes = manifest["classes"].as_array().expect("classes").iter();
    let tracks = scene["tracks"].as_array().expect("tracks").iter();
    json!({
        "shape": manifest["grid"]["shape"],
        "min_m": manifest["grid"]["min_m"],
        "size_m": manifest["grid"]["voxel_size_m"][0],
        "free": manifest["free"],
        "configuration": manifest["config_hash"],
        "cameras": scene["cameras"],
        "classes": classes.map(|class| class["name"].as_str().expect("a name").replace('_', " ")).collect::<Vec<_>>(),
        "tracks": tracks.map(|track| json!([track["index"], track["id"], track["category"]])).collect::<Vec<_>>(),
        "keyframes": keyframes.collect::<Vec<_>>(),
    })
}

fn keyframe(labels: &Path, scene: &str, token: &str) -> Value {
    let arrays = read_arrays(labels, scene, token);
    let (labels, evidence) = (&arrays.labels, &arrays.evidence);
    let flow: Vec<_> = evidence.flow.values().iter().flatten().map(|mps| json!(mps)).collect();
    json!({
        "token": token,
        "semantics": labels.semantics.values(),
        "mask_lidar": labels.mask_lidar.values(),
        "mask_camera": labels.mask_camera.values(),
        "instances": evidence.instances.values(),
        "camera_bits": evidence.camera_bits.values(),
        "hits": evidence.hits.values(),
        "crossings": evidence.crossings.values(),
        "flow": flow,
    })
}
