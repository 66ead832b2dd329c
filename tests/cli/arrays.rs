//! The arrays that are written.

use serde_json::json;

use crate::labelled::{labelled, labels_path};
use crate::support::{Label, SCENE, files_under, gts_files, manifest, npz_dates, read_arrays};

/// 1980-01-01 as DOS has it: years since 1980, month, day.
const DOS_EPOCH: u16 = (1 << 5) | 1;

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
