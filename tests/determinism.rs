//! The same input, configuration and version give the same bytes (labels.md section 12).

mod support;

use std::fs;
use std::path::Path;

use support::{Label, TestLog, gts_files, leftovers, tree_hash};

/// A grid of 80 x 80 x 16 voxels, and pixel rays few enough for a test.
const GRID: [&str; 6] = [
    "--set",
    "grid.min_m=[-16.0, -16.0, -1.0]",
    "--set",
    "grid.max_m=[16.0, 16.0, 5.4]",
    "--set",
    "occlusion.pixel_stride=8",
];

/// Enough for one keyframe at a time, not for many.
const LITTLE_MEMORY: [&str; 2] = ["--memory", "26MB"];

/// The tree's hash for each number of threads, with and without a bound on memory.
fn hashes(log: &TestLog, preset: &str) -> Vec<String> {
    let mut hashes = Vec::new();
    for memory in [&[][..], &LITTLE_MEMORY[..]] {
        for jobs in ["1", "2", "8"] {
            let output = log.beside(&format!("{preset}-{jobs}-{}", memory.len()));
            let label = Label::new(&log.root(), &output).with(&GRID).with(memory);
            label.with(&["--preset", preset, "--jobs", jobs, "--evidence"]).run().exits(0);
            assert_eq!(leftovers(&output), [""; 0]);
            hashes.push(tree_hash(&output));
        }
    }
    hashes
}

#[test]
fn section_12_threads_and_memory_change_no_byte() {
    let log = TestLog::nano();
    for preset in ["precise", "occ3d-nuscenes"] {
        let hashes = hashes(&log, preset);
        assert_eq!(hashes.len(), 6);
        assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{preset}: {hashes:?}");
    }
}

#[test]
fn section_12_where_the_log_and_the_tree_stand_changes_no_byte() {
    let (here, there) = (TestLog::nano(), TestLog::nano());
    let trees = [here.beside("a"), there.beside("another/folder/b")];
    for (log, tree) in [&here, &there].into_iter().zip(&trees) {
        Label::new(&log.root(), tree).small().run().exits(0);
    }
    assert_eq!(tree_hash(&trees[0]), tree_hash(&trees[1]));
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
    let found = label_hashes(&label.output);
    let golden =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/cli_nano_precise.blake3");
    if std::env::var_os("UPDATE_GOLDENS").is_some() {
        fs::write(&golden, &found).expect("written");
    }
    let expected = fs::read_to_string(&golden).unwrap_or_default();
    assert_eq!(found, expected, "a voxel moved: say why, then UPDATE_GOLDENS=1 cargo test");
}
