//! Runs that are ended before they are done.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use occlabel_testkit::LogSpec;

use crate::labelled::times;
use crate::support::{Ended, Label, TestLog, leftovers, nano_spec, tree_hash};

/// A log of 8 keyframes, to be labelled by one thread in the whole grid.
pub(crate) fn long_run() -> (TestLog, Label) {
    let log = TestLog::simulated(&LogSpec { keyframes: 8, ..nano_spec() });
    let label = Label::new(&log.root(), &log.beside("out")).with(&["--jobs", "1"]);
    (log, label)
}

/// Starts a run and waits until it has finished a keyframe, but not all.
pub(crate) fn started(command: &mut Command, label: &Label) -> Child {
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("started");
    let (journal, since) = (label.output.join("journal.jsonl"), Instant::now());
    while fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) == 0 {
        assert!(since.elapsed() < Duration::from_secs(60), "no keyframe was finished");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

pub(crate) fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(status.expect("kill").success());
}

/// Ends an interrupted run by the same command; the tree is that of an undisturbed run.
fn goes_on(log: &TestLog, label: &Label) {
    assert!(!label.output.join("manifest.json").exists() && label.output.join("run.json").exists());
    let before = times(&label.output.join("gts"));
    let kept: Vec<_> = before.iter().filter(|(name, _)| name.ends_with(".npz")).collect();
    assert!((1..8).contains(&kept.len()), "{} keyframes before", kept.len());
    label.run().exits(0);
    let after = times(&label.output.join("gts"));
    assert!(kept.into_iter().all(|(name, time)| after[name] == *time), "made again");
    let undisturbed = Label::new(&log.root(), &log.beside("undisturbed"));
    undisturbed.run().exits(0);
    assert_eq!(tree_hash(&label.output), tree_hash(&undisturbed.output));
    assert_eq!(leftovers(&label.output), [""; 0]);
}

#[test]
fn sigint_gives_130_and_the_same_command_goes_on() {
    let (log, label) = long_run();
    let child = started(&mut label.command(), &label);
    signal(&child, "-INT");
    let output = child.wait_with_output().expect("an end");
    Ended::of(output).exits(130).tells(&["the same command goes on"]);
    goes_on(&log, &label);
}

#[test]
fn fault_39_a_second_writer_is_refused_and_a_killed_run_goes_on() {
    let (log, label) = long_run();
    let child = started(&mut label.command(), &label);
    label.run().exits(1).tells(&[".lock", &child.id().to_string()]);
    signal(&child, "-KILL");
    assert_eq!(child.wait_with_output().expect("an end").status.code(), None);
    goes_on(&log, &label);
}
