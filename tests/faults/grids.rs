//! Grids that cannot be (case 32).

use std::fs;

use crate::support::{Label, TestLog, VERSION};

#[test]
fn fault_32_an_impossible_voxel_is_refused_before_any_data() {
    let log = TestLog::nano();
    log.key_files().iter().chain(&log.other_files()).for_each(|file| log.truncate(file, 3));
    fs::write(log.file(&format!("{VERSION}/sample_data.json")), "[{").expect("written");
    let label = Label::new(&log.root(), &log.beside("out"));
    for size in ["0", "-0.4", "nan", "inf", "0.3", "1e-6", "1e6", "[0.4, 0.4, 0.0]"] {
        let setting = format!("grid.voxel_size_m={size}");
        label.clone().with(&["--set", &setting]).run().exits(2).tells(&["[grid]", "expected"]);
    }
    assert!(!label.output.exists());
}

#[test]
fn fault_32_too_many_voxels_are_told_with_their_bytes() {
    let log = TestLog::nano();
    let label =
        Label::new(&log.root(), &log.beside("out")).with(&["--set", "grid.voxel_size_m=1e-5"]);
    label.run().exits(2).tells(&["8000000 x 8000000 x 640000", "bytes"]);
}
