//! A labelled log, and what the tests look at in its tree.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

use serde_json::Value;

use crate::support::{Label, SCENE, TestLog, files_under};

/// A labelled copy of the committed log.
pub(crate) fn labelled(args: &[&str]) -> (TestLog, Label) {
    let log = TestLog::nano();
    let label = Label::new(&log.root(), &log.beside("out")).small().with(args);
    label.run().exits(0);
    (log, label)
}

/// When each file below a folder was last written.
pub(crate) fn times(root: &Path) -> BTreeMap<String, SystemTime> {
    let time = |name: &String| fs::metadata(root.join(name)).and_then(|meta| meta.modified());
    files_under(root).into_keys().map(|name| (name.clone(), time(&name).expect("a time"))).collect()
}

pub(crate) fn labels_path(token: &str) -> String {
    format!("gts/{SCENE}/{token}/labels.npz")
}

pub(crate) fn strings(value: &Value) -> Vec<String> {
    let list = value.as_array().expect("a list");
    list.iter().map(|item| item.as_str().expect("a string").to_owned()).collect()
}
