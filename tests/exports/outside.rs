//! Other people's programs, as `tests/outside/install` leaves them.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outside")
}

/// Runs a script of `tests/outside` in Python; `None`, with a printed reason, if that is not installed.
pub(crate) fn python(script: &str, args: &[&str]) -> Option<Value> {
    run(&folder().join("python/bin/python"), &folder().join("python"), script, args)
}

/// The same in Node.
pub(crate) fn node(script: &str, args: &[&str]) -> Option<Value> {
    run(Path::new("node"), &folder().join("node_modules/gltf-validator"), script, args)
}

fn run(program: &Path, needed: &Path, script: &str, args: &[&str]) -> Option<Value> {
    if !needed.exists() {
        let required = std::env::var("OCCLABEL_OUTSIDE").is_ok_and(|value| value == "required");
        assert!(!required, "{} is not there: tests/outside/install", needed.display());
        println!("skipped: {} is not there; tests/outside/install brings it", needed.display());
        return None;
    }
    let output = Command::new(program).arg(folder().join(script)).args(args).output();
    let output = output.expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script} {args:?}:\n{told}");
    Some(serde_json::from_slice(&output.stdout).expect("a line of JSON"))
}
