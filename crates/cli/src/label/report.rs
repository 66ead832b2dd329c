//! `report.json`: how a run went. Not part of the promise of the same bytes.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::read_bounded;
use serde_json::{Value, json};

use crate::exit::Outcome;
use crate::label::findings::Findings;
use crate::label::scene_run::{Finished, SceneDone};
use crate::label::tally::Tally;

/// Under this name a scene of the report holds its keyframes' summaries.
const LABELLED: &str = "labelled";
/// A report of more bytes is not read: that of a thousand scenes has about 200 MB.
const MAX_BYTES: u64 = 1 << 30;

/// Grows scene by scene.
pub(crate) struct Report {
    started: Instant,
    scenes: BTreeMap<String, Value>,
    total: Tally,
}

impl Report {
    pub(crate) fn new() -> Self {
        Self { started: Instant::now(), scenes: BTreeMap::new(), total: Tally::default() }
    }

    pub(crate) fn add(&mut self, name: &str, done: &SceneDone) {
        self.scenes.insert(name.to_owned(), scene_json(done));
        self.total.add(&done.tally);
    }

    pub(crate) fn total_line(&self) -> String {
        let scenes = self.scenes.len();
        self.total.line(&format!("{scenes} scenes"))
    }

    pub(crate) fn json(&self, outcome: Outcome, findings: &Findings, threads: usize) -> Value {
        json!({
            "version": 1,
            "outcome": match outcome {
                Outcome::Complete => "complete",
                Outcome::Degraded => "degraded",
                Outcome::Interrupted => "interrupted",
            },
            "scenes": self.scenes,
            "total": self.total.json(),
            "warnings": findings.warnings,
            "skipped_or_degraded": findings.losses,
            "seconds": self.started.elapsed().as_secs_f64(),
            "peak_memory_bytes": peak_memory_bytes(),
            "threads": threads,
            "host": { "os": std::env::consts::OS, "arch": std::env::consts::ARCH },
        })
    }
}

/// A scene's tally, with what is told of it one by one.
fn scene_json(done: &SceneDone) -> Value {
    let mut scene = done.tally.json();
    scene["boxes_without_points"] = json!(done.tally.boxes_without_points);
    scene["not_finite_by_sweep"] = json!(done.tally.not_finite);
    let labelled = done.entries.iter().map(|entry| (entry.keyframe.clone(), entry.summary.clone()));
    scene[LABELLED] = Value::Object(labelled.collect());
    scene
}

/// The report that an earlier run left.
pub(crate) struct EarlierReport(Value);

impl EarlierReport {
    /// Reads it; one that is not there or broken tells nothing.
    ///
    /// # Errors
    /// If it is there but cannot be read.
    pub(crate) fn load(path: &Path) -> Result<Self, Fault> {
        let text = if disk::exists(path) { read_bounded(path, MAX_BYTES)? } else { Vec::new() };
        Ok(Self(serde_json::from_slice(&text).unwrap_or_default()))
    }

    /// Gives the keyframes that only an earlier manifest knows of what this report tells of them.
    pub(crate) fn recall(&self, finished: &mut Finished) {
        for ((scene, token), entry) in finished.iter_mut() {
            if entry.summary.is_null() {
                entry.summary = self.0["scenes"][scene.as_str()][LABELLED][token.as_str()].clone();
            }
        }
    }
}

/// The process's largest resident set, where the system tells it.
fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
