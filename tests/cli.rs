//! The command line as the contract has it: what goes in, what comes out, and how it ends.

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde_json::{Value, json};
use support::{
    Ended, Label, SCENE, TestLog, files_under, gts_files, leftovers, manifest, nano_spec,
    npz_dates, occlabel, read_arrays, report, text, tree_hash,
};

/// 1980-01-01 as DOS has it: years since 1980, month, day.
const DOS_EPOCH: u16 = (1 << 5) | 1;

/// A labelled copy of the committed log.
fn labelled(args: &[&str]) -> (TestLog, Label) {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small().with(args);
    label.run().exits(0);
    (log, label)
}

/// When each file below a folder was last written.
fn times(root: &Path) -> BTreeMap<String, SystemTime> {
    let time = |name: &String| fs::metadata(root.join(name)).and_then(|meta| meta.modified());
    files_under(root).into_keys().map(|name| (name.clone(), time(&name).expect("a time"))).collect()
}

fn labels_path(token: &str) -> String {
    format!("gts/{SCENE}/{token}/labels.npz")
}

fn strings(value: &Value) -> Vec<String> {
    let list = value.as_array().expect("a list");
    list.iter().map(|item| item.as_str().expect("a string").to_owned()).collect()
}

// --- help, usage, presets ---------------------------------------------------------------------

#[test]
fn help_and_version_are_results() {
    let help = occlabel(&["--help"]).exits(0);
    for word in ["label", "inspect", "presets", "demo", "completions", "130 interrupted"] {
        assert!(help.stdout.contains(word), "{word}");
    }
    assert_eq!(help.stderr, "");
    let version = occlabel(&["--version"]).exits(0);
    assert_eq!(version.stdout, format!("occlabel {}\n", env!("CARGO_PKG_VERSION")));
    assert!(occlabel(&["label", "--help"]).exits(0).stdout.contains("--allow-missing-sweeps"));
}

#[test]
fn a_wrong_line_exits_with_2() {
    let lines: [&[&str]; 7] = [
        &[],
        &["paint"],
        &["label"],
        &["label", "--format", "floppy", "--input", "a", "--output", "b"],
        &["label", "--format", "nuscenes", "--input", "a", "--output", "b", "--shard", "2/2"],
        &["label", "--format", "nuscenes", "--input", "a", "--output", "b", "--columns", "6"],
        &["label", "--format", "nuscenes", "--input", "a", "--output", "b", "--memory", "8GiX"],
    ];
    for line in lines {
        let ended = occlabel(line).exits(2);
        assert!(ended.stdout.is_empty() && !ended.stderr.is_empty(), "{line:?}");
    }
}

#[test]
fn an_input_that_is_none_exits_with_2() {
    let log = TestLog::nano();
    let out = log.beside("out");
    let absent = log.beside("absent");
    Label::new(&absent, &out).run().exits(2).tells(&["absent", "expected", "found"]);
    Label::new(&log.beside(""), &out).run().exits(2).tells(&["v1.0-", "found none"]);
    let line = Label::new(&log.root(), &out).with(&["--version", "v1.0-trainval"]);
    line.run().exits(2).tells(&["v1.0-trainval", "v1.0-mini"]);
    assert!(!out.exists());
}

#[test]
fn a_wrong_format_is_told_the_right_one() {
    let log = TestLog::nano();
    let wrong = |format: &str, root: &Path| {
        occlabel(&["inspect", "--format", format, "--input", text(root)]).exits(2)
    };
    for format in ["waymo", "semantickitti", "mcap", "av2"] {
        wrong(format, &log.root()).tells(&["hint: it looks like `--format nuscenes`"]);
    }
    wrong("waymo", &log.beside("")).tells_nothing_of("looks like");
    fs::create_dir_all(log.beside("kitti/sequences/00/velodyne")).expect("folders");
    for format in ["nuscenes", "waymo", "mcap"] {
        wrong(format, &log.beside("kitti")).tells(&["it looks like `--format semantickitti`"]);
    }
    let file = log.beside("drive.mcap");
    fs::write(&file, b"").expect("a file");
    let folder = format!("give its folder: `--input {}`", log.beside("").display());
    let folder = folder.replace("/`", "`");
    wrong("mcap", &file).tells(&["drive.mcap", "found a file", &folder]);
}

#[test]
fn every_preset_is_listed_and_can_be_fed_back() {
    let list = occlabel(&["presets"]).exits(0).stdout;
    let names: Vec<&str> = list.lines().filter_map(|line| line.split(' ').next()).collect();
    for name in ["precise", "paper", "occ3d-nuscenes", "occ3d-waymo", "panommocc", "mobileocc"] {
        assert!(names.contains(&name), "{name}");
    }
    let log = TestLog::nano();
    let presets: Vec<_> = names.iter().filter(|name| !name.starts_with("taxonomies/")).collect();
    for name in &presets {
        let file = log.beside(&format!("{name}.toml"));
        fs::write(&file, occlabel(&["presets", name]).exits(0).stdout).expect("written");
        let line = Label::new(&log.root(), &log.beside("out")).with(&["--dry-run"]);
        // Point labels of nuScenes mean nothing to the taxonomies of other data sets.
        let line = line.with(&["--set", "taxonomy.file=occ3d-nuscenes"]);
        let named = line.clone().with(&["--preset", name]).run().exits(0);
        let fed = line.with(&["--config", text(&file)]).run().exits(0);
        assert_eq!(named.stdout, fed.stdout, "{name}");
    }
    assert!(presets.len() >= 6);
    for name in names.iter().filter(|name| name.starts_with("taxonomies/")) {
        assert!(occlabel(&["presets", name]).exits(0).stdout.contains("priority"), "{name}");
    }
    occlabel(&["presets", "best"]).exits(2).tells(&["best", "precise"]);
}

#[test]
fn every_shell_gets_completions_and_there_is_a_manual_page() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = occlabel(&["completions", shell]).exits(0).stdout;
        assert!(script.contains("occlabel") && script.contains("allow-missing-sweeps"), "{shell}");
    }
    let page = occlabel(&["man"]).exits(0).stdout;
    assert!(page.contains(".TH occlabel"), "{page}");
    assert_eq!(occlabel(&["completions", "man"]).exits(0).stdout, page);
    occlabel(&["completions", "tcl"]).exits(2).tells(&["tcl", "bash"]);
}

#[test]
fn inspect_tells_what_a_log_holds() {
    let log = TestLog::nano();
    let root = log.root();
    let told = occlabel(&["inspect", "--format", "nuscenes", "--input", text(&root)]).exits(0);
    for word in ["1 scenes", SCENE, "1.000 s", "LIDAR_TOP: 9 sweeps, 3 labelled", "vehicle.car"] {
        assert!(told.stdout.contains(word), "{word} in\n{}", told.stdout);
    }
    assert!(told.stdout.contains("CAM_FRONT: pinhole, 1600 x 900"), "{}", told.stdout);
    for token in log.keyframes() {
        assert!(told.stdout.contains(&format!("{token}: 16000000")), "{token}");
    }
    assert_eq!(told.stderr, "");
}

// --- what is written --------------------------------------------------------------------------

#[test]
fn the_tree_holds_what_the_contract_says_and_nothing_else() {
    let (log, label) = labelled(&[]);
    let mut expected: Vec<String> = log.keyframes().iter().map(|t| labels_path(t)).collect();
    expected.extend(["manifest.json".to_owned(), "report.json".to_owned()]);
    expected.sort();
    let found: Vec<String> = files_under(&label.output).into_keys().collect();
    assert_eq!(found, expected);
}

#[test]
fn the_arrays_have_the_manifests_shape_and_their_types() {
    let (log, label) = labelled(&["--evidence"]);
    assert_eq!(manifest(&label.output)["grid"]["shape"], json!([40, 40, 8]));
    let mut classes = [0_usize; 256];
    for token in log.keyframes() {
        // Reading refuses arrays of other types or shapes.
        let arrays = read_arrays(&label.output, SCENE, &token);
        let (labels, evidence) = (&arrays.labels, &arrays.evidence);
        for (at, &state) in evidence.state.values().iter().enumerate() {
            let class = labels.semantics.values()[at];
            classes[usize::from(class)] += 1;
            assert!(state <= 2 && (class != 17) == (state == 2));
            assert_eq!(labels.mask_lidar.values()[at], u8::from(state != 0));
            let seen = evidence.camera_bits.values()[at] != 0 && state != 0;
            assert_eq!(labels.mask_camera.values()[at], u8::from(seen));
            assert!(evidence.instances.values()[at] == 0 || state == 2);
        }
    }
    let (car, road, free) = (classes[4], classes[11], classes[17]);
    assert!(car > 20 && road > 200 && free > 10_000, "{car} {road} {free}");
}

#[test]
fn zip_entries_are_dated_1980_01_01() {
    let (_log, label) = labelled(&["--evidence"]);
    let mut entries = 0;
    for (name, bytes) in gts_files(&label.output) {
        for (entry, date, time) in npz_dates(&bytes) {
            assert_eq!((date, time), (DOS_EPOCH, 0), "{name}: {entry}");
            entries += 1;
        }
    }
    assert_eq!(entries, 3 * (3 + 6));
}

#[test]
fn evidence_comes_on_request_beside_the_same_labels() {
    let (log, label) = labelled(&[]);
    let more = Label::new(&log.root(), &log.beside("more")).small().with(&["--evidence"]);
    more.run().exits(0);
    let (plain, more) = (gts_files(&label.output), gts_files(&more.output));
    assert_eq!((plain.len(), more.len()), (3, 6));
    assert!(plain.iter().all(|(name, bytes)| more[name] == *bytes));
}

#[test]
fn evidence_can_be_asked_for_later() {
    let (_log, label) = labelled(&[]);
    label.clone().with(&["--evidence"]).run().exits(0);
    let evidence = gts_files(&label.output).into_keys().filter(|n| n.ends_with("evidence.npz"));
    assert_eq!(evidence.count(), 3);
    assert_eq!(manifest(&label.output)["files"].as_array().map(Vec::len), Some(6));
}

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

#[test]
fn the_report_counts() {
    let (log, label) = labelled(&[]);
    let report = report(&label.output);
    assert_eq!(
        (&report["outcome"], &report["total"]["keyframes"]),
        (&json!("complete"), &json!(3))
    );
    let points: usize = log
        .sweeps()
        .iter()
        .map(|s| log.points(s["filename"].as_str().expect("a name")).len())
        .sum();
    let dropped = &report["total"]["dropped"];
    let dropped: u64 =
        dropped.as_object().expect("counts").values().filter_map(Value::as_u64).sum();
    assert_eq!(report["total"]["points"].as_u64(), Some(points as u64 - dropped));
    assert_eq!(report["skipped_or_degraded"], json!([]));
}

// --- configuration ----------------------------------------------------------------------------

/// The resolved configuration of a run.
fn config(args: &[&str]) -> Value {
    let (_log, label) = labelled(args);
    manifest(&label.output)["config"].clone()
}

#[test]
fn settings_go_over_the_file_and_the_file_over_precise() {
    let log = TestLog::nano();
    let file = log.beside("mine.toml");
    let lines = "[states]\noccupied_min_hits = 3\nfree_min_crossings = 4\n";
    fs::write(&file, lines).expect("written");
    let states =
        &config(&["--config", text(&file), "--set", "states.free_min_crossings=5"])["states"];
    assert_eq!(
        (&states["occupied_min_hits"], &states["free_min_crossings"]),
        (&json!(3), &json!(5))
    );
    let twice =
        config(&["--set", "states.occupied_min_hits=5", "--set", "states.occupied_min_hits=2"]);
    assert_eq!(twice["states"]["occupied_min_hits"], 2);
}

#[test]
fn a_configuration_of_ones_own_has_no_presets_name() {
    let log = TestLog::nano();
    let file = log.beside("mine.toml");
    fs::write(&file, "[states]\noccupied_min_hits = 3\n").expect("written");
    let (_log, label) = labelled(&["--config", text(&file)]);
    assert!(manifest(&label.output)["preset"].is_null());
    let (_log, label) = labelled(&["--preset", "paper"]);
    assert_eq!(manifest(&label.output)["preset"], "paper");
}

#[test]
fn a_value_that_is_no_toml_is_a_string() {
    let config = config(&["--set", "raycast.outside=drop", "--set", "relabel.max_distance_m=none"]);
    assert_eq!(config["raycast"]["outside"], "drop");
    assert_eq!(config["relabel"]["max_distance_m"], "none");
}

#[test]
fn an_unknown_key_or_value_exits_with_2_and_is_named() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out"));
    for (setting, named) in [
        ("raycast.speed=9", "speed"),
        ("magic.key=1", "magic"),
        ("raycast.outside=sideways", "sideways"),
        ("states.occupied_min_hits=many", "many"),
        ("grid", "`grid`"),
        ("relabel.unknown_class=unicorn", "unicorn"),
        ("taxonomy.file=absent.toml", "absent.toml"),
    ] {
        label.clone().with(&["--set", setting]).run().exits(2).tells(&[named, "expected", "found"]);
    }
    label.clone().with(&["--preset", "best"]).run().exits(2).tells(&["best", "precise"]);
    label.clone().with(&["--config", "absent.toml"]).run().exits(2).tells(&["absent.toml"]);
    assert!(!label.output.exists());
}

// --- which part of a log ----------------------------------------------------------------------

#[test]
fn an_unknown_scene_or_keyframe_exits_with_2_and_is_named() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label
        .clone()
        .with(&["--scenes", "scene-0002"])
        .run()
        .exits(2)
        .tells(&["scene-0002", "scene-0001"]);
    label.clone().with(&["--keyframes", "abc"]).run().exits(2).tells(&["abc", "inspect"]);
    assert!(!label.output.exists());
}

#[test]
fn scenes_can_be_named_or_listed_in_a_file() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let list = log.beside("list.txt");
    fs::write(&list, "\nscene-0002\n").expect("written");
    let named =
        Label::new(&log.root(), &log.beside("named")).small().with(&["--scenes", "scene-0002"]);
    let listed = Label::new(&log.root(), &log.beside("listed"))
        .small()
        .with(&["--scenes-from", text(&list)]);
    named.run().exits(0);
    listed.run().exits(0);
    assert_eq!(tree_hash(&named.output), tree_hash(&listed.output));
    assert!(gts_files(&named.output).keys().all(|name| name.starts_with("scene-0002/")));
}

#[test]
fn scenes_can_be_listed_on_stdin() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let label = Label::new(&log.root(), &log.beside("out")).small();
    let mut command = label.with(&["--scenes-from", "-", "--dry-run"]).command();
    fs::write(log.beside("list.txt"), "scene-0002\n").expect("written");
    let list = fs::File::open(log.beside("list.txt")).expect("a list");
    let ended = Ended::of(command.stdin(list).output().expect("the program starts")).exits(0);
    assert!(ended.stdout.contains("scene-0002") && !ended.stdout.contains("scene-0001"));
}

#[test]
fn every_sweep_or_every_nth_can_be_a_keyframe() {
    let log = TestLog::nano();
    let of_sweeps = ["--set", "keyframes.source=sweeps"];
    let all = Label::new(&log.root(), &log.beside("all")).small().with(&of_sweeps);
    all.run().exits(0);
    assert_eq!(gts_files(&all.output).len(), 9);
    let fourth = Label::new(&log.root(), &log.beside("fourth")).small().with(&of_sweeps);
    let fourth = fourth.with(&["--set", "keyframes.stride=4"]);
    fourth.run().exits(0);
    let annotated: Vec<String> = gts_files(&labelled(&[]).1.output).into_keys().collect();
    assert_eq!(gts_files(&fourth.output).into_keys().collect::<Vec<_>>(), annotated);
}

#[test]
fn keyframes_limit_what_is_written_not_what_is_aggregated() {
    let (log, label) = labelled(&[]);
    let tokens = log.keyframes();
    let some = Label::new(&log.root(), &log.beside("some")).small();
    some.clone().with(&["--keyframes", &format!("{},{}", tokens[2], tokens[0])]).run().exits(0);
    let (all, some_files) = (gts_files(&label.output), gts_files(&some.output));
    assert_eq!(some_files.len(), 2);
    assert!(some_files.iter().all(|(name, bytes)| all[name] == *bytes));
    let listed = strings(&manifest(&some.output)["scenes"][SCENE]["keyframes"]);
    assert_eq!(listed, [tokens[0].clone(), tokens[2].clone()]);
}

#[test]
fn shards_share_the_scenes_and_one_tree() {
    let log = TestLog::simulated(&nano_spec().with_scenes(2));
    let (whole, shared) = (log.beside("whole"), log.beside("shared"));
    Label::new(&log.root(), &whole).small().run().exits(0);
    for (shard, scene) in [("0/2", "scene-0001"), ("1/2", "scene-0002")] {
        Label::new(&log.root(), &shared).small().with(&["--shard", shard]).run().exits(0);
        let name = format!("manifest.{}.json", shard.replace('/', "-of-"));
        let bytes = fs::read(shared.join(name)).expect("a shard's manifest");
        let manifest: Value = serde_json::from_slice(&bytes).expect("JSON");
        let scenes: Vec<_> = manifest["scenes"].as_object().expect("scenes").keys().collect();
        assert_eq!(scenes, [scene]);
    }
    assert!(gts_files(&whole) == gts_files(&shared), "shards write other bytes");
    assert!(!shared.join("manifest.json").exists());
    assert_eq!(leftovers(&shared), [""; 0]);
}

#[test]
fn a_dry_run_tells_and_writes_nothing() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small().with(&["--dry-run"]);
    let told = label.run().exits(0).stdout;
    for word in [SCENE, "3 keyframes", "rays", "bytes"] {
        assert!(told.contains(word), "{word} in\n{told}");
    }
    assert!(!label.output.exists());
}

// --- streams ----------------------------------------------------------------------------------

#[test]
fn results_go_to_stdout_and_all_else_to_stderr() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let ended = Label::new(&log.root(), &log.beside("out")).small().run().exits(0);
    assert!(ended.stdout.contains("3 keyframes") && !ended.stdout.contains("warning"));
    ended.tells(&["warning", "expected points, found none"]).tells_nothing_of("3 keyframes");
}

#[test]
fn a_total_is_told_of_several_scenes_only() {
    let log = TestLog::nano();
    let one = Label::new(&log.root(), &log.beside("out")).small().run().exits(0).stdout;
    assert!(one.lines().count() == 1 && one.starts_with(SCENE), "{one}");
    let log = TestLog::simulated(&occlabel_testkit::LogSpec { scenes: 2, ..nano_spec() });
    let two = Label::new(&log.root(), &log.beside("out")).small().run().exits(0).stdout;
    assert!(two.lines().count() == 3 && two.contains("\n2 scenes: "), "{two}");
}

#[test]
fn quiet_leaves_results_and_errors() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let label = Label::new(&log.root(), &log.beside("out")).small().with(&["--quiet"]);
    let ended = label.run().exits(0);
    assert!(ended.stderr.is_empty() && ended.stdout.contains("3 keyframes"), "{}", ended.stderr);
    label.with(&["--set", "states.occupied_min_hits=2"]).run().exits(2).tells(&["error"]);
}

#[test]
fn messages_can_be_json_with_where_expected_and_found() {
    let log = TestLog::nano();
    log.empty(&log.other_files()[0]);
    let label = Label::new(&log.root(), &log.beside("out")).small();
    let label = label.with(&["--log-format", "json", "--progress", "none"]);
    let warnings = label.run().exits(0).json_lines();
    assert_eq!(warnings.len(), 1);
    assert_eq!((&warnings[0]["level"], &warnings[0]["scene"]), (&json!("warning"), &json!(SCENE)));
    assert_eq!(warnings[0]["place"], log.other_files()[0].as_str());
    assert_eq!(
        (&warnings[0]["expected"], &warnings[0]["found"]),
        (&json!("points"), &json!("none"))
    );

    log.truncate(&log.other_files()[1], 3);
    let errors = label.with(&["--resume", "never"]).run().exits(1).json_lines();
    let error = errors.last().expect("an error");
    assert_eq!((&error["level"], &error["place"]), (&json!("error"), &json!(log.other_files()[1])));
}

#[test]
fn progress_can_be_json() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    let events = label.with(&["--progress", "json"]).run().exits(0).json_lines();
    let keyframes = events.iter().filter(|event| event["event"] == "keyframe");
    assert_eq!(keyframes.count(), 3);
    assert_eq!((&events[0]["event"], &events[0]["keyframes"]), (&json!("start"), &json!(3)));
    assert_eq!(events.last().map(|event| &event["event"]), Some(&json!("end")));
}

// --- memory -----------------------------------------------------------------------------------

/// The bytes that one keyframe at a time needs, as the program tells them.
fn bytes_needed(label: &Label) -> String {
    let ended = label.clone().with(&["--memory", "1kB"]).run().exits(1);
    let (_, rest) = ended.stderr.split_once("found ").expect("what was found");
    rest.split(' ').next().expect("a number").to_owned()
}

#[test]
fn too_little_memory_fails_before_any_work_and_says_what_is_needed() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small();
    label.clone().with(&["--memory", "1kB"]).run().exits(1).tells(&[
        SCENE,
        "1000 bytes",
        "--memory",
    ]);
    let needed: u64 = bytes_needed(&label).parse().expect("a number");
    label.clone().with(&["--memory", &(needed - 1).to_string()]).run().exits(1);
    assert!(!label.output.exists());
}

#[test]
fn one_keyframe_at_a_time_gives_the_same_bytes() {
    let (log, free) = labelled(&["--jobs", "3"]);
    let bound = Label::new(&log.root(), &log.beside("bound")).small().with(&["--jobs", "3"]);
    let bytes = bytes_needed(&bound);
    bound.clone().with(&["--memory", &bytes]).run().exits(0);
    assert_eq!(tree_hash(&bound.output), tree_hash(&free.output));
}

// --- an output that is not new ----------------------------------------------------------------

#[test]
fn the_same_command_again_keeps_everything() {
    let (_log, label) = labelled(&["--evidence"]);
    let (hash, before) = (tree_hash(&label.output), times(&label.output.join("gts")));
    label.run().exits(0);
    assert_eq!(times(&label.output.join("gts")), before);
    assert_eq!(tree_hash(&label.output), hash);
}

#[test]
fn a_file_that_went_away_is_made_again() {
    let (log, label) = labelled(&[]);
    let hash = tree_hash(&label.output);
    fs::remove_file(label.output.join(labels_path(&log.keyframes()[1]))).expect("removed");
    label.run().exits(0);
    assert_eq!(tree_hash(&label.output), hash);
}

#[test]
fn another_configuration_into_the_same_output_exits_with_2_and_names_the_key() {
    let (log, label) = labelled(&[]);
    let before = files_under(&label.output);
    let other = label.clone().with(&["--set", "states.occupied_min_hits=2"]);
    other.run().exits(2).tells(&["states.occupied_min_hits", "1 before, 2 now"]);
    log.edit("sensor", |rows| rows[0]["comment"] = json!("changed"));
    label.run().exits(2).tells(&["inputs_hash"]);
    assert!(files_under(&label.output) == before, "something was written");
}

#[test]
fn resume_never_starts_anew_and_leaves_foreign_files_alone() {
    let (log, label) = labelled(&["--evidence"]);
    let folder = PathBuf::from(labels_path(&log.keyframes()[0])).with_file_name("");
    let foreign =
        ["notes.txt".into(), folder.join("notes.txt"), PathBuf::from("gts/other/labels.npz")];
    for name in &foreign {
        let path = label.output.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, "mine").expect("written");
    }
    let other = ["--set", "states.occupied_min_hits=2"];
    let anew = Label::new(&log.root(), &label.output).small().with(&other);
    anew.with(&["--resume", "never"]).run().exits(0);
    let fresh = Label::new(&log.root(), &log.beside("fresh")).small().with(&other);
    fresh.run().exits(0);
    for name in &foreign {
        assert_eq!(fs::read(label.output.join(name)).expect("still there"), b"mine");
        fs::remove_file(label.output.join(name)).expect("removed");
    }
    assert_eq!(tree_hash(&label.output), tree_hash(&fresh.output));
}

#[test]
fn resume_always_keeps_what_is_finished() {
    let (_log, label) = labelled(&[]);
    let before = times(&label.output.join("gts"));
    let other = label.clone().with(&["--set", "states.occupied_min_hits=2", "--resume", "always"]);
    other.run().exits(0);
    assert_eq!(times(&label.output.join("gts")), before);
}

#[cfg(unix)]
mod interrupted {
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    use super::*;

    /// A log of 8 keyframes, to be labelled by one thread in the whole grid.
    fn long_run() -> (TestLog, Label) {
        let log = TestLog::simulated(&occlabel_testkit::LogSpec { keyframes: 8, ..nano_spec() });
        let label = Label::new(&log.root(), &log.beside("out")).with(&["--jobs", "1"]);
        (log, label)
    }

    /// Starts a run and waits until it has finished a keyframe, but not all.
    fn started(label: &Label) -> Child {
        let mut command = label.command();
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("started");
        let (journal, since) = (label.output.join("journal.jsonl"), Instant::now());
        while fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) == 0 {
            assert!(since.elapsed() < Duration::from_secs(60), "no keyframe was finished");
            std::thread::sleep(Duration::from_millis(5));
        }
        child
    }

    fn signal(child: &Child, name: &str) {
        let status = Command::new("kill").args([name, &child.id().to_string()]).status();
        assert!(status.expect("kill").success());
    }

    /// Ends an interrupted run by the same command; the tree is that of an undisturbed run.
    fn goes_on(log: &TestLog, label: &Label) {
        assert!(
            !label.output.join("manifest.json").exists() && label.output.join("run.json").exists()
        );
        let before = times(&label.output.join("gts"));
        let kept: Vec<_> = before.iter().filter(|(name, _)| name.ends_with(".npz")).collect();
        assert!((1..8).contains(&kept.len()), "{} keyframes before", kept.len());
        label.run().exits(0);
        let after = times(&label.output.join("gts"));
        assert!(kept.into_iter().all(|(name, time)| after[name] == *time), "made again");
        let undisturbed = Label::new(&log.root(), &log.beside("undisturbed"));
        undisturbed.run().exits(0);
        assert_eq!(tree_hash(&label.output), tree_hash(&undisturbed.output));
        assert_eq!(leftovers(&label.output), [""; 0]);
    }

    #[test]
    fn sigint_gives_130_and_the_same_command_goes_on() {
        let (log, label) = long_run();
        let child = started(&label);
        signal(&child, "-INT");
        let output = child.wait_with_output().expect("an end");
        Ended::of(output).exits(130).tells(&["the same command goes on"]);
        goes_on(&log, &label);
    }

    #[test]
    fn fault_39_a_second_writer_is_refused_and_a_killed_run_goes_on() {
        let (log, label) = long_run();
        let child = started(&label);
        label.run().exits(1).tells(&[".lock", &child.id().to_string()]);
        signal(&child, "-KILL");
        assert_eq!(child.wait_with_output().expect("an end").status.code(), None);
        goes_on(&log, &label);
    }
}

#[test]
fn the_demo_labels_a_log_of_its_own_twice() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("demo");
    let first = occlabel(&["demo", "--output", text(&output)]).exits(0);
    for step in ["simulate --world street", "label --format nuscenes", "quality", "A9w"] {
        assert!(first.stdout.contains(step), "{step} in {}", first.stdout);
    }
    let hash = tree_hash(&output);
    let names: Vec<String> = files_under(&output).into_keys().collect();
    assert!(names.iter().any(|name| name == "log/v1.0-sim/scene.json"));
    assert!(names.iter().any(|name| name == "pictures/perspective.png"));
    assert!(names.iter().any(|name| name == "labels/manifest.json"));
    occlabel(&["demo", "--output", text(&output)]).exits(0);
    assert_eq!(tree_hash(&output), hash);
}
