//! Sweeps that are there twice, and rows in another order (cases 15 and 16).

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::asserts::{field, label, untouched, warnings};
use crate::support::{TestLog, gts_files, report};

/// Adds a sweep with the time and pose of another: its row again, with its own token and file.
fn add_sweep_beside(log: &TestLog, sweep: &Value) -> String {
    let file = field(sweep, "filename").replace(".pcd.bin", "_again.pcd.bin");
    fs::copy(log.file(&field(sweep, "filename")), log.file(&file)).expect("copied");
    let mut row = sweep.clone();
    row["token"] = json!("ffffffffffffffffffffffffffffffff");
    row["filename"] = json!(file);
    row["prev"] = json!("");
    row["next"] = json!("");
    log.edit("sample_data", |rows| rows.push(row));
    file
}

#[test]
fn fault_15_a_sweep_that_is_there_twice_counts_once() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    add_sweep_beside(&log, &log.sweeps()[2]);
    label(&log).run().exits(0).tells(&["warning", "ffffffff", "same bytes"]);
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

#[test]
fn fault_15_two_sweeps_of_one_time_both_count() {
    let log = TestLog::nano();
    let file = add_sweep_beside(&log, &log.sweeps()[2]);
    log.edit_points(&file, |points| points.truncate(points.len() / 2));
    let (label, points) = (label(&log), |output: &Path| report(output)["total"]["points"].as_u64());
    label.run().exits(0).tells(&["warning", "both are kept"]);
    assert_eq!(warnings(&label.output, "time-repeated").len(), 1);
    let (_log, clean) = untouched(&[]);
    assert!(points(&label.output) > points(&clean.output));
}

#[test]
fn fault_16_rows_in_any_order_give_the_same_bytes() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    for table in ["sample_data", "sample", "sample_annotation", "instance", "ego_pose", "lidarseg"]
    {
        log.edit(table, |rows| {
            let middle = rows.len() / 3;
            rows.reverse();
            rows.rotate_left(middle);
        });
    }
    label(&log).run().exits(0).tells_nothing_of("warning");
    assert!(gts_files(&log.beside("out")) == gts_files(&clean.output));
}

/// Chains rows of sample_data in this order.
fn chain(log: &TestLog, tokens: &[Value]) {
    log.edit("sample_data", |rows| {
        for row in rows {
            let Some(at) = tokens.iter().position(|token| *token == row["token"]) else { continue };
            let neighbour = |at: Option<usize>| at.and_then(|at| tokens.get(at)).cloned();
            row["prev"] = neighbour(at.checked_sub(1)).unwrap_or(json!(""));
            row["next"] = neighbour(Some(at + 1)).unwrap_or(json!(""));
        }
    });
}

#[test]
fn fault_16_a_chain_that_goes_back_in_time_is_warned_of_and_sorted() {
    let (_log, clean) = untouched(&[]);
    let log = TestLog::nano();
    let sweeps = log.sweeps();
    let late = sweeps[5].clone();
    chain(&log, &[0, 2, 3, 4, 5, 1, 6, 7, 8].map(|place: usize| sweeps[place]["token"].clone()));
    let label = label(&log);
    label.run().exits(0).tells(&["warning", &field(&late, "token"), "earlier by 0.5 s"]);
    assert_eq!(warnings(&label.output, "time-backwards").len(), 1);
    assert!(gts_files(&label.output) == gts_files(&clean.output));
}
