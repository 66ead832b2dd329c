//! A run of `occlabel label` in a process of its own, so that its peak of memory is its own.

use std::path::Path;
use std::process::{Command, ExitCode};

use serde::{Deserialize, Serialize};

use crate::args::Args;
use crate::clock::{Cost, cost_of};

/// What a run took.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct RunCost {
    cpu_s: f64,
    wall_s: f64,
    /// The largest resident set.
    pub(crate) peak_bytes: u64,
}

impl RunCost {
    pub(crate) fn cost(&self) -> Cost {
        Cost { cpu_s: self.cpu_s, wall_s: self.wall_s }
    }
}

/// Labels a log with a preset on so many threads; the labels are thrown away.
pub(crate) fn label(log: &Path, preset: &str, threads: usize) -> RunCost {
    let labels = tempfile::tempdir().expect("a folder for labels");
    let program = std::env::current_exe().expect("our own path");
    let ran = Command::new(program)
        .arg("label")
        .args([log, labels.path()])
        .args([preset, &threads.to_string()])
        .output()
        .expect("our own program");
    let text = String::from_utf8_lossy(&ran.stdout);
    let line = text.lines().last().unwrap_or_default();
    serde_json::from_str(line)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&ran.stderr)))
}

/// The run itself: `label LOG LABELS PRESET THREADS`.
pub(crate) fn once(args: &Args) {
    let [log, labels, preset, threads] = args.rest.as_slice() else { panic!("four words") };
    let line = ["occlabel", "label", "--quiet", "--format", "nuscenes", "--preset", preset];
    let rest = ["--input", log, "--output", labels, "--jobs", threads];
    let cost = cost_of(|| {
        let ended = occlabel_cli::run([&line[..], &rest].concat());
        assert!(ended == ExitCode::SUCCESS, "the log was not labelled");
    });
    let run = RunCost { cpu_s: cost.cpu_s, wall_s: cost.wall_s, peak_bytes: peak_bytes() };
    println!("{}", serde_json::to_string(&run).expect("numbers"));
}

/// As Linux tells it; 0 elsewhere.
fn peak_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.trim().trim_end_matches(" kB").trim().parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}
