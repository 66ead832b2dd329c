//! Time by stage.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use occlabel_pipeline::Stage;

/// Time spent in each stage, summed over threads.
#[derive(Clone, Debug, Default)]
pub(crate) struct StageTimes(BTreeMap<Stage, Duration>);

/// Runs while one thread works through stages.
pub(crate) struct StageClock {
    times: StageTimes,
    since: Option<(Stage, Instant)>,
}

impl StageClock {
    pub(crate) fn start() -> Self {
        Self { times: StageTimes::default(), since: None }
    }

    /// A stage begins, and the one before ends.
    pub(crate) fn enter(&mut self, stage: Stage) {
        self.leave();
        self.since = Some((stage, Instant::now()));
    }

    fn leave(&mut self) {
        if let Some((stage, since)) = self.since.take() {
            *self.times.0.entry(stage).or_default() += since.elapsed();
        }
    }

    pub(crate) fn stop(mut self) -> StageTimes {
        self.leave();
        self.times
    }
}

impl StageTimes {
    pub(crate) fn add(&mut self, other: &Self) {
        for (stage, time) in &other.0 {
            *self.0.entry(*stage).or_default() += *time;
        }
    }

    /// Seconds by stage, for the report.
    pub(crate) fn seconds(&self) -> BTreeMap<String, f64> {
        self.0.iter().map(|(stage, time)| (name(*stage).to_owned(), time.as_secs_f64())).collect()
    }

    /// `aggregate 1.2 s, relabel 3.4 s, …` in the order of the stages.
    pub(crate) fn line(&self) -> String {
        let parts: Vec<String> = (self.0.iter())
            .map(|(stage, time)| format!("{} {:.1} s", name(*stage), time.as_secs_f64()))
            .collect();
        parts.join(", ")
    }
}

fn name(stage: Stage) -> &'static str {
    match stage {
        Stage::Aggregate => "aggregate",
        Stage::Relabel => "relabel",
        Stage::Voxelize => "voxelize",
        Stage::Raycast => "raycast",
        Stage::Occlusion => "occlusion",
        Stage::Finish => "finish",
    }
}
