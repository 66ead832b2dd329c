//! Other people's programs, as `tests/outside/install` leaves them.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::support::text;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outside")
}

/// Runs a script of `tests/outside` in Python, and gives the JSON that it prints; `None`, with a printed
/// reason, if that is not installed.
pub(crate) fn python(script: &str, args: &[&str]) -> Option<Value> {
    let python = folder().join("python/bin/python");
    let printed = run(&python, std::slice::from_ref(&python), script, args)?;
    Some(serde_json::from_str(&printed).expect("a line of JSON"))
}

/// The same in Node.
pub(crate) fn node(script: &str, args: &[&str]) -> Option<Value> {
    let needed = folder().join("node_modules/gltf-validator");
    let printed = run(Path::new("node"), &[needed], script, args)?;
    Some(serde_json::from_str(&printed).expect("a line of JSON"))
}

/// The same in Node, with a browser; gives what the script prints.
pub(crate) fn browser(script: &str, files: &[&Path]) -> Option<String> {
    let needed = [folder().join("node_modules/playwright-core"), "/usr/bin/chromium".into()];
    let files: Vec<&str> = files.iter().map(|file| text(file)).collect();
    run(Path::new("node"), &needed, script, &files)
}

fn run(program: &Path, needed: &[PathBuf], script: &str, args: &[&str]) -> Option<String> {
    if let Some(absent) = needed.iter().find(|path| !path.exists()) {
        let required = std::env::var("OCCLABEL_OUTSIDE").is_ok_and(|value| value == "required");
        assert!(!required, "{} is not there: tests/outside/install", absent.display());
        println!("skipped: {} is not there; tests/outside/install brings it", absent.display());
        return None;
    }
    let output = Command::new(program).arg(folder().join(script)).args(args).output();
    let output = output.expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script} {args:?}:\n{told}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}
