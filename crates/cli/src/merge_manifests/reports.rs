//! The reports of shards as one: counts are summed, scenes and findings joined, the rest kept by shard.

use std::collections::BTreeSet;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_labels::{LabelTree, RunFiles, Shards, read_json, read_json_file};
use serde_json::{Value, json};

use crate::exit::Outcome;

/// What is kept of each shard's report as it is.
const OF_SHARD: [&str; 6] =
    ["outcome", "seconds", "cpu_seconds", "peak_memory_bytes", "threads", "host"];

/// `report.json` of a run in shards, as far as they were merged.
pub(super) struct MergedReport {
    report: Value,
    /// The shards it is of.
    shards: BTreeSet<String>,
    /// Those that have not ended.
    missing: BTreeSet<(usize, usize)>,
}

impl MergedReport {
    /// Of no shard.
    pub(super) fn empty() -> Self {
        let report = json!({
            "version": 1, "outcome": Outcome::Complete.name(), "scenes": {}, "total": {},
            "warnings": [], "skipped_or_degraded": [], "shards": [],
        });
        Self { report, shards: BTreeSet::new(), missing: BTreeSet::new() }
    }

    /// The report of an earlier merge; an empty one if it is gone.
    pub(super) fn load(path: &Path) -> Result<Self, Fault> {
        let Some(mut report) = read_json::<Value>(path)? else { return Ok(Self::empty()) };
        for key in ["warnings", "skipped_or_degraded", "shards"] {
            if !report[key].is_array() {
                report[key] = json!([]);
            }
        }
        let shards = report["shards"].as_array().into_iter().flatten();
        let names = shards.filter_map(|shard| Some(shard["shard"].as_str()?.to_owned()));
        let shards: BTreeSet<String> = names.collect();
        let missing = others(&shards);
        Ok(Self { shards, missing, report })
    }

    /// Shards that stand in the tree are no longer missing, and tell of those that are.
    pub(super) fn expect(&mut self, shards: &Shards) {
        let absent = shards.absent.iter().filter(|shard| !self.holds(shard));
        let absent: BTreeSet<_> = absent.filter_map(RunFiles::as_shard).collect();
        self.missing.extend(absent);
        for ended in shards.ended.iter().filter_map(|(files, _)| files.as_shard()) {
            self.missing.remove(&ended);
        }
    }

    /// Shards that have not ended.
    pub(super) fn missing(&self, tree: &LabelTree) -> Vec<RunFiles> {
        let files = |&(index, count): &_| RunFiles::shard(tree.clone(), index, count);
        self.missing.iter().map(files).collect()
    }

    /// Whether a shard was merged.
    pub(super) fn holds(&self, shard: &RunFiles) -> bool {
        shard.shard_name().is_some_and(|name| self.shards.contains(&name))
    }

    /// Merges a shard's, unless it was.
    pub(super) fn add(&mut self, shard: &RunFiles) -> Result<(), Fault> {
        if self.holds(shard) {
            return Ok(());
        }
        let report: Value = read_json_file(&shard.report())?;
        for key in ["scenes", "total"] {
            add(&mut self.report[key], &report[key]);
        }
        for key in ["warnings", "skipped_or_degraded"] {
            let findings = report[key].as_array().cloned().unwrap_or_default();
            self.extend(key, findings);
        }
        let kept = OF_SHARD.iter().map(|key| ((*key).to_owned(), report[*key].clone()));
        let mut kept = Value::Object(kept.collect());
        kept["shard"] = json!(shard.shard_name());
        self.extend("shards", [kept]);
        self.shards.extend(shard.shard_name());
        Ok(())
    }

    /// How the run ended: complete if all shards have, and did so.
    pub(super) fn outcome(&self) -> Outcome {
        let mut shards = self.report["shards"].as_array().into_iter().flatten();
        let is_complete = shards.all(|shard| shard["outcome"] == Outcome::Complete.name());
        if is_complete && self.missing.is_empty() { Outcome::Complete } else { Outcome::Degraded }
    }

    pub(super) fn json(&self) -> Value {
        let mut report = self.report.clone();
        report["outcome"] = json!(self.outcome().name());
        let name = |(index, count): &(usize, usize)| format!("{index}-of-{count}");
        report["missing_shards"] = self.missing.iter().map(name).collect();
        report
    }

    fn extend(&mut self, key: &str, more: impl IntoIterator<Item = Value>) {
        if let Some(list) = self.report[key].as_array_mut() {
            list.extend(more);
        }
    }
}

/// The shards that these leave out.
fn others(shards: &BTreeSet<String>) -> BTreeSet<(usize, usize)> {
    let parse = |name: &String| {
        let (index, count) = name.split_once("-of-")?;
        Some((index.parse().ok()?, count.parse().ok()?))
    };
    let known: BTreeSet<(usize, usize)> = shards.iter().filter_map(parse).collect();
    let count = known.first().map_or(0, |(_, count)| *count);
    (0..count).map(|index| (index, count)).filter(|shard| !known.contains(shard)).collect()
}

/// Adds numbers to numbers, key by key; peaks become the highest; what is there once stays as it is.
fn add(sum: &mut Value, more: &Value) {
    match (sum, more) {
        (Value::Object(sum), Value::Object(more)) => {
            for (key, value) in more {
                match sum.get_mut(key) {
                    Some(there) if key.starts_with("peak_") => raise(there, value),
                    Some(there) => add(there, value),
                    None => drop(sum.insert(key.clone(), value.clone())),
                }
            }
        }
        (sum, Value::Number(more)) if sum.is_u64() && more.is_u64() => {
            *sum = json!(sum.as_u64().unwrap_or(0) + more.as_u64().unwrap_or(0));
        }
        (sum, Value::Number(more)) if sum.is_number() => {
            *sum = json!(sum.as_f64().unwrap_or(0.0) + more.as_f64().unwrap_or(0.0));
        }
        _ => {}
    }
}

/// The higher of each number.
fn raise(peaks: &mut Value, others: &Value) {
    for (key, other) in others.as_object().into_iter().flatten() {
        if peaks[key].as_u64() < other.as_u64() {
            peaks[key] = other.clone();
        }
    }
}
