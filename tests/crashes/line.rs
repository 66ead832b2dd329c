//! A command whose undisturbed end is known.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use occlabel_testkit::LogSpec;

use crate::support::{Ended, SMALL, TestLog, copy, files_under, leftovers, nano_spec, text};

/// Stands for the output folder in the arguments of a line.
pub(crate) const OUT: &str = "@OUT";

/// Files by their paths below the output folder.
pub(crate) type Files = BTreeMap<String, Vec<u8>>;

/// A command that writes into a folder.
pub(crate) struct Line {
    args: Vec<String>,
    /// What stands in the folder before.
    folder_before: Option<PathBuf>,
    pub(crate) before: Files,
    /// How it ends undisturbed, and what it leaves then.
    pub(crate) code: i32,
    pub(crate) expected: Files,
}

/// A log of so many scenes of two keyframes.
pub(crate) fn log_of(scenes: usize) -> TestLog {
    TestLog::simulated(&LogSpec { keyframes: 2, ..nano_spec() }.with_scenes(scenes))
}

impl Line {
    /// Runs a line once, undisturbed, in a folder called `undisturbed` beside the log.
    pub(crate) fn new(log: &TestLog, args: &[&str], before: Option<PathBuf>) -> Self {
        let args = args.iter().map(|arg| (*arg).to_owned()).collect();
        let before_files = before.as_deref().map(files_under).unwrap_or_default();
        let (code, expected) = (0, Files::new());
        let mut line = Self { args, folder_before: before, before: before_files, code, expected };
        let output = log.beside("undisturbed");
        line.prepare(&output);
        let ended = line.run(&output, None);
        line.code = ended.code.expect("an undisturbed end");
        line.expected = files_under(&output);
        assert!(!line.left(&output).is_empty(), "{ended:?}");
        line
    }

    /// A line that labels the log in the small grid.
    pub(crate) fn label(log: &TestLog, more: &[&str]) -> Self {
        Self::label_over(log, more, None)
    }

    /// The same over what stands in the output folder already.
    pub(crate) fn label_over(log: &TestLog, more: &[&str], before: Option<PathBuf>) -> Self {
        let root = log.root();
        let line = ["label", "--format", "nuscenes", "--input", text(&root), "--output", OUT];
        let line = Self::new(log, &[&line[..], &SMALL, more].concat(), before);
        assert_eq!(line.code, 0);
        line
    }

    /// Puts into the folder what stands there before the line is run, and nothing else.
    pub(crate) fn prepare(&self, output: &Path) {
        let _ = std::fs::remove_dir_all(output);
        if let Some(before) = &self.folder_before {
            copy(before, output);
        }
    }

    /// Runs it, with an operation that fails on purpose.
    pub(crate) fn run(&self, output: &Path, fault: Option<&str>) -> Ended {
        let mut command = self.command(output);
        if let Some(fault) = fault {
            command.env("OCCLABEL_FAULT", fault);
        }
        Ended::of(command.output().expect("the program starts"))
    }

    /// The line as a command that was not started.
    pub(crate) fn command(&self, output: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_occlabel"));
        command.args(self.args.iter().map(|arg| arg.replace(OUT, text(output))));
        command
    }

    /// The files below the output folder, reports of how it went left out.
    pub(crate) fn left(&self, output: &Path) -> Files {
        let mut files = files_under(output);
        files.retain(|path, _| !is_report(path));
        files
    }

    /// Asserts that the same command again leaves what an undisturbed one leaves.
    #[track_caller]
    pub(crate) fn ends_as_undisturbed(&self, output: &Path, why: &str) {
        let ended = self.run(output, None);
        assert_eq!(ended.code, Some(self.code), "{why}: {ended:?}");
        self.is_as_undisturbed(output, why);
        assert_eq!(leftovers(output), [""; 0], "{why}");
    }

    /// Asserts that what is left is what an undisturbed run leaves, but for locks of the process that
    /// wrote it.
    #[track_caller]
    pub(crate) fn is_as_undisturbed(&self, output: &Path, why: &str) {
        let expected = self.expected.iter().filter(|(path, _)| !is_report(path));
        let left = self.left(output);
        let differs = |(path, bytes): &(&String, &Vec<u8>)| left.get(*path) != Some(bytes);
        let lacking: Vec<_> = expected.filter(differs).map(|(path, _)| path).collect();
        let is_more =
            |path: &&String| !self.expected.contains_key(*path) && !path.ends_with(".lock");
        let more: Vec<_> = left.keys().filter(is_more).collect();
        assert!(lacking.is_empty() && more.is_empty(), "{why}: lacks {lacking:?}, has {more:?}");
    }
}

/// Whether a path is that of `report.json`, or of a shard's: they tell times.
fn is_report(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or(path);
    name.starts_with("report.") && name.ends_with(".json")
}
