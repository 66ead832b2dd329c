//! Operations of a line that fail on purpose, one a run.

use std::path::Path;

use crate::line::Line;
use crate::support::{Ended, TestLog, files_under};
use crate::{is_all, promises};

/// The ways in which an operation fails.
const WAYS: [&str; 5] = ["enospc", "eio", "eacces", "short", "kill"];
/// No line takes more operations than this.
pub(crate) const MOST: usize = 20_000;
/// What the program says when it has an operation fail.
pub(crate) const TOLD: &str = "on purpose";

/// Has every operation of a line fail in every way, or every `stride`-th where not all are tried; gives
/// how many failed.
pub(crate) fn fail(line: &Line, log: &TestLog, stride: usize) -> usize {
    let inputs = files_under(&log.root());
    let failed = WAYS.map(|way| fail_by(line, &log.beside("failing"), way, stride));
    assert!(files_under(&log.root()) == inputs, "inputs are never written");
    println!("{failed:?} failures of {WAYS:?}");
    failed.iter().sum()
}

pub(crate) fn fail_by(line: &Line, output: &Path, way: &str, stride: usize) -> usize {
    let stride = if is_all() { 1 } else { stride };
    for at in (0..MOST).step_by(stride) {
        line.prepare(output);
        let fault = format!("{at}:{way}");
        let ended = line.run(output, Some(&fault));
        if !ended.stderr.contains(TOLD) {
            assert_eq!(ended.code, Some(line.code), "{ended:?}");
            return at / stride;
        }
        is_told(line, output, &fault, &ended);
        // Who ends with 3 has told what it did without.
        if ended.code != Some(3) {
            promises::check(line, output, &fault);
        }
        line.ends_as_undisturbed(output, &fault);
    }
    panic!("more than {MOST} operations");
}

/// Who was not killed says what failed, or has done all of it. (One who says anyway what is wrong with
/// files, as `verify` does, may say more.)
pub(crate) fn is_told(line: &Line, output: &Path, fault: &str, ended: &Ended) {
    let is_error = |line: &str| line.starts_with("error: ");
    match ended.code {
        None => assert!(fault.ends_with("kill"), "{fault}: {ended:?}"),
        Some(0) if line.code == 0 => line.is_as_undisturbed(output, fault),
        Some(1) if line.code == 1 => {}
        Some(1 | 2) => assert!(ended.stderr.lines().any(is_error), "{fault}: {ended:?}"),
        Some(3) => assert!(ended.stderr.contains("cannot be read"), "{fault}: {ended:?}"),
        _ => panic!("{fault}: {ended:?}"),
    }
}
