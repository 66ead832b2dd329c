//! Tables: versions, tokens, broken rows.

use std::cell::Cell;
use std::fs;

use occlabel_core::Loss;
use occlabel_logs::{NuScenesLog, SceneSource};
use proptest::prelude::*;
use serde_json::json;

use crate::tiny_log::{NAN, TinyLog};

#[test]
fn the_only_version_is_found_and_several_are_listed() {
    let root = TinyLog::new().write();
    assert!(NuScenesLog::format_defaults(root.path(), Some("v1.0-tiny")).is_ok());
    fs::create_dir(root.path().join("v1.0-mini")).unwrap();
    let several = NuScenesLog::format_defaults(root.path(), None).unwrap_err().to_string();
    assert!(several.contains("found `v1.0-mini`, `v1.0-tiny`; hint: name one"), "{several}");
    let absent = NuScenesLog::format_defaults(root.path(), Some("v1.0-test")).unwrap_err();
    assert!(absent.to_string().contains("a folder `v1.0-test`"), "{absent}");
    let escape = NuScenesLog::format_defaults(root.path(), Some("../x"));
    assert_eq!(escape.unwrap_err().rule, "version-folder");
    fs::remove_dir_all(root.path().join("v1.0-tiny")).unwrap();
    fs::remove_dir_all(root.path().join("v1.0-mini")).unwrap();
    let none = NuScenesLog::format_defaults(root.path(), None).unwrap_err().to_string();
    assert!(none.ends_with("found none"), "{none}");
}

#[test]
fn only_wanted_scenes_are_read_and_an_unknown_one_tells_the_nearest() {
    let mut log = TinyLog::new();
    log.copy("scene", "scene-a", &[("token", json!("scene-b")), ("name", json!("scene-0002"))]);
    let names = log.open().unwrap().log.scene_names();
    assert_eq!(names, ["scene-0001", "scene-0002"]);
    log.options = |options| options.read.scenes = Some(["scene-0002".into()].into());
    let open = log.open().unwrap();
    assert_eq!(open.log.scene_names(), ["scene-0002"]);
    assert_eq!(open.log.load("scene-0001").unwrap_err().rule, "scene-unknown");
    log.options = |options| options.read.scenes = Some(["scene-0020".into()].into());
    let refusal = log.refusal();
    assert!(refusal.contains("there is `scene-0001`, `scene-0002`"), "{refusal}");
}

#[test]
fn rows_of_unwanted_scenes_cost_nothing_and_harm_nothing() {
    let mut log = TinyLog::new();
    log.copy("scene", "scene-a", &[("token", json!("scene-b")), ("name", json!("../bad"))]);
    log.copy("sample", "s0", &[("token", json!("sb")), ("scene_token", json!("scene-b"))]);
    log.copy(
        "sample_annotation",
        "a0",
        &[("token", json!("ab")), ("sample_token", json!("sb")), ("size", json!("no size"))],
    );
    assert!(log.refusal().contains("no size"));
    log.options = |options| options.read.scenes = Some(["scene-0001".into()].into());
    assert_eq!(log.scene().tracks[0].boxes.len(), 2);
}

#[test]
fn a_scene_name_of_two_scenes_is_refused() {
    let mut log = TinyLog::new();
    log.copy("scene", "scene-a", &[("token", json!("scene-b"))]);
    assert!(log.refusal().contains("expected a name of its own, found `scene-0001`"));
}

#[test]
fn an_absent_table_is_told_by_its_path() {
    let mut log = TinyLog::new();
    log.tables.remove("ego_pose");
    let refusal = log.refusal();
    assert!(refusal.contains("v1.0-tiny/ego_pose.json: expected a file, found none"), "{refusal}");
}

#[test]
fn a_broken_row_is_told_by_table_token_and_byte() {
    let mut log = TinyLog::new();
    log.row("sample_data", "l1")["timestamp"] = json!("noon");
    let refusal = log.refusal();
    assert!(refusal.starts_with("sample_data.json (l1, at byte "), "{refusal}");
    assert!(refusal.contains("invalid type: string \"noon\", expected i64"), "{refusal}");
}

#[test]
fn fault_31_dangling_tokens_are_told_by_table_and_token() {
    for (table, token, field, target) in [
        ("sample", "s0", "scene_token", "scene"),
        ("sample_data", "l0", "sample_token", "sample"),
        ("sample_data", "l0", "ego_pose_token", "ego_pose"),
        ("sample_data", "c0", "ego_pose_token", "ego_pose"),
        ("sample_data", "l0", "calibrated_sensor_token", "calibrated_sensor"),
        ("calibrated_sensor", "cal-lidar", "sensor_token", "sensor"),
        ("sample_annotation", "a0", "sample_token", "sample"),
        ("sample_annotation", "a0", "instance_token", "instance"),
        ("instance", "i0", "category_token", "category"),
    ] {
        let mut log = TinyLog::new();
        log.row(table, token)[field] = json!("nowhere");
        let refusal = log.refusal();
        let place = format!("{table}.json ({token}, at byte ");
        let rest = format!("expected a row `nowhere` in {target}.json, found none");
        assert!(refusal.starts_with(&place) && refusal.contains(&rest), "{refusal}");
    }
}

#[test]
fn fault_31_duplicate_tokens_are_told_by_table_and_token() {
    for (table, token) in [
        ("scene", "scene-a"),
        ("sample", "s0"),
        ("sample_data", "l1"),
        ("ego_pose", "pose-l1"),
        ("calibrated_sensor", "cal-cam"),
        ("sensor", "sensor-lidar"),
        ("instance", "i0"),
        ("category", "cat-car"),
        ("sample_annotation", "a0"),
    ] {
        let mut log = TinyLog::new();
        let change = if table == "scene" { ("name", json!("scene-0002")) } else { ("x", json!(1)) };
        log.copy(table, token, &[change]);
        let refusal = log.refusal();
        assert!(refusal.starts_with(&format!("{table}.json ({token}, at byte ")), "{refusal}");
        assert!(refusal.contains("one row a token"), "{refusal}");
    }
}

#[test]
fn fault_31_a_chain_in_a_ring_ends() {
    let mut log = TinyLog::new();
    log.row("sample_data", "l0")["next"] = json!("l0");
    log.row("sample_data", "l1")["next"] = json!("nowhere");
    let scene = log.scene();
    assert_eq!(scene.sweeps.len(), 3);
    let refused = scene.refused.iter().map(|refusal| (refusal.loss, refusal.fault.rule));
    let refused: Vec<_> = refused.collect();
    let link = |rule| (Loss::Link, rule);
    assert_eq!(refused, [link("chain-broken"), link("dangling-token"), link("chain-ring")]);
}

#[test]
fn fault_31_long_rings_and_their_tails_are_told_once() {
    let mut log = TinyLog::new();
    for (token, prev, next) in [("l0", "", "l1"), ("l1", "l0", "l2"), ("l2", "l1", "l1")] {
        log.row("sample_data", token)["prev"] = json!(prev);
        log.row("sample_data", token)["next"] = json!(next);
    }
    let scene = log.scene();
    let told: Vec<_> = scene.refused.iter().map(|refusal| refusal.fault.to_string()).collect();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].contains("whose `prev` names this one") && told[0].contains("is `l0`"));
    assert!(told[1].contains("(l1, at byte") && told[1].contains("a way back to here"));
}

#[test]
fn fault_31_chains_of_samples_images_and_boxes_are_followed_too() {
    let mut log = TinyLog::new();
    for (table, token) in [("sample", "s0"), ("sample_data", "c0"), ("sample_annotation", "a0")] {
        log.row(table, token)["next"] = json!(token);
    }
    let scene = log.scene();
    let rings = scene.refused.iter().filter(|refusal| refusal.fault.rule == "chain-ring");
    let places: Vec<_> = rings.map(|refusal| refusal.fault.place.as_str()).collect();
    assert_eq!(places, ["sample.json", "sample_data.json", "sample_annotation.json"]);
    let mut log = TinyLog::new();
    log.row("sample_annotation", "a0")["next"] = json!("absent");
    let scene = log.scene();
    assert!(scene.refused.is_empty(), "an absent box is fault 21");
    assert_eq!(scene.warnings[0].rule, "dangling-token");
}

#[test]
fn fault_23_a_bare_nan_does_not_spoil_its_table() {
    let mut log = TinyLog::new();
    log.row("sample_annotation", "a0")["num_lidar_pts"] = json!(NAN);
    log.row("ego_pose", "pose-r0")["translation"] = json!([NAN, 0.0, 0.0]);
    let scene = log.scene();
    assert_eq!(scene.tracks[0].boxes.len(), 2);
    assert!(scene.refused.is_empty() && scene.warnings.is_empty());
}

#[test]
fn fault_31_mutated_tables_never_panic() {
    let (root, tiny) = (TinyLog::new().write(), TinyLog::new());
    let table = root.path().join("v1.0-tiny/sample_data.json");
    let text = fs::read(&table).unwrap();
    let (good, bad) = (Cell::new(0), Cell::new(0));
    let byte = prop_oneof![prop::sample::select(b"\"\\{}[],:0-9eN ".to_vec()), any::<u8>()];
    let edits = prop::collection::vec((0..text.len(), byte), 1..4);
    proptest!(ProptestConfig::with_cases(400), |(edits in edits)| {
        let mut mutated = text.clone();
        for (at, byte) in edits {
            mutated[at] = byte;
        }
        fs::write(&table, &mutated).unwrap();
        let scene = tiny.open_in(root.path()).and_then(|log| log.load("scene-0001"));
        let seen = if scene.is_ok() { &good } else { &bad };
        seen.set(seen.get() + 1);
    });
    assert_eq!(good.get() + bad.get(), 400);
    assert!(good.get() > 2 && bad.get() > 100, "{} good, {} bad", good.get(), bad.get());
}
