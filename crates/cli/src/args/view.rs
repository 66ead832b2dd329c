//! The line of `view`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use occlabel_core::ColorSet;

use super::{ConfigArgs, LogArgs};

#[derive(Debug, Args)]
#[command(mut_arg("format", |arg| arg.required(false)))]
#[command(mut_arg("input", |arg| arg.required(false)))]
pub(crate) struct ViewArgs {
    /// The labels: a folder in any dialect.
    #[arg(value_name = "DIR")]
    pub(crate) labels: PathBuf,
    /// What is made, by its ending: .png.
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
    /// Which picture a .png is.
    #[arg(long, value_enum, default_value_t = PictureArg::BirdsEye)]
    pub(crate) picture: PictureArg,
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

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureArg {
    /// From above: the class of the topmost occupied voxel.
    BirdsEye,
    /// Occupied voxels as lit cubes.
    Perspective,
}
