//! Hashes that every build on every machine has to meet: they stand in the repository.

use std::fs;
use std::path::{Path, PathBuf};

use crate::case::Case;
use crate::support::{Label, TestLog, gts_files, tree_hash};

#[track_caller]
fn assert_golden(name: &str, found: &str) {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let golden: PathBuf = fixtures.join(format!("{name}.blake3"));
    if std::env::var_os("UPDATE_GOLDENS").is_some() {
        fs::write(&golden, found).expect("written");
    }
    let expected = fs::read_to_string(&golden).unwrap_or_default();
    assert_eq!(found, expected, "{name}: say why it moved, then UPDATE_GOLDENS=1 cargo test");
}

/// One line a keyframe: BLAKE3 and path.
fn label_hashes(output: &Path) -> String {
    let files = gts_files(output).into_iter();
    files.map(|(name, bytes)| format!("{}  gts/{name}\n", blake3::hash(&bytes))).collect()
}

#[test]
fn section_12_the_committed_log_gives_the_committed_labels() {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).with(&["--preset", "precise"]);
    label.run().exits(0);
    assert_golden("cli_nano_precise", &label_hashes(&label.output));
}

/// Of a simulated drive: the hash of the log as it was written, and that of its label tree.
#[track_caller]
fn assert_drive(format: &str, preset: &str, taxonomy: &str) {
    let case = Case::drive(format, preset, taxonomy);
    let (log, labels) = (tree_hash(&case.log()), case.hash(&[]));
    assert_golden(&format!("tree_{format}"), &format!("{log}  log\n{labels}  labels\n"));
}

#[test]
fn section_12_every_machine_writes_the_same_nuscenes_log_and_its_labels() {
    assert_drive("nuscenes", "precise", "occ3d-nuscenes");
}

#[test]
fn section_12_every_machine_writes_the_same_mcap_log_and_its_labels() {
    assert_drive("mcap", "panommocc", "occ3d-nuscenes");
}

#[test]
fn section_12_every_machine_writes_the_same_waymo_log_and_its_labels() {
    assert_drive("waymo", "occ3d-waymo", "occ3d-waymo");
}

#[cfg(feature = "waymo-v2")]
#[test]
fn section_12_every_machine_writes_the_same_waymo_v2_log_and_its_labels() {
    assert_drive("waymo-v2", "occ3d-waymo", "occ3d-waymo");
}

#[test]
fn section_12_every_machine_writes_the_same_semantickitti_log_and_its_labels() {
    assert_drive("semantickitti", "mobileocc", "semantickitti");
}
