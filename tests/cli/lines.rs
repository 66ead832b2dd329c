//! Help, usage, presets, and what a log holds.

use std::fs;
use std::path::Path;

use crate::support::{Label, SCENE, TestLog, files_under, occlabel, text, tree_hash};

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
    for format in ["waymo", "semantickitti", "mcap", "av2", "coda"] {
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
    let presets: Vec<_> = names.iter().filter(|name| !name.contains('/')).collect();
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
    for name in names.iter().filter(|name| name.starts_with("masks/")) {
        assert!(occlabel(&["presets", name]).exits(0).stdout.contains(" = \"road\""), "{name}");
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

#[test]
fn the_demo_labels_a_log_of_its_own_twice() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("demo");
    let first = occlabel(&["demo", "--output", text(&output)]).exits(0);
    let steps = ["simulate --world street", "label --format nuscenes", "quality", "A9w", "file://"];
    for step in steps {
        assert!(first.stdout.contains(step), "{step} in {}", first.stdout);
    }
    let hash = tree_hash(&output);
    let names: Vec<String> = files_under(&output).into_keys().collect();
    assert!(names.iter().any(|name| name == "log/v1.0-sim/scene.json"));
    let shown = ["pictures/sheet.png", "pictures/overlay.png", "labels.html", "report.html"];
    for made in shown.into_iter().chain(["labels/manifest.json"]) {
        assert!(names.iter().any(|name| name == made), "{made}");
    }
    occlabel(&["demo", "--output", text(&output)]).exits(0);
    assert_eq!(tree_hash(&output), hash);
}
