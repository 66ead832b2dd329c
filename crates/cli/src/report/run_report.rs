//! What `report.json` tells, or those of all shards.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::Fault;
use occlabel_disk as disk;
use occlabel_labels::read_bounded;
use occlabel_view::Remark;
use serde::Deserialize;
use serde_json::Value;

/// A report of more bytes is not read: that of a thousand scenes has about 200 MB.
const MAX_BYTES: u64 = 1 << 30;

/// One report, or several put together. Whatever is absent is empty.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct RunReport {
    pub(crate) outcome: Option<String>,
    /// Of the wall's clock; of shards, the longest.
    pub(crate) seconds: Option<f64>,
    pub(crate) peak_memory_bytes: Option<u64>,
    pub(crate) threads: Option<u64>,
    pub(crate) host: BTreeMap<String, String>,
    scenes: BTreeMap<String, SceneReport>,
    pub(crate) total: Totals,
    warnings: Vec<Finding>,
    skipped_or_degraded: Vec<Finding>,
    /// How many files were put together.
    #[serde(skip)]
    pub(crate) parts: usize,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct SceneReport {
    seconds_by_stage: BTreeMap<String, f64>,
}

/// The sums of a run.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Totals {
    pub(crate) points: u64,
    pub(crate) rays: u64,
    pub(crate) boxes_without_points: u64,
    dropped: BTreeMap<String, u64>,
    seconds_by_stage: BTreeMap<String, f64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct Finding {
    scene: String,
    rule: String,
    place: String,
    record: Option<Value>,
    expected: String,
    found: String,
    hint: Option<String>,
}

/// The reports of a folder, put together, and a note on each that is none, or on their absence.
///
/// # Errors
/// If the folder or one of them cannot be read.
pub(crate) fn read(folder: &Path) -> Result<(RunReport, Vec<String>), Fault> {
    let (mut whole, mut notes) = (RunReport::default(), Vec::new());
    for name in report_names(folder)? {
        let bytes = read_bounded(&folder.join(&name), MAX_BYTES)?;
        match serde_json::from_slice(&bytes) {
            Ok(report) => whole.add(report),
            Err(why) => notes.push(format!("{name} cannot be read: {why}.")),
        }
    }
    if whole.parts == 0 && notes.is_empty() {
        notes.push("There is no report.json: times, warnings and drops are not known.".to_owned());
    }
    Ok((whole, notes))
}

/// `report.json`, or those of shards, in order of their names.
fn report_names(folder: &Path) -> Result<Vec<String>, Fault> {
    let entries = disk::list(folder).map_err(|error| {
        let place = folder.display().to_string();
        Fault::new("read", place, "to read this folder", error.to_string())
    })?;
    let names = entries.into_iter().filter_map(|entry| entry.file_name().into_string().ok());
    let of_shard = |name: &str| {
        let shard = name.strip_prefix("report.").and_then(|rest| rest.strip_suffix(".json"));
        shard.is_some_and(|shard| shard.contains("-of-"))
    };
    let mut names: Vec<_> = names.filter(|name| name == "report.json" || of_shard(name)).collect();
    names.sort_unstable();
    Ok(names)
}

impl RunReport {
    fn add(&mut self, part: Self) {
        let longest = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
        self.outcome = worse(self.outcome.take(), part.outcome);
        self.seconds = longest(self.seconds, part.seconds);
        self.peak_memory_bytes = self.peak_memory_bytes.max(part.peak_memory_bytes);
        self.threads = self.threads.max(part.threads);
        self.host.extend(part.host);
        self.scenes.extend(part.scenes);
        self.total.add(part.total);
        self.warnings.extend(part.warnings);
        self.skipped_or_degraded.extend(part.skipped_or_degraded);
        self.parts += 1;
    }

    /// Seconds of all stages of a scene.
    pub(crate) fn seconds_of(&self, scene: &str) -> Option<f64> {
        let times = &self.scenes.get(scene)?.seconds_by_stage;
        (!times.is_empty()).then(|| times.values().sum())
    }

    /// Seconds by stage, the longest first.
    pub(crate) fn stages(&self) -> Vec<(String, f64)> {
        let mut stages: Vec<_> = self.total.seconds_by_stage.clone().into_iter().collect();
        stages.sort_by(|(a, a_s), (b, b_s)| b_s.total_cmp(a_s).then_with(|| a.cmp(b)));
        stages
    }

    /// Points dropped by reason, most first.
    pub(crate) fn drops(&self) -> Vec<(String, u64)> {
        let mut drops: Vec<_> = self.total.dropped.clone().into_iter().collect();
        drops.sort_by(|(a, many), (b, more)| more.cmp(many).then_with(|| a.cmp(b)));
        drops
    }

    /// All that was odd or lost.
    pub(crate) fn remarks(&self) -> Vec<Remark> {
        let losses = self.skipped_or_degraded.iter().map(|finding| finding.remark(true));
        losses.chain(self.warnings.iter().map(|finding| finding.remark(false))).collect()
    }
}

/// The outcome of both parts; only what is complete in both is.
fn worse(a: Option<String>, b: Option<String>) -> Option<String> {
    match (a, b) {
        (Some(a), Some(b)) if a == "complete" => Some(b),
        (a, b) => a.or(b),
    }
}

impl Totals {
    fn add(&mut self, part: Self) {
        self.points += part.points;
        self.rays += part.rays;
        self.boxes_without_points += part.boxes_without_points;
        for (reason, points) in part.dropped {
            *self.dropped.entry(reason).or_default() += points;
        }
        for (stage, seconds) in part.seconds_by_stage {
            *self.seconds_by_stage.entry(stage).or_default() += seconds;
        }
    }
}

impl Finding {
    fn remark(&self, is_loss: bool) -> Remark {
        let Self { place, expected, found, .. } = self;
        let record = match &self.record {
            Some(Value::String(record)) => format!(", {record}"),
            _ => String::new(),
        };
        let hint = self.hint.as_ref().map_or_else(String::new, |hint| format!("; {hint}"));
        let text = format!("{place}{record}: expected {expected}, found {found}{hint}");
        Remark { is_loss, rule: self.rule.clone(), scene: self.scene.clone(), text }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn write(folder: &Path, name: &str, text: &str) {
        fs::write(folder.join(name), text).unwrap();
    }

    #[test]
    fn shards_are_put_together_and_broken_ones_noted() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path();
        assert_eq!(read(place).unwrap().1.len(), 1, "none is a note");
        write(
            place,
            "report.0-of-3.json",
            r#"{"outcome": "complete", "seconds": 2.0,
            "total": {"points": 3, "dropped": {"far": 1}, "seconds_by_stage": {"raycast": 1.5}},
            "scenes": {"a": {"seconds_by_stage": {"raycast": 1.0, "vote": 0.5}, "labelled": {"k": []}}}}"#,
        );
        write(
            place,
            "report.1-of-3.json",
            r#"{"outcome": "degraded", "seconds": 5.0, "peak_memory_bytes": 7,
            "total": {"points": 4, "dropped": {"ego": 9}, "seconds_by_stage": {"finish": 2.5}},
            "skipped_or_degraded": [{"rule": "r", "place": "p", "expected": "e", "found": "f", "scene": "b"}]}"#,
        );
        write(place, "report.2-of-3.json", "{");
        write(place, "report.txt", "{");
        let (report, notes) = read(place).unwrap();
        assert_eq!((report.parts, report.seconds, report.total.points), (2, Some(5.0), 7));
        assert_eq!(
            (report.outcome.as_deref(), report.peak_memory_bytes),
            (Some("degraded"), Some(7))
        );
        assert_eq!(report.seconds_of("a"), Some(1.5));
        assert_eq!(report.drops(), [("ego".to_owned(), 9), ("far".to_owned(), 1)]);
        assert_eq!(report.stages()[0].0, "finish");
        assert_eq!(report.remarks()[0].text, "p: expected e, found f");
        assert!(notes.len() == 1 && notes[0].starts_with("report.2-of-3.json"), "{notes:?}");
    }
}
