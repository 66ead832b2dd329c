//! `completions` and `man`.

use clap::{CommandFactory, ValueEnum};
use clap_complete::Shell;
use clap_mangen::Man;
use occlabel_core::Fault;

use crate::args::Cli;
use crate::console::Console;
use crate::exit::{Outcome, Stop};

/// Prints a completion script for a shell; `man` prints the manual page.
pub(crate) fn run(shell: &str, console: &Console) -> Result<Outcome, Stop> {
    if shell == "man" {
        return man(console);
    }
    let shell = Shell::from_str(shell, true).map_err(|_| {
        let shells: Vec<String> = Shell::value_variants().iter().map(Shell::to_string).collect();
        let expected = format!("one of {}, man", shells.join(", "));
        Stop::usage(Fault::new("usage", "completions", expected, format!("`{shell}`")))
    })?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "occlabel", &mut script);
    console.results(&script);
    Ok(Outcome::Complete)
}

/// Prints the manual: a page for the program, then one for each command.
pub(crate) fn man(console: &Console) -> Result<Outcome, Stop> {
    let mut program = Cli::command();
    program.build();
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    let mut pages = Vec::new();
    for command in std::iter::once(&program).chain(commands) {
        Man::new(command.clone()).render(&mut pages).map_err(|error| {
            Fault::new("man", "manual page", "to be rendered", error.to_string())
        })?;
    }
    console.results(&pages);
    Ok(Outcome::Complete)
}
