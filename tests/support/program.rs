//! The program, and how it ended.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A grid of 40 x 40 x 8 voxels, for tests that are not about the grid.
pub(crate) const SMALL: [&str; 6] = [
    "--set",
    "grid.min_m=[-16.0, -16.0, -1.0]",
    "--set",
    "grid.max_m=[16.0, 16.0, 5.4]",
    "--set",
    "grid.voxel_size_m=0.8",
];

/// What a run of the program left on its streams.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// A line `occlabel label --format nuscenes --input LOG --output OUT …`.
#[derive(Clone, Debug)]
pub(crate) struct Label {
    args: Vec<String>,
    /// Where the label tree goes.
    pub(crate) output: PathBuf,
}

/// Runs the program.
pub(crate) fn occlabel(args: &[&str]) -> Ended {
    Ended::of(program().args(args).output().expect("the program starts"))
}

/// Runs the program with a bound on its address space, where a shell can set one.
pub(crate) fn occlabel_within(kib: u32, args: &[&str]) -> Ended {
    let mut command = Command::new("sh");
    let bounded = format!("ulimit -v {kib} 2>/dev/null; exec \"$@\"");
    command.args(["-c", &bounded, "sh"]).arg(program().get_program()).args(args);
    Ended::of(command.output().expect("the program starts"))
}

/// A path as an argument.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// The label tree, in the small grid, of a drive through a world: written as one format and read as it,
/// or as another that reads both.
pub(crate) fn labelled_drive(
    folder: &Path,
    world: &str,
    [written, read]: [&str; 2],
    taxonomy: &str,
) -> PathBuf {
    let (log, labels) = (folder.join(written), folder.join(format!("{written}-labels")));
    let file = folder.join("world.toml");
    fs::write(&file, world).expect("a world");
    let line = ["simulate", "--world", text(&file), "--format", written, "--output", text(&log)];
    occlabel(&[&line[..], &["--images", "none"]].concat()).exits(0);
    let line = ["label", "--format", read, "--input", text(&log), "--output", text(&labels)];
    let taxonomy = format!("taxonomy.file={taxonomy}");
    let rules = ["--set", &taxonomy, "--set", "aggregate.ego_box_m=none", "--evidence"];
    occlabel(&[&line[..], &rules, &SMALL].concat()).exits(0);
    labels
}

/// The program as it was built with the tests, or the build that `OCCLABEL_BINARY` names.
pub(crate) fn program() -> Command {
    let built = || env!("CARGO_BIN_EXE_occlabel").into();
    Command::new(std::env::var_os("OCCLABEL_BINARY").unwrap_or_else(built))
}

impl Label {
    /// A line for a log and an output folder.
    pub(crate) fn new(log: &Path, output: &Path) -> Self {
        let line =
            ["label", "--format", "nuscenes", "--input", text(log), "--output", text(output)];
        Self { args: line.map(str::to_owned).to_vec(), output: output.to_owned() }
    }

    /// The same line with more arguments.
    pub(crate) fn with(mut self, args: &[&str]) -> Self {
        self.args.extend(args.iter().map(|arg| (*arg).to_owned()));
        self
    }

    /// The same line in the small grid.
    pub(crate) fn small(self) -> Self {
        self.with(&SMALL)
    }

    /// Runs it.
    pub(crate) fn run(&self) -> Ended {
        Ended::of(self.command().output().expect("the program starts"))
    }

    /// The line as a command that was not started.
    pub(crate) fn command(&self) -> Command {
        let mut command = program();
        command.args(&self.args);
        command
    }
}

impl Ended {
    pub(crate) fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        Self {
            code: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// Asserts the exit code.
    #[track_caller]
    pub(crate) fn exits(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout:\n{}stderr:\n{}", self.stdout, self.stderr);
        self
    }

    /// Asserts that one line of stderr has all these parts.
    #[track_caller]
    pub(crate) fn tells(self, parts: &[&str]) -> Self {
        let told = self.stderr.lines().any(|line| parts.iter().all(|part| line.contains(part)));
        assert!(told, "no line with {parts:?} in:\n{}", self.stderr);
        self
    }

    /// Asserts that stderr has nothing of the kind.
    #[track_caller]
    pub(crate) fn tells_nothing_of(self, part: &str) -> Self {
        assert!(!self.stderr.contains(part), "`{part}` in:\n{}", self.stderr);
        self
    }

    /// The lines of stderr as JSON.
    #[track_caller]
    pub(crate) fn json_lines(&self) -> Vec<Value> {
        let parse = |line: &str| serde_json::from_str(line).unwrap_or_else(|_| panic!("{line}"));
        self.stderr.lines().map(parse).collect()
    }
}
