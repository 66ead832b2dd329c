//! `completions` and `man`.

use std::io::Write;

use clap::{CommandFactory, ValueEnum};
use clap_complete::Shell;
use occlabel_core::Fault;

use crate::args::Cli;
use crate::exit::{Outcome, Stop};

/// Prints a completion script for a shell; `man` prints the manual page.
pub(crate) fn run(shell: &str) -> Result<Outcome, Stop> {
    if shell == "man" {
        return man();
    }
    let shell = Shell::from_str(shell, true).map_err(|_| {
        let shells: Vec<String> = Shell::value_variants().iter().map(Shell::to_string).collect();
        let expected = format!("one of {}, man", shells.join(", "));
        Stop::usage(Fault::new("usage", "completions", expected, format!("`{shell}`")))
    })?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "occlabel", &mut script);
    print(&script)
}

/// Prints the manual page.
pub(crate) fn man() -> Result<Outcome, Stop> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Cli::command())
        .render(&mut page)
        .map_err(|error| Fault::new("man", "manual page", "to be rendered", error.to_string()))?;
    print(&page)
}

/// A reader that went away is no error.
fn print(bytes: &[u8]) -> Result<Outcome, Stop> {
    let _ = std::io::stdout().write_all(bytes);
    Ok(Outcome::Complete)
}
