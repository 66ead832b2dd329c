//! A real process, ended by a signal at a moment that nobody chose.

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use occlabel_testkit::LogSpec;

use crate::line::Line;
use crate::support::{Ended, TestLog, files_under, nano_spec};
use crate::{is_all, promises};

/// Keyframes of the logs.
const SIZES: [usize; 3] = [2, 4, 9];

/// How the runs ended that were to be ended.
#[derive(Debug, Default)]
struct Tally {
    /// Before they were done.
    ended: usize,
    /// Of these, with labels or records on disk.
    amid_writing: usize,
}

/// Numbers in 0..1 that look random: splitmix64, Steele et al. 2014.
struct Moments(u64);

impl Iterator for Moments {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Some(((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// How long the line takes undisturbed.
fn duration(line: &Line, output: &Path) -> Duration {
    line.prepare(output);
    let since = Instant::now();
    line.run(output, None).exits(0);
    since.elapsed()
}

/// Ends so many runs by a signal, spread over their time and over logs of all sizes.
fn end_by(signal: &str, runs: usize, seed: u64) -> Tally {
    let mut tally = Tally::default();
    let mut moments = Moments(seed);
    for (at, size) in SIZES.into_iter().enumerate() {
        let log = TestLog::simulated(&LogSpec { keyframes: size, ..nano_spec() });
        let inputs = files_under(&log.root());
        let line = Line::label(&log, &["--evidence", "--jobs", "2"]);
        let output = log.beside("ended");
        let whole = duration(&line, &output);
        let of_size = runs / SIZES.len() + usize::from(at < runs % SIZES.len());
        for moment in moments.by_ref().take(of_size) {
            let after = whole.mul_f64(moment);
            end_one(&line, &output, signal, after, &mut tally);
        }
        assert!(files_under(&log.root()) == inputs, "inputs are never written");
    }
    println!("{runs} runs, {signal}: {tally:?}");
    tally
}

fn end_one(line: &Line, output: &Path, signal: &str, after: Duration, tally: &mut Tally) {
    let why = format!("{signal} after {after:?}");
    line.prepare(output);
    let mut command = line.command(output);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("started");
    std::thread::sleep(after);
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).status();
    let ended = child.wait_with_output().expect("an end");
    let by_signal = ended.status.signal();
    let ended = Ended::of(ended);
    let files = files_under(output);
    match (signal, ended.code) {
        (_, Some(0)) => line.is_as_undisturbed(output, &why),
        ("-KILL", None) => assert_eq!(by_signal, Some(9)),
        (_, Some(130)) => {}
        // Before the program listens it has written nothing.
        (_, None) => assert!(files.is_empty(), "{why}: {ended:?}"),
        _ => panic!("{why}: {ended:?}"),
    }
    tally.ended += usize::from(ended.code != Some(0));
    tally.amid_writing += usize::from(ended.code != Some(0) && !files.is_empty());
    promises::check(line, output, &why);
    line.ends_as_undisturbed(output, &why);
}

#[test]
fn fault_39_a_run_that_is_killed_at_any_moment_loses_nothing() {
    let runs = if is_all() { 100 } else { 8 };
    let tally = end_by("-KILL", runs, 39);
    assert!(tally.ended > runs / 2 && tally.amid_writing > runs / 4, "{tally:?}");
}

#[test]
fn a_run_that_is_asked_to_end_at_any_moment_gives_130_and_loses_nothing() {
    let runs = if is_all() { 25 } else { 3 };
    for (signal, seed) in [("-INT", 2), ("-TERM", 15)] {
        let tally = end_by(signal, runs, seed);
        assert!(tally.ended > runs / 4, "{tally:?}");
    }
}
