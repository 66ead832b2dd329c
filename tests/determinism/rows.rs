//! Where a log stands, and the order of its rows.

use serde_json::Value;

use crate::support::{Label, TestLog, gts_files, manifest, nano_spec, tree_hash};

#[test]
fn section_12_where_the_log_and_the_tree_stand_changes_no_byte() {
    let (here, there) = (TestLog::nano(), TestLog::nano());
    let trees = [here.beside("a"), there.beside("another/folder/b")];
    for (log, tree) in [&here, &there].into_iter().zip(&trees) {
        Label::new(&log.root(), tree).small().run().exits(0);
    }
    assert_eq!(tree_hash(&trees[0]), tree_hash(&trees[1]));
}

const TABLES: [&str; 10] = [
    "calibrated_sensor",
    "category",
    "ego_pose",
    "instance",
    "lidarseg",
    "sample",
    "sample_annotation",
    "sample_data",
    "scene",
    "sensor",
];

/// The manifest without the hashes of the tables.
fn told(label: &Label) -> Value {
    let mut manifest = manifest(&label.output);
    let fields = manifest.as_object_mut().expect("an object");
    for hash in ["input_hashes", "inputs_hash"] {
        fields.remove(hash).expect("a hash of the input");
    }
    manifest
}

/// The tables are other input, and their hashes say so; nothing else differs.
#[test]
fn section_12_rows_in_another_order_change_the_hash_of_the_input_alone() {
    let log = TestLog::simulated(&nano_spec().with_scenes(3));
    let label = |name: &str| Label::new(&log.root(), &log.beside(name)).small();
    let (sorted, shuffled) = (label("sorted"), label("shuffled"));
    sorted.run().exits(0);
    for table in TABLES {
        log.edit(table, |rows| {
            let middle = rows.len() / 3;
            rows.reverse();
            rows.rotate_left(middle);
        });
    }
    shuffled.run().exits(0);
    assert!(gts_files(&sorted.output) == gts_files(&shuffled.output));
    assert_eq!(told(&sorted), told(&shuffled));
    assert_ne!(manifest(&sorted.output)["inputs_hash"], manifest(&shuffled.output)["inputs_hash"]);
}
