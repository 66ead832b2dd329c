//! The line of `verify`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "Exit codes: 0 all as the manifest says, 1 not, or failed, 2 usage.")]
pub(crate) struct VerifyArgs {
    /// The label tree.
    #[arg(value_name = "DIR")]
    pub(crate) labels: PathBuf,
    /// Where the keyframes to label again are listed, SCENE/TOKEN a line: for `label --redo`.
    #[arg(long, value_name = "FILE")]
    pub(crate) redo_list: Option<PathBuf>,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}
