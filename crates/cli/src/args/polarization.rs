//! The line of `polarization`.

use std::path::PathBuf;

use clap::Args;

use super::{ConfigArgs, LogArgs};

#[derive(Debug, Args)]
#[command(mut_arg("format", |arg| arg.required(false)))]
#[command(mut_arg("input", |arg| arg.required(false)))]
pub(crate) struct PolarizationArgs {
    /// Where the images go: DIR/gts/<scene>/<token>/, beside the labels if DIR is a label tree; with
    /// --images what their names begin with.
    #[arg(long, value_name = "DIR|PREFIX")]
    pub(crate) output: PathBuf,
    /// The log's cameras behind polarizers at 0, 45, 90 and 135 degrees.
    #[arg(long, value_delimiter = ',', value_name = "C0,C45,C90,C135", requires = "input")]
    pub(crate) cameras: Vec<String>,
    /// Four files instead of a log's cameras.
    #[arg(long, num_args = 4, value_names = ["I0", "I45", "I90", "I135"])]
    #[arg(conflicts_with_all = ["cameras", "LogArgs", "ConfigArgs"])]
    pub(crate) images: Option<Vec<PathBuf>>,
    /// What a keyframe's images are called: NAME_dolp.png, NAME_aolp.png.
    #[arg(long, default_value = "polarization")]
    pub(crate) name: String,
    #[command(flatten)]
    pub(crate) log: Option<LogArgs>,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
}
