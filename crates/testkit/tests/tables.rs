//! The tables of a written log hang together: every token resolves, every chain closes, every file
//! has as many points as labels.

use occlabel_testkit::{LogSpec, VERSION, write_log};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

const TABLES: [&str; 14] = [
    "attribute",
    "calibrated_sensor",
    "category",
    "ego_pose",
    "instance",
    "lidarseg",
    "log",
    "map",
    "sample",
    "sample_annotation",
    "sample_data",
    "scene",
    "sensor",
    "visibility",
];

type Table = BTreeMap<String, Value>;
type Tables = BTreeMap<&'static str, Table>;

fn read_tables(root: &Path) -> Tables {
    let present = |name: &&str| root.join(VERSION).join(format!("{name}.json")).exists();
    TABLES.into_iter().filter(present).map(|name| (name, read_table(root, name))).collect()
}

fn read_table(root: &Path, name: &str) -> Table {
    let text = std::fs::read(root.join(VERSION).join(format!("{name}.json"))).expect(name);
    let rows: Vec<Value> = serde_json::from_slice(&text).expect(name);
    let count = rows.len();
    let table: Table = rows.into_iter().map(|row| (text_of(&row["token"]), row)).collect();
    assert_eq!(table.len(), count, "{name}: a token stands twice");
    table
}

fn text_of(value: &Value) -> String {
    value.as_str().expect("a string").to_owned()
}

/// The table that a field's tokens point into.
fn target(table: &'static str, field: &str) -> Option<&'static str> {
    let stem = match field {
        "prev" | "next" => return Some(table),
        "first_sample_token" | "last_sample_token" => "sample",
        "first_annotation_token" | "last_annotation_token" => "sample_annotation",
        _ => field.strip_suffix("_tokens").or(field.strip_suffix("_token"))?,
    };
    Some(TABLES.into_iter().find(|name| *name == stem).expect("a known table"))
}

/// Asserts that all tokens of a log resolve, and returns how many there were.
fn assert_tokens_resolve(tables: &Tables) -> usize {
    let mut count = 0;
    for (&name, table) in tables {
        for (field, value) in table.values().flat_map(|row| row.as_object().expect("a row")) {
            let Some(target) = target(name, field) else { continue };
            for token in tokens_in(value) {
                assert!(tables[target].contains_key(token), "{name}.{field}: {token}");
                count += 1;
            }
        }
    }
    count
}

fn tokens_in(value: &Value) -> Vec<&str> {
    let texts = value.as_array().map_or(vec![value], |list| list.iter().collect());
    texts.into_iter().filter_map(Value::as_str).filter(|token| !token.is_empty()).collect()
}

/// Asserts that `next` and `prev` undo each other, in time's order, and returns the chains' number.
fn assert_chains_close(table: &Table, time: impl Fn(&Value) -> i64) -> usize {
    for (token, row) in table {
        if let Some(next) = table.get(&text_of(&row["next"])) {
            assert_eq!(&text_of(&next["prev"]), token);
            assert!(time(row) < time(next), "{row} before {next}");
        }
    }
    table.values().filter(|row| row["prev"] == "").count()
}

fn timestamp(row: &Value) -> i64 {
    row["timestamp"].as_i64().expect("a timestamp")
}

fn size_of(root: &Path, file: &Value) -> Option<u64> {
    std::fs::metadata(root.join(text_of(file))).ok().map(|meta| meta.len())
}

fn two_small_scenes() -> LogSpec {
    let mut spec = LogSpec::nano().with_scenes(2);
    spec.lead_in_sweeps = 2;
    spec
}

fn written(spec: &LogSpec) -> (tempfile::TempDir, Tables) {
    let directory = tempfile::tempdir().expect("a temporary directory");
    write_log(directory.path(), spec).expect("a log");
    let tables = read_tables(directory.path());
    (directory, tables)
}

#[test]
fn every_token_resolves() {
    let (_directory, tables) = written(&two_small_scenes());
    let count = assert_tokens_resolve(&tables);
    assert!(count > 500, "only {count} tokens");
}

#[test]
fn every_chain_closes() {
    let (_directory, tables) = written(&two_small_scenes());
    let sample_time = |row: &Value| timestamp(&tables["sample"][&text_of(&row["sample_token"])]);
    assert_eq!(assert_chains_close(&tables["sample"], timestamp), 2);
    assert_eq!(assert_chains_close(&tables["sample_data"], timestamp), 2 * 7);
    let tracks = tables["instance"].len();
    assert_eq!(assert_chains_close(&tables["sample_annotation"], sample_time), tracks);
}

#[test]
fn every_sweep_has_its_file_and_every_key_sweep_a_label_for_each_point() {
    let (directory, tables) = written(&two_small_scenes());
    let clouds = tables["sample_data"].values().filter(|row| row["fileformat"] == "pcd");
    let mut labelled = 0;
    for row in clouds {
        let bytes = size_of(directory.path(), &row["filename"]).expect("a cloud");
        let labels = tables["lidarseg"].get(&text_of(&row["token"]));
        assert_eq!(labels.is_some(), row["is_key_frame"] == true);
        if let Some(labels) = labels {
            let count = size_of(directory.path(), &labels["filename"]).expect("labels");
            assert_eq!(bytes, 20 * count);
            labelled += 1;
        }
    }
    assert_eq!(labelled, 6);
}

#[test]
fn movers_are_annotated_and_seen() {
    let (_directory, tables) = written(&LogSpec::nano());
    let points = |row: &Value| row["num_lidar_pts"].as_u64().expect("a count");
    let mut by_instance: BTreeMap<String, u64> = BTreeMap::new();
    for row in tables["sample_annotation"].values() {
        *by_instance.entry(text_of(&row["instance_token"])).or_default() += points(row);
    }
    let category = |instance: &str| {
        let token = text_of(&tables["instance"][instance]["category_token"]);
        text_of(&tables["category"][&token]["name"])
    };
    for wanted in ["vehicle.car", "human.pedestrian.adult", "movable_object.barrier"] {
        let seen: u64 =
            by_instance.iter().filter(|(i, _)| category(i) == wanted).map(|e| e.1).sum();
        assert!(seen >= 5, "{wanted}: {seen} points");
    }
}

#[test]
fn what_is_switched_off_is_not_there() {
    let bare = LogSpec { cameras: false, labels: false, boxes: false, ..LogSpec::nano() };
    let (directory, tables) = written(&bare);
    assert_tokens_resolve(&tables);
    assert!(!directory.path().join("lidarseg").exists() && !tables.contains_key("lidarseg"));
    assert!(tables["category"].values().all(|row| row.get("index").is_none()));
    assert_eq!((tables["sensor"].len(), tables["sample_data"].len()), (1, 9));
    assert_eq!((tables["instance"].len(), tables["sample_annotation"].len()), (0, 0));
}

#[test]
fn the_large_tables_hang_together_when_cut_down() {
    let spec = LogSpec { annotations: Some(10_001), ..LogSpec::tables().with_scenes(7) };
    let (directory, tables) = written(&spec);
    assert_tokens_resolve(&tables);
    assert_eq!(tables["sample_annotation"].len(), 10_001);
    assert_eq!(tables["sample"].len(), 7 * 40);
    assert_eq!(tables["sample_data"].len(), 7 * (391 + 6 * 40));
    assert_eq!(tables["ego_pose"].len(), tables["sample_data"].len());
    let clouds = tables["sample_data"].values().filter(|row| row["fileformat"] == "pcd");
    let files = clouds.filter(|row| size_of(directory.path(), &row["filename"]).is_some());
    assert_eq!(files.count(), 391);
}
