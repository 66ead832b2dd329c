//! Time and memory by stage.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

use occlabel_pipeline::Stage;

use crate::label::usage::Usage;

/// What a stage took.
#[derive(Clone, Copy, Debug, Default)]
struct StageCost {
    /// Summed over the keyframes that were worked on at once.
    wall: Duration,
    cpu: Option<Duration>,
    peak_memory_bytes: Option<u64>,
}

/// What each stage took.
#[derive(Clone, Debug, Default)]
pub(crate) struct StageCosts(BTreeMap<Stage, StageCost>);

/// Watches stages, any number at once. Processor time is that of the process, shared out evenly among
/// the stages that ran at the same time; memory counts for each of them.
#[derive(Debug)]
pub(crate) struct StageMeter(Mutex<Meter>);

#[derive(Debug)]
struct Meter {
    /// How many are in each stage.
    running: BTreeMap<Stage, u32>,
    since: Usage,
    costs: StageCosts,
}

/// One of those who work through stages, until it is dropped.
pub(crate) struct StageClock<'a> {
    meter: &'a StageMeter,
    stage: Option<Stage>,
}

impl StageMeter {
    pub(crate) fn new() -> Self {
        let (running, costs) = <_>::default();
        Self(Mutex::new(Meter { running, since: Usage::now(), costs }))
    }

    /// Somebody begins to work.
    pub(crate) fn clock(&self) -> StageClock<'_> {
        StageClock { meter: self, stage: None }
    }

    /// What the stages took until now.
    pub(crate) fn costs(&self) -> StageCosts {
        self.meter().costs.clone()
    }

    fn meter(&self) -> MutexGuard<'_, Meter> {
        self.0.lock().expect("nothing panics under the lock")
    }
}

impl StageClock<'_> {
    /// A stage begins, and the one before ends.
    pub(crate) fn enter(&mut self, stage: Stage) {
        self.change(Some(stage));
    }

    fn change(&mut self, to: Option<Stage>) {
        let mut meter = self.meter.meter();
        meter.charge(Usage::now());
        if let Some(running) = self.stage.and_then(|stage| meter.running.get_mut(&stage)) {
            *running -= 1;
        }
        if let Some(stage) = to {
            *meter.running.entry(stage).or_default() += 1;
        }
        self.stage = to;
    }
}

impl Drop for StageClock<'_> {
    fn drop(&mut self) {
        self.change(None);
    }
}

impl Meter {
    /// Charges what was taken since the last time to the stages that ran.
    fn charge(&mut self, now: Usage) {
        let since = std::mem::replace(&mut self.since, now);
        let all: u32 = self.running.values().sum();
        let cpu = now.cpu.zip(since.cpu).map(|(now, since)| now.saturating_sub(since));
        let peak = now.memory.zip(since.memory).map(|(now, since)| now.peak_since(&since));
        for (stage, running) in self.running.iter().filter(|(_, running)| **running > 0) {
            self.costs.0.entry(*stage).or_default().add(&StageCost {
                wall: (now.at - since.at) * *running,
                cpu: cpu.map(|cpu| cpu * *running / all),
                peak_memory_bytes: peak,
            });
        }
    }
}

impl StageCost {
    fn add(&mut self, other: &Self) {
        self.wall += other.wall;
        self.cpu = self.cpu.into_iter().chain(other.cpu).reduce(|a, b| a + b);
        self.peak_memory_bytes = self.peak_memory_bytes.max(other.peak_memory_bytes);
    }
}

impl StageCosts {
    pub(crate) fn add(&mut self, other: &Self) {
        for (stage, cost) in &other.0 {
            self.0.entry(*stage).or_default().add(cost);
        }
    }

    /// Seconds by stage.
    pub(crate) fn seconds(&self) -> BTreeMap<&'static str, f64> {
        self.each(|cost| Some(cost.wall.as_secs_f64()))
    }

    /// Seconds of processors by stage, where the system tells them.
    pub(crate) fn cpu_seconds(&self) -> BTreeMap<&'static str, f64> {
        self.each(|cost| cost.cpu.map(|cpu| cpu.as_secs_f64()))
    }

    /// The resident set by stage, where the system tells it.
    pub(crate) fn peak_memory_bytes(&self) -> BTreeMap<&'static str, u64> {
        self.each(|cost| cost.peak_memory_bytes)
    }

    fn each<T>(&self, figure: impl Fn(&StageCost) -> Option<T>) -> BTreeMap<&'static str, T> {
        self.0.iter().filter_map(|(stage, cost)| Some((name(*stage), figure(cost)?))).collect()
    }

    /// `aggregate 1.2 s, relabel 3.4 s, …` in the order of the stages.
    pub(crate) fn line(&self) -> String {
        let part = |(stage, cost): (&Stage, &StageCost)| {
            format!("{} {:.1} s", name(*stage), cost.wall.as_secs_f64())
        };
        self.0.iter().map(part).collect::<Vec<_>>().join(", ")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::label::usage::Memory;

    /// A look at so many seconds, processor seconds and bytes.
    fn look(start: &Usage, seconds: u64, cpu_s: u64, highest: u64) -> Usage {
        Usage {
            at: start.at + Duration::from_secs(seconds),
            cpu: Some(Duration::from_secs(cpu_s)),
            memory: Some(Memory { now: 1, highest }),
        }
    }

    #[test]
    fn stages_at_once_share_the_processors_and_each_has_the_memory() {
        let start = Usage::now();
        let since = look(&start, 0, 0, 5);
        let running = [(Stage::Raycast, 2), (Stage::Finish, 1), (Stage::Voxelize, 0)].into();
        let mut meter = Meter { running, since, costs: StageCosts::default() };
        meter.charge(look(&start, 10, 6, 7));
        meter.running = [(Stage::Raycast, 1)].into();
        meter.charge(look(&start, 11, 8, 7));
        assert_eq!(meter.costs.seconds(), [("finish", 10.0), ("raycast", 21.0)].into());
        assert_eq!(meter.costs.cpu_seconds(), [("finish", 2.0), ("raycast", 6.0)].into());
        assert_eq!(meter.costs.peak_memory_bytes(), [("finish", 7), ("raycast", 7)].into());
        meter.running.clear();
        meter.charge(look(&start, 20, 20, 9));
        assert_eq!(meter.costs.cpu_seconds()["raycast"], 6.0, "nobody was at work");
    }
}
