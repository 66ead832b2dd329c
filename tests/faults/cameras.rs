//! Cameras that are absent (case 29).

use occlabel_testkit::LogSpec;
use serde_json::{Value, json};

use crate::asserts::{arrays, field, label, warnings};
use crate::support::{Arrays, SCENE, TestLog, manifest, nano_spec};

/// How many voxels the camera of a bit sees at each keyframe.
fn seen_by(arrays: &[Arrays], bit: u16) -> Vec<usize> {
    let count = |arrays: &Arrays| {
        let bits = arrays.evidence.camera_bits.values();
        bits.iter().filter(|bits| **bits >> bit & 1 == 1).count()
    };
    arrays.iter().map(count).collect()
}

#[test]
fn fault_29_no_camera_sees_nothing_and_all_is_written() {
    let log = TestLog::simulated(&LogSpec { cameras: false, ..nano_spec() });
    let label = label(&log);
    label.run().exits(0).tells(&["warning", "images of a camera", "none"]);
    assert_eq!(warnings(&label.output, "camera-absent").len(), 1);
    assert_eq!(manifest(&label.output)["scenes"][SCENE]["cameras"], json!([]));
    for arrays in arrays(&log, &label) {
        assert!(arrays.labels.mask_camera.values().iter().all(|seen| *seen == 0));
        assert!(arrays.labels.mask_lidar.values().contains(&1));
    }
}

#[test]
fn fault_29_a_camera_missing_at_a_keyframe_has_bit_0_there() {
    let log = TestLog::nano();
    let middle = log.keyframes()[1].clone();
    let is_missing = |row: &Value| {
        field(row, "filename").contains("/CAM_BACK/") && row["sample_token"] == middle.as_str()
    };
    log.edit("sample_data", |rows| rows.retain(|row| !is_missing(row)));
    let label = label(&log);
    label.run().exits(0).tells(&["warning", "CAM_BACK", &middle]);
    assert_eq!(warnings(&label.output, "camera-absent").len(), 1);
    let cameras = manifest(&label.output)["scenes"][SCENE]["cameras"].clone();
    assert_eq!((&cameras[0], &cameras[3]), (&json!("CAM_BACK"), &json!("CAM_FRONT")));
    let arrays = arrays(&log, &label);
    let (back, front) = (seen_by(&arrays, 0), seen_by(&arrays, 3));
    assert!(back[0] > 0 && back[1] == 0 && back[2] > 0, "{back:?}");
    assert!(front.iter().all(|seen| *seen > 0), "{front:?}");
}
