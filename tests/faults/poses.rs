//! Rotations that are none (case 12), and places far beyond (case 19).

use serde_json::{Value, json};

use crate::asserts::{
    assert_refused, assert_skipped, field, keyframes_without, label, label_into, untouched,
};
use crate::support::{NAN, TestLog, gts_files};

/// Scales the rotation of the ego pose of a sweep.
fn scale_rotation(log: &TestLog, sweep: &Value, norm: f64) {
    log.edit("ego_pose", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == sweep["ego_pose_token"]);
        row.expect("a pose")["rotation"] = json!([norm, 0.0, 0.0, 0.0]);
    });
}

#[test]
fn fault_12_a_norm_off_by_rounding_is_mended_silently() {
    let log = TestLog::nano();
    scale_rotation(&log, &log.sweeps()[4], 1.0 + 5e-7);
    label(&log).run().exits(0).tells_nothing_of("warning");
    let (_log, clean) = untouched(&[]);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_12_a_norm_off_by_half_a_percent_is_mended_with_a_warning() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    scale_rotation(&log, sweep, 1.005);
    let pose = field(sweep, "ego_pose_token");
    label(&log).run().exits(0).tells(&["warning", "ego_pose.json", &pose, "norm 1.005"]);
    let (_log, clean) = untouched(&[]);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_12_a_norm_that_tells_no_rotation_is_refused() {
    for (norm, told) in [(1.5, "norm 1.5"), (0.0, "norm 0"), (1.011, "norm 1.011")] {
        let log = TestLog::nano();
        let sweep = &log.sweeps()[2];
        scale_rotation(&log, sweep, norm);
        let pose = field(sweep, "ego_pose_token");
        assert_refused(&label(&log), &["ego_pose.json", &pose, "norm 1", told]);
        assert_skipped(&label_into(&log, "skip"), "quaternion-norm", &log.keyframes());
    }
}

#[test]
fn fault_12_a_nan_in_a_pose_is_refused() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[2];
    log.edit("ego_pose", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == sweep["ego_pose_token"]);
        row.expect("a pose")["rotation"] = json!([1.0, NAN, 0.0, 0.0]);
    });
    assert_refused(&label(&log), &["ego_pose.json", "norm NaN"]);
    assert_skipped(&label_into(&log, "skip"), "quaternion-norm", &log.keyframes());
}

#[test]
fn fault_19_a_pose_beyond_a_thousand_million_metres_is_refused() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    log.edit("ego_pose", |rows| {
        let row = rows.iter_mut().find(|row| row["token"] == sweep["ego_pose_token"]);
        row.expect("a pose")["translation"] = json!([1e300, 0.0, 0.0]);
    });
    assert_refused(&label(&log), &["ego_pose.json", "at most 1e9 m", "1e300"]);
    let keyframes = keyframes_without(&log, 1);
    assert_skipped(&label_into(&log, "skip"), "translation", &keyframes);
}

#[test]
fn fault_12_a_refused_pose_of_a_key_sweep_takes_the_keyframe_along() {
    let log = TestLog::nano();
    let sweep = &log.sweeps()[4];
    assert_eq!(sweep["is_key_frame"], true);
    scale_rotation(&log, sweep, 1.5);
    assert_refused(&label(&log), &["ego_pose.json", "norm 1.5"]);
    let ended =
        assert_skipped(&label_into(&log, "skip"), "keyframe-sweep", &keyframes_without(&log, 1));
    ended.tells(&[&log.keyframes()[1]]);
}
