//! The line of `view`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use occlabel_core::ColorSet;

use super::{ConfigArgs, LogArgs, PictureArgs};

#[derive(Debug, Args)]
#[command(mut_arg("format", |arg| arg.required(false)))]
#[command(mut_arg("input", |arg| arg.required(false)))]
pub(crate) struct ViewArgs {
    /// The labels: a folder in any dialect.
    #[arg(value_name = "DIR")]
    pub(crate) labels: PathBuf,
    /// What is made, by its ending: .png, .html, .mcap, .ply, .glb.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// The dialect of the labels, where they do not tell themselves.
    #[arg(long, value_name = "NAME")]
    pub(crate) dialect: Option<String>,
    /// The scene. [default: the first]
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,
    /// Only these keyframes. [default: the one in the middle where one is shown, else all]
    #[arg(long, value_delimiter = ',', value_name = "TOKEN,...")]
    pub(crate) keyframes: Vec<String>,
    /// The colours of the classes.
    #[arg(long, value_enum, default_value_t = ColorsArg::Standard, value_name = "SET")]
    pub(crate) colors: ColorsArg,
    #[command(flatten)]
    pub(crate) picture: PictureArgs,
    // .mcap
    /// .mcap: all sweeps of all lidars, not the keyframes' own alone; needs the log.
    #[arg(long, requires = "input")]
    pub(crate) all_sweeps: bool,
    // .ply
    /// .ply: what stands for an occupied voxel. [default: points]
    #[arg(long, value_enum)]
    pub(crate) mesh: Option<MeshArg>,
    /// The log that the labels were made of: some of what can be shown stands only there.
    #[command(flatten)]
    pub(crate) log: Option<LogArgs>,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
}

/// A set of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorsArg {
    /// Those of the datasets.
    Standard,
    /// Those that stay apart without the sense of red, of green or of blue.
    ColorBlind,
}

impl From<ColorsArg> for ColorSet {
    fn from(colors: ColorsArg) -> Self {
        match colors {
            ColorsArg::Standard => Self::Standard,
            ColorsArg::ColorBlind => Self::ColorBlind,
        }
    }
}

/// What stands for an occupied voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeshArg {
    /// Its centre.
    Points,
    /// Its faces, those of one track or class joined.
    Cubes,
}
