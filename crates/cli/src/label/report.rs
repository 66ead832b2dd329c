//! `report.json`: how a run went. Not part of the promise of the same bytes.

use std::collections::BTreeMap;
use std::time::Instant;

use occlabel_core::Fault;
use serde_json::{Value, json};

use crate::console::fault_json;
use crate::exit::Outcome;
use crate::label::findings::Findings;
use crate::label::scene_run::SceneDone;
use crate::label::tally::Tally;

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
        self.scenes.insert(name.to_owned(), done.tally.json());
        self.total.add(&done.tally);
    }

    pub(crate) fn total_line(&self) -> String {
        let scenes = self.scenes.len();
        self.total.line(&format!("{scenes} {}", if scenes == 1 { "scene" } else { "scenes" }))
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
            "warnings": faults_json(&findings.warnings),
            "skipped_or_degraded": faults_json(&findings.losses),
            "seconds": self.started.elapsed().as_secs_f64(),
            "peak_memory_bytes": peak_memory_bytes(),
            "threads": threads,
            "host": { "os": std::env::consts::OS, "arch": std::env::consts::ARCH },
        })
    }
}

fn faults_json(faults: &[(String, Fault)]) -> Vec<Value> {
    let with_scene = |(scene, fault): &(String, Fault)| {
        let mut value = fault_json(fault);
        value["scene"] = json!(scene);
        value
    };
    faults.iter().map(with_scene).collect()
}

/// The process's largest resident set, where the system tells it.
fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
