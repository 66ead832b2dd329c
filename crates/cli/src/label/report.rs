//! `report.json`: how a run went. Not part of the promise of the same bytes.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::read_bounded;
use serde_json::{Value, json};

use crate::exit::Outcome;
use crate::label::findings::{Findings, by_rule};
use crate::label::scene_run::{Finished, SceneDone};
use crate::label::tally::Tally;
use crate::label::usage::Usage;

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
        let Usage { cpu, memory, .. } = Usage::now();
        json!({
            "version": 1,
            "outcome": outcome.name(),
            "scenes": self.scenes_json(findings),
            "total": with_rules(self.total.json(), findings, |_| true),
            "warnings": findings.warnings,
            "skipped_or_degraded": findings.losses,
            "seconds": self.started.elapsed().as_secs_f64(),
            "cpu_seconds": cpu.map(|cpu| cpu.as_secs_f64()),
            "peak_memory_bytes": memory.map(|memory| memory.highest),
            "threads": threads,
            "host": { "os": std::env::consts::OS, "arch": std::env::consts::ARCH },
        })
    }

    fn scenes_json(&self, findings: &Findings) -> Value {
        let scene = |(name, scene): (&String, &Value)| {
            (
                name.clone(),
                with_rules(scene.clone(), findings, |finding| finding["scene"] == **name),
            )
        };
        Value::Object(self.scenes.iter().map(scene).collect())
    }
}

/// The counts with those of findings by rule.
fn with_rules(mut counts: Value, findings: &Findings, is_of: impl Fn(&Value) -> bool) -> Value {
    counts["warnings_by_rule"] = json!(by_rule(&findings.warnings, &is_of));
    counts["skipped_or_degraded_by_rule"] = json!(by_rule(&findings.losses, &is_of));
    counts
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
