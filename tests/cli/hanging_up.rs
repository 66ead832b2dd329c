//! Signals, and readers that go away.

use std::io::pipe;
use std::process::{Command, Stdio};

use crate::interrupted::{long_run, signal, started};
use crate::labelled::labelled;
use crate::support::{Ended, text};

/// The program with the arguments of a line.
fn command(line: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_occlabel"));
    command.args(line).stdin(Stdio::null());
    command
}

#[test]
fn sigterm_gives_130_and_what_nohup_ignores_stays_ignored() {
    let (_log, label) = long_run();
    let program = label.command();
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$@\"", "sh"]).arg(program.get_program());
    let child = started(shell.args(program.get_args()), &label);
    // Were the first one heard, the second would end the run at once and say nothing.
    signal(&child, "-HUP");
    signal(&child, "-TERM");
    let ended = Ended::of(child.wait_with_output().expect("an end")).exits(130);
    ended.tells(&["the same command goes on"]);
    assert!(!label.output.join("manifest.json").exists());
}

#[test]
fn a_second_signal_ends_at_once_and_the_same_command_goes_on() {
    let (_log, label) = long_run();
    let child = started(&mut label.command(), &label);
    // Both are there when it wakes up.
    ["-STOP", "-INT", "-TERM", "-CONT"].iter().for_each(|name| signal(&child, name));
    let ended = Ended::of(child.wait_with_output().expect("an end")).exits(130);
    ended.tells_nothing_of("goes on");
    label.run().exits(0);
}

#[test]
fn an_interrupted_log_is_no_log_and_the_same_command_makes_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("log");
    let line = ["simulate", "--world", "street", "--format", "nuscenes", "--output", text(&output)];
    let mut child = command(&line).stdout(Stdio::null()).spawn().expect("started");
    while !output.join(".part").exists() && child.try_wait().expect("a state").is_none() {
        std::thread::yield_now();
    }
    signal(&child, "-INT");
    if child.wait().expect("an end").success() {
        return eprintln!("skipped: the log was whole before the signal came");
    }
    assert!(!output.join("v1.0-sim").exists());
    command(&line).output().expect("an end");
    assert!(output.join("v1.0-sim").is_dir() && !output.join(".part").exists());
}

#[test]
fn nobody_reading_is_no_fault_of_any_command() {
    let (log, label) = labelled(&[]);
    let (labels, root) = (text(&label.output), log.root());
    let log_flags = ["--format", "nuscenes", "--input", text(&root)];
    let [occ3d, page, report] = ["occ3d", "page.html", "report.html"].map(|name| log.beside(name));
    let lines: [&[&str]; 15] = [
        &["--help"],
        &["presets"],
        &["man"],
        &["completions", "bash"],
        &["presets", "absent"],
        &["label", "--nonsense"],
        &["verify", labels],
        &["compare", labels, labels],
        &["describe", labels],
        &["view", labels, "--output", text(&page)],
        &["report", labels, "--output", text(&report)],
        &["convert", labels, "--to", "occ3d-nuscenes", "--output", text(&occ3d)],
        &[&["check"], &log_flags[..]].concat(),
        &[&["inspect"], &log_flags[..]].concat(),
        &[&["label", "--dry-run", "--output", "absent"], &log_flags[..]].concat(),
    ];
    for line in lines {
        let read = command(line).output().expect("an end");
        let unread = unread(line);
        assert_eq!(unread.0.status.code(), read.status.code(), "{line:?}");
        let stderr = String::from_utf8_lossy(&unread.0.stderr);
        assert!(!stderr.contains("panicked") && !stderr.contains("pipe"), "{line:?}: {stderr}");
        assert_eq!(unread.1.code(), read.status.code(), "{line:?} with closed streams");
    }
}

/// How a line ends if nobody reads stdout, and if both streams are closed.
fn unread(line: &[&str]) -> (std::process::Output, std::process::ExitStatus) {
    let (reader, writer) = pipe().expect("a pipe");
    drop(reader);
    let broken = command(line).stdout(writer).output().expect("an end");
    let (reader, writer) = pipe().expect("a pipe");
    drop(reader);
    let deaf = command(line).stdout(Stdio::null()).stderr(writer).status().expect("an end");
    assert_eq!(deaf.code(), broken.status.code(), "{line:?} with nobody to read stderr");
    let mut shell = Command::new("sh");
    shell.args(["-c", "exec \"$@\" >&- 2>&-", "sh", env!("CARGO_BIN_EXE_occlabel")]);
    (broken, shell.args(line).status().expect("an end"))
}
