//! The line of `describe`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 described, 1 it cannot be read, or --strict and suspicious, \
    2 usage."
)]
pub(crate) struct DescribeArgs {
    /// A label file, or a folder of them.
    #[arg(value_name = "FILE")]
    pub(crate) input: PathBuf,
    /// Take it for this dialect. [default: the one that it looks like]
    #[arg(long, value_name = "DIALECT")]
    pub(crate) dialect: Option<String>,
    /// Fail if anything is suspicious.
    #[arg(long)]
    pub(crate) strict: bool,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}
