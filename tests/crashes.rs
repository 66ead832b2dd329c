//! Every operation on the files of a label tree fails once, in every way; after each, what the program
//! promises of its trees (`docs/reliability.md`) is checked, and the same command gives the same tree.
//!
//! Needs the cargo feature `faults`. A part of the operations is tried; with `OCCLABEL_CRASHES=all`,
//! every one of every line.
#![cfg(feature = "faults")]

mod support;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use occlabel_labels::{LabelTree, Manifest, verify_file};
use occlabel_testkit::LogSpec;
use support::{Ended, SMALL, TestLog, files_under, leftovers, nano_spec, text, tree_hash};

/// The ways in which an operation fails.
const WAYS: [&str; 5] = ["enospc", "eio", "eacces", "short", "kill"];
/// No line takes more operations than this.
const MOST: usize = 2000;

/// A command that writes a tree.
struct Line {
    /// Without the output folder, which `--output` names.
    args: Vec<String>,
    /// What stands in the folder before.
    before: Option<PathBuf>,
    /// The tree as it is left undisturbed.
    expected: BTreeMap<String, Vec<u8>>,
    hash: String,
}

/// A log of two keyframes, and a copy of its files.
fn log() -> (TestLog, BTreeMap<String, Vec<u8>>) {
    let log = TestLog::simulated(&LogSpec { keyframes: 2, ..nano_spec() });
    let files = files_under(&log.root());
    (log, files)
}

impl Line {
    /// Runs the line once, undisturbed, into `name` beside the log.
    fn new(log: &TestLog, name: &str, args: &[&str], before: Option<PathBuf>) -> Self {
        let args = args.iter().map(|arg| (*arg).to_owned()).collect();
        let mut line = Self { args, before, expected: BTreeMap::new(), hash: String::new() };
        let output = log.beside(name);
        line.prepare(&output);
        line.run(&output, None).exits(0);
        line.expected = files_under(&output);
        line.hash = tree_hash(&output);
        line
    }

    fn label(log: &TestLog, name: &str, more: &[&str]) -> Self {
        let root = log.root();
        let line = ["label", "--format", "nuscenes", "--input", text(&root), "--jobs", "1"];
        Self::new(log, name, &[&line[..], &SMALL, more].concat(), None)
    }

    fn prepare(&self, output: &Path) {
        let _ = std::fs::remove_dir_all(output);
        if let Some(before) = &self.before {
            support::copy(before, output);
        }
    }

    fn run(&self, output: &Path, fault: Option<&str>) -> Ended {
        let mut command = Command::new(env!("CARGO_BIN_EXE_occlabel"));
        command.args(&self.args).args(["--output", text(output)]);
        if let Some(fault) = fault {
            command.env("OCCLABEL_FAULT", fault);
        }
        Ended::of(command.output().expect("the program starts"))
    }

    /// Has every `stride`-th operation fail, until the line takes fewer; gives how many failed.
    fn try_all(&self, output: &Path, way: &str, stride: usize) -> usize {
        for at in (0..MOST).step_by(stride) {
            self.prepare(output);
            let fault = format!("{at}:{way}");
            let ended = self.run(output, Some(&fault));
            if !ended.stderr.contains("on purpose") {
                return at / stride;
            }
            self.check_promises(output, &fault, &ended);
            self.run(output, None).exits(0);
            assert_eq!(tree_hash(output), self.hash, "{fault}");
            assert_eq!(leftovers(output), [""; 0], "{fault}");
        }
        panic!("more than {MOST} operations");
    }

    /// A final name means a complete file; what a manifest lists is as it says.
    fn check_promises(&self, output: &Path, fault: &str, ended: &Ended) {
        let is_error = |line: &str| line.starts_with("error: ");
        let told = ended.code == Some(1) && ended.stderr.lines().any(is_error);
        let killed = ended.code.is_none() && fault.ends_with("kill");
        assert!(told || killed || ended.code == Some(0), "{fault}: {ended:?}");
        for (name, bytes) in files_under(output) {
            let is_labels = name.ends_with(".npz") || name.ends_with(".npy");
            assert!(!is_labels || self.expected[&name] == bytes, "{fault}: {name} is not whole");
        }
        let tree = LabelTree::new(output);
        let manifest = Manifest::load(&output.join("manifest.json")).expect("a whole manifest");
        for file in manifest.iter().flat_map(|manifest| &manifest.files) {
            verify_file(&tree, file).unwrap_or_else(|wrong| panic!("{fault}: {wrong}"));
        }
    }
}

/// How many operations are passed over after each one that fails.
fn stride(of_a_part: usize) -> usize {
    match std::env::var("OCCLABEL_CRASHES").as_deref() {
        Ok("all") => 1,
        _ => of_a_part,
    }
}

/// Has the operations of a line fail in every way.
fn fail(line: &Line, log: &TestLog, of_a_part: usize) -> usize {
    let output = log.beside("failing");
    let failed = WAYS.map(|way| line.try_all(&output, way, stride(of_a_part)));
    println!("{failed:?} failures of {WAYS:?}");
    failed.iter().sum()
}

#[test]
fn fault_38_39_whatever_fails_nothing_is_lost_and_the_same_command_ends_in_the_same_tree() {
    let (log, inputs) = log();
    let failed = fail(&Line::label(&log, "undisturbed", &[]), &log, 3);
    assert!(failed >= 150, "{failed} failures");
    assert!(files_under(&log.root()) == inputs, "inputs are never written");
}

#[test]
fn fault_38_39_the_same_of_several_sets_at_once() {
    let (log, inputs) = log();
    let sets = ["--evidence", "--also", "1.6,occ3d-nuscenes"];
    let failed = fail(&Line::label(&log, "undisturbed", &sets), &log, 11);
    assert!(failed >= 20, "{failed} failures");
    assert!(files_under(&log.root()) == inputs, "inputs are never written");
}
