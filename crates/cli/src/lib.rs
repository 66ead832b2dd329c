//! The `occlabel` program: arguments, progress, exit codes.
//!
//! This is the edge: clocks, threads, signals, files and terminals live here, so that the stages can
//! be values in and values out. Results go to stdout, all else to stderr, and how a run ended is its
//! exit code: 0 complete, 1 failed, 2 usage or configuration, 3 finished with something skipped or
//! degraded, 130 interrupted.
//!
//! ```
//! use std::process::ExitCode;
//!
//! assert_eq!(occlabel_cli::run(["occlabel", "presets", "precise"]), ExitCode::SUCCESS);
//! ```

mod args;
mod check;
mod compare;
mod completions;
mod console;
mod convert;
mod decoded_image;
mod demo;
mod describe;
mod evaluate;
mod exit;
mod format_flags;
mod format_hint;
mod input;
mod inspect;
mod interrupt;
mod label;
mod label_pairs;
mod lacks;
mod logged_scene;
mod mask_reader;
mod masks;
mod merge_manifests;
mod plan;
mod polarization;
mod presets;
mod progress;
mod quality;
mod ray_origins;
mod report;
mod shown_set;
mod simulate;
mod threads;
mod urls;
mod verify;
mod view;

use std::ffi::OsString;
use std::panic::PanicHookInfo;
use std::process::ExitCode;

use clap::Parser;
use occlabel_core::Fault;

use crate::args::{Cli, Command, LogFormat};
use crate::console::Console;
use crate::exit::{Outcome, Stop};

/// Runs the program on the arguments of the process.
pub fn main() -> ExitCode {
    let args: Vec<OsString> = std::env::args_os().collect();
    if asks_for_json(&args) {
        std::panic::set_hook(Box::new(tell_panic));
    }
    run(args)
}

/// Runs the program on these arguments, its own name first.
pub fn run(args: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> ExitCode {
    let args: Vec<OsString> = args.into_iter().map(Into::into).collect();
    let cli = match Cli::try_parse_from(&args) {
        Ok(cli) => cli,
        Err(usage) => return explain(&usage, asks_for_json(&args)),
    };
    let console = Console::new(cli.log_format, cli.quiet);
    let ended = dispatch(&cli.command, &console);
    let code = match console.refused().map_or(ended, |fault| Err(fault.into())) {
        Ok(outcome) => outcome.code(),
        Err(stop) => {
            stop.faults().iter().for_each(|fault| console.error(fault));
            stop.code()
        }
    };
    console.end(code);
    ExitCode::from(code)
}

/// A fault of the program's own, as a line like that of any other.
fn tell_panic(panic: &PanicHookInfo) {
    let place = panic.location().map_or_else(|| "the program".to_owned(), ToString::to_string);
    let found = panic.payload_as_str().unwrap_or("a panic");
    let fault = Fault::new("panic", place, "a program without faults", found);
    Console::new(LogFormat::Json, false).error(&fault.hint("please report it"));
}

/// Prints help, or what is wrong with the command line.
fn explain(usage: &clap::Error, as_json: bool) -> ExitCode {
    if usage.use_stderr() && as_json {
        let text = usage.to_string();
        let told = text.lines().take_while(|line| !line.starts_with("Usage:")).map(str::trim);
        let told: Vec<&str> = told.filter(|line| !line.is_empty()).collect();
        let found = told.join(" ").trim_start_matches("error: ").to_owned();
        let console = Console::new(LogFormat::Json, false);
        console.error(&Fault::new(
            "usage",
            "command line",
            "what `occlabel --help` describes",
            found,
        ));
    } else {
        let _ = usage.print();
    }
    ExitCode::from(usage.exit_code() as u8)
}

/// Whether a command line that could not be parsed asks for messages as JSON.
fn asks_for_json(args: &[OsString]) -> bool {
    let follows = |pair: &[OsString]| pair[0] == "--log-format" && pair[1] == "json";
    args.iter().any(|arg| arg == "--log-format=json") || args.windows(2).any(follows)
}

fn dispatch(command: &Command, console: &Console) -> Result<Outcome, Stop> {
    match command {
        Command::Demo(args) => demo::run(args, console),
        Command::Label(args) => label::run(args, console),
        Command::Plan(args) => plan::run(args, console),
        Command::Check(args) => check::run(args, console),
        Command::Quality(args) => quality::run(args, console),
        Command::Evaluate(args) => evaluate::run(args, console),
        Command::Compare(args) => compare::run(args, console),
        Command::Convert(args) => convert::run(args, console),
        Command::Describe(args) => describe::run(args, console),
        Command::View(args) => view::run(args, console),
        Command::Polarization(args) => polarization::run(args, console),
        Command::Report(args) => report::run(args, console),
        Command::MergeManifests(args) => merge_manifests::run(args, console),
        Command::Verify(args) => verify::run(args, console),
        Command::Inspect(args) => inspect::run(args, console),
        Command::Simulate(args) => simulate::run(args, console),
        Command::Presets { name } => presets::run(name.as_deref(), console),
        Command::Completions { shell } => completions::run(shell, console),
        Command::Man => completions::man(console),
    }
}
