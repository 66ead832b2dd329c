//! Presets, files and single keys.

use std::fs;

use serde_json::{Value, json};

use crate::labelled::labelled;
use crate::support::{Label, TestLog, manifest, text};

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
