//! What a run found wrong, and what that makes of its outcome.

use std::collections::BTreeMap;

use occlabel_core::Fault;
use serde_json::{Value, json};

use crate::console::{Console, fault_json};
use crate::exit::Outcome;

/// Everything odd about the input, as the report lists it. Told when it is found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    /// Odd, but nothing is lost.
    pub(crate) warnings: Vec<Value>,
    /// Skipped or degraded: each makes the exit code 3.
    pub(crate) losses: Vec<Value>,
}

impl Findings {
    /// Something odd.
    pub(crate) fn warn(&mut self, console: &Console, scene: &str, fault: &Fault) {
        console.warning(scene, fault);
        self.warnings.push(finding(scene, fault));
    }

    /// Something skipped or degraded.
    pub(crate) fn lose(&mut self, console: &Console, scene: &str, fault: &Fault) {
        console.warning(scene, fault);
        self.remember(finding(scene, fault));
    }

    /// Something that was skipped or degraded when an earlier run labelled what this one keeps.
    pub(crate) fn remember(&mut self, loss: Value) {
        if !self.losses.contains(&loss) {
            self.losses.push(loss);
        }
    }

    /// What was lost of a scene.
    pub(crate) fn losses_of(&self, scene: &str) -> Vec<Value> {
        self.losses.iter().filter(|loss| loss["scene"] == scene).cloned().collect()
    }

    pub(crate) fn outcome(&self) -> Outcome {
        if self.losses.is_empty() { Outcome::Complete } else { Outcome::Degraded }
    }
}

/// How many of some findings there are of each rule.
pub(crate) fn by_rule(
    findings: &[Value],
    is_meant: impl Fn(&Value) -> bool,
) -> BTreeMap<&str, usize> {
    let mut counts = BTreeMap::new();
    for finding in findings.iter().filter(|finding| is_meant(finding)) {
        *counts.entry(finding["rule"].as_str().unwrap_or_default()).or_default() += 1;
    }
    counts
}

fn finding(scene: &str, fault: &Fault) -> Value {
    let mut finding = fault_json(fault);
    finding["scene"] = json!(scene);
    finding
}
