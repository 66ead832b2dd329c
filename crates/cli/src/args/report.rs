//! The line of `report`.

use std::path::PathBuf;

use clap::Args;

use super::view::ColorsArg;

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// The labels: the output of a run, finished or not, or a folder in any dialect.
    #[arg(value_name = "DIR")]
    pub(crate) labels: PathBuf,
    /// The page that is made.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// The dialect of the labels, where they do not tell themselves.
    #[arg(long, value_name = "NAME")]
    pub(crate) dialect: Option<String>,
    /// What `quality --json` printed about these labels; may be given several times.
    #[arg(long, value_name = "FILE")]
    pub(crate) quality: Vec<PathBuf>,
    /// The colours of the classes.
    #[arg(long, value_enum, default_value_t = ColorsArg::Standard, value_name = "SET")]
    pub(crate) colors: ColorsArg,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
}
