//! Sweeps, keyframes and poses of a scene.

use occlabel_core::{Fault, KeyframeSource, Loss, Scene, Timestamp};
use occlabel_logs::{NuScenesLog, QuaternionOrder, SceneSource};
use serde_json::json;

use crate::tiny_log::{NAN, TinyLog, points, sweep_file};

fn tokens(scene: &Scene) -> Vec<&str> {
    scene.keyframes.iter().map(|keyframe| keyframe.token.as_str()).collect()
}

fn files(scene: &Scene) -> Vec<&str> {
    scene.sweeps.iter().map(|sweep| sweep.source_id.as_str()).collect()
}

fn rules(faults: &[Fault]) -> Vec<&str> {
    faults.iter().map(|fault| fault.rule).collect()
}

#[test]
fn section_2_a_scene_has_all_its_lidars_sweeps_key_or_not_with_their_own_time_and_pose() {
    let scene = TinyLog::new().scene();
    assert_eq!(files(&scene), ["l0", "l1", "l2"]);
    let micros = [1_000_000, 1_250_000, 1_500_000].map(Timestamp::from_micros);
    assert!(scene.sweeps.iter().map(|sweep| sweep.time).eq(micros));
    let x: Vec<f64> = scene.sweeps.iter().map(|s| s.world_from_lidar().translation.x).collect();
    assert_eq!(x, [11.0, 13.5, 16.0]);
    assert!(scene.warnings.is_empty() && scene.refused.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn section_2_sweeps_are_ordered_by_time_lidar_and_file() {
    let mut log = TinyLog::new();
    log.copy("sensor", "sensor-lidar", &[("token", json!("sensor-b")), ("channel", json!("A"))]);
    log.copy(
        "calibrated_sensor",
        "cal-lidar",
        &[("token", json!("cal-b")), ("sensor_token", json!("sensor-b"))],
    );
    log.copy(
        "sample_data",
        "l1",
        &[("token", json!("lb")), ("calibrated_sensor_token", json!("cal-b"))],
    );
    log.tables.get_mut("sample_data").unwrap().reverse();
    assert_eq!(files(&log.scene()), ["l0", "lb", "l1", "l2"]);
}

#[test]
fn section_2_keyframes_stand_at_the_reference_lidars_key_sweep_not_at_the_sample() {
    let scene = TinyLog::new().scene();
    assert_eq!(tokens(&scene), ["s0", "s1"]);
    assert_eq!(scene.keyframes[1].time, Timestamp::from_micros(1_500_000));
    assert_eq!(scene.reference_sweep(&scene.keyframes[1]).source_id, "l2");
}

#[test]
fn section_2_every_sweep_can_be_a_keyframe_under_its_own_token() {
    let mut log = TinyLog::new();
    log.keyframes.source = KeyframeSource::Sweeps;
    assert_eq!(tokens(&log.scene()), ["s0", "l1", "s1"]);
    log.keyframes.stride = 2;
    assert_eq!(tokens(&log.scene()), ["s0", "s1"]);
    log.keyframes.stride = 0;
    assert_eq!(tokens(&log.scene()).len(), 3, "a stride of 0 is no panic");
}

#[test]
fn section_2_without_any_key_sweep_all_sweeps_are_keyframes() {
    let mut log = TinyLog::new();
    log.row("sample_data", "l0")["is_key_frame"] = json!(false);
    log.row("sample_data", "l2")["is_key_frame"] = json!(false);
    let scene = log.scene();
    assert_eq!(tokens(&scene), ["l0", "l1", "l2"]);
    assert_eq!(scene.tracks[0].boxes[0].0, Timestamp::from_micros(1_020_000));
    assert_eq!(rules(&scene.warnings), ["key-sweep"]);
}

#[test]
fn section_2_a_sample_without_key_sweep_is_no_keyframe_and_its_boxes_go_by_its_time() {
    let mut log = TinyLog::new();
    log.row("sample_data", "l2")["is_key_frame"] = json!(false);
    let scene = log.scene();
    assert_eq!(tokens(&scene), ["s0"]);
    let times: Vec<Timestamp> = scene.tracks[0].boxes.iter().map(|(time, _)| *time).collect();
    assert_eq!(times, [1_000_000, 1_520_000].map(Timestamp::from_micros));
    assert!(scene.warnings[0].to_string().contains("(s1, at byte "), "{}", scene.warnings[0]);
}

#[test]
fn section_2_a_reference_lidar_that_is_not_there_is_a_fault() {
    let mut log = TinyLog::new();
    log.keyframes.reference_lidar = "LIDAR_BACK".into();
    assert_eq!(
        log.refusal(),
        "sample_data.json (scene-0001): expected sweeps of the reference lidar `LIDAR_BACK`, \
         found LIDAR_TOP"
    );
}

#[test]
fn fault_12_a_norm_slightly_off_is_mended_silently_then_with_a_warning_then_refused() {
    let load = |w: f64| {
        let mut log = TinyLog::new();
        log.row("ego_pose", "pose-l1")["rotation"] = json!([w, 0.0, 0.0, 0.0]);
        log.scene()
    };
    for (w, warned) in [(1.0 + 9e-7, 0), (1.0 - 1.1e-6, 1), (1.0 + 0.9999e-2, 1)] {
        let scene = load(w);
        assert_eq!((scene.sweeps.len(), scene.warnings.len()), (3, warned), "{w}");
        assert_eq!(scene.sweeps[1].world_from_ego.rotation.norm(), 1.0);
    }
    for w in [1.0 + 1.001e-2, 0.0, -0.5] {
        let scene = load(w);
        assert_eq!(files(&scene), ["l0", "l2"], "{w}");
        assert_eq!(scene.refused[0].loss, Loss::Sweep);
        assert_eq!(scene.keyframes.len(), 2);
    }
}

#[test]
fn fault_12_a_keyframe_goes_with_its_reference_sweep_and_no_other() {
    let mut log = TinyLog::new();
    log.row("ego_pose", "pose-l0")["rotation"] = json!([NAN, 0.0, 0.0, 0.0]);
    let scene = log.scene();
    assert_eq!(files(&scene), ["l1", "l2"]);
    assert_eq!(tokens(&scene), ["s1"]);
    assert_eq!(scene.keyframes[0].sweep, 1);
    let losses: Vec<Loss> = scene.refused.iter().map(|refusal| refusal.loss).collect();
    assert_eq!(losses, [Loss::Sweep, Loss::Keyframe]);
    assert_eq!(scene.tracks[0].boxes[0].0, Timestamp::from_micros(1_000_000), "time still holds");
}

#[test]
fn fault_12_positions_that_are_no_numbers_are_refused_likewise() {
    let mut log = TinyLog::new();
    log.row("ego_pose", "pose-l1")["translation"] = json!([0.0, NAN, 0.0]);
    let scene = log.scene();
    assert_eq!((files(&scene), scene.refused[0].fault.rule), (vec!["l0", "l2"], "translation"));
    let text = scene.refused[0].fault.to_string();
    assert!(text.starts_with("ego_pose.json (pose-l1, at byte "), "{text}");
}

#[test]
fn fault_12_a_lidars_mounting_spoils_the_scene() {
    let mut log = TinyLog::new();
    log.row("calibrated_sensor", "cal-lidar")["rotation"] = json!([0.7, 0.0, 0.0, 0.0]);
    let refusal = log.refusal();
    assert!(refusal.starts_with("calibrated_sensor.json (cal-lidar, at byte "), "{refusal}");
    assert!(refusal.ends_with("norm 1 to 0.01, found norm 0.7"), "{refusal}");
}

#[test]
fn fault_13_quaternions_can_be_read_with_their_real_part_last() {
    let mut log = TinyLog::new();
    let (sine, cosine) = (0.6, 0.8);
    log.row("ego_pose", "pose-l0")["rotation"] = json!([0.0, 0.0, sine, cosine]);
    log.options = |options| options.quaternion_order = QuaternionOrder::Xyzw;
    for token in ["pose-l1", "pose-l2", "pose-c0", "pose-c1", "pose-c2"] {
        log.row("ego_pose", token)["rotation"] = json!([0.0, 0.0, 0.0, 1.0]);
    }
    let scene = log.scene();
    let rotation = scene.sweeps[0].world_from_ego.rotation;
    assert_eq!((rotation.w, rotation.k), (cosine, sine));
    assert_eq!(scene.sweeps[1].world_from_ego.rotation.w, 1.0);
}

#[test]
fn fault_15_a_copy_of_a_sweep_is_left_out_the_key_frames_own_stays() {
    let mut log = TinyLog::new();
    log.copy(
        "sample_data",
        "l2",
        &[
            ("token", json!("copy")),
            ("filename", json!(sweep_file("a-copy"))),
            ("is_key_frame", json!(false)),
        ],
    );
    let bytes = log.files[&sweep_file("l2")].clone();
    log.files.insert(sweep_file("a-copy"), bytes);
    let scene = log.scene();
    assert_eq!(files(&scene), ["l0", "l1", "l2"]);
    assert_eq!(tokens(&scene), ["s0", "s1"]);
    assert_eq!(rules(&scene.warnings), ["sweep-copied"]);
    assert!(scene.warnings[0].to_string().contains("(copy, at byte"), "{}", scene.warnings[0]);
}

#[test]
fn fault_15_different_sweeps_of_one_time_are_both_kept_in_order_of_their_files() {
    let mut log = TinyLog::new();
    log.copy(
        "sample_data",
        "l1",
        &[("token", json!("other")), ("filename", json!(sweep_file("a-other")))],
    );
    log.files.insert(sweep_file("a-other"), points(&[[9.0, 9.0, 9.0]]));
    let scene = log.scene();
    assert_eq!(files(&scene), ["l0", "other", "l1", "l2"]);
    assert_eq!(rules(&scene.warnings), ["time-repeated"]);
    assert!(scene.warnings[0].found.contains("both are kept"));
}

#[test]
fn section_2_of_two_key_sweeps_of_a_sample_the_first_counts() {
    let mut log = TinyLog::new();
    log.row("sample_data", "l1")["is_key_frame"] = json!(true);
    let scene = log.scene();
    assert_eq!(tokens(&scene), ["s0", "s1"]);
    assert_eq!(scene.keyframes[1].time, Timestamp::from_micros(1_250_000));
    assert_eq!(rules(&scene.warnings), ["key-sweep-repeated"]);
    log.keyframes.source = KeyframeSource::Sweeps;
    assert_eq!(tokens(&log.scene()), ["s0", "s1", "l2"]);
}

#[test]
fn fault_15_a_whole_scene_of_one_stamp_is_read_once_and_sorted_by_file() {
    let mut log = TinyLog::new();
    for token in ["l0", "l1", "l2"] {
        log.row("sample_data", token)["timestamp"] = json!(0);
    }
    log.tables.get_mut("sample_annotation").unwrap().pop();
    let scene = log.scene();
    assert_eq!((files(&scene), tokens(&scene)), (vec!["l0", "l1", "l2"], vec!["s0", "s1"]));
    assert!(scene.warnings[0].to_string().contains("the first of 2 such records"));
}

#[test]
fn fault_16_times_going_backwards_are_sorted_and_reported() {
    let mut log = TinyLog::new();
    log.row("sample_data", "l0")["next"] = json!("l2");
    log.row("sample_data", "l2")["next"] = json!("l1");
    let scene = log.scene();
    assert_eq!(files(&scene), ["l0", "l1", "l2"]);
    assert_eq!(rules(&scene.warnings), ["time-backwards"]);
    assert!(scene.warnings[0].found.contains("`l1` earlier by 0.25 s"), "{}", scene.warnings[0]);
}

#[test]
fn fault_36_files_outside_the_root_and_unsafe_names_are_refused() {
    let refusal = |table: &str, token: &str, field: &str, value: &str| {
        let mut log = TinyLog::new();
        log.row(table, token)[field] = json!(value);
        log.refusal()
    };
    for file in ["/etc/passwd", "../../x", "a\\..\\b", "C:/x", "a\u{0}b", "a\u{1b}[31m"] {
        let text = refusal("sample_data", "l1", "filename", file);
        assert!(text.contains("expected a path below the log's root"), "{text}");
    }
    for name in ["../../x", "..", "", "a b", "a/b"] {
        let text = refusal("scene", "scene-a", "name", name);
        assert!(text.starts_with("scene.json (scene-a, at byte"), "{text}");
        assert!(text.contains("a name of A-Z"), "{text}");
    }
}

#[test]
fn fault_36_a_keyframes_token_has_to_be_a_folders_name() {
    let mut log = TinyLog::new();
    let token = "../s0";
    log.row("sample", "s0")["token"] = json!(token);
    for (table, row) in [
        ("sample_data", "l0"),
        ("sample_data", "c0"),
        ("sample_data", "r0"),
        ("sample_annotation", "a0"),
    ] {
        log.row(table, row)["sample_token"] = json!(token);
    }
    let refusal = log.refusal();
    assert!(refusal.contains("found `../s0`"), "{refusal}");
}

#[test]
fn fault_37_symbolic_links_are_followed_and_a_loop_is_told() {
    let tiny = TinyLog::new();
    let (open, outside) = (tiny.open().unwrap(), tempfile::tempdir().unwrap());
    let scene = open.log.load("scene-0001").unwrap();
    let path = |token: &str| open.root.path().join(sweep_file(token));
    std::fs::rename(path("l0"), outside.path().join("l0")).unwrap();
    std::fs::remove_file(path("l1")).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outside.path().join("l0"), path("l0")).unwrap();
        std::os::unix::fs::symlink(path("l1"), path("l1")).unwrap();
        assert_eq!(open.log.read_sweep(&scene.sweeps[0]).unwrap().cloud.len(), 2);
        let fault = open.log.read_sweep(&scene.sweeps[1]).unwrap_err();
        assert_eq!(fault.rule, "unreadable-file");
        assert!(fault.to_string().contains("symbolic link"), "{fault}");
    }
}

#[test]
fn defaults_are_known_before_a_log_is_opened() {
    let root = TinyLog::new().write();
    let defaults = NuScenesLog::format_defaults(root.path(), None).unwrap();
    assert_eq!(defaults.reference_lidar, "LIDAR_TOP");
    assert_eq!(defaults.taxonomy, "occ3d-nuscenes");
    assert_eq!(defaults.ego_box_m, Some(([-1.2, -1.1, -0.3], [3.7, 1.1, 2.2])));
    assert_eq!(TinyLog::new().open().unwrap().log.defaults(), defaults);
}
