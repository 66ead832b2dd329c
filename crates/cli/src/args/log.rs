//! Which log, how to read it, and what decides its labels.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Which log, and how to read it.
#[derive(Debug, Args)]
pub(crate) struct LogArgs {
    /// The log's format.
    #[arg(long, value_enum)]
    pub(crate) format: Format,
    /// The log's root folder.
    #[arg(long)]
    pub(crate) input: PathBuf,
    /// nuScenes: the folder of the tables; needed if there are several.
    #[arg(long)]
    pub(crate) version: Option<String>,
    /// Only these scenes.
    #[arg(long, value_delimiter = ',', value_name = "NAME,...")]
    pub(crate) scenes: Vec<String>,
    /// Only the scenes listed in this file, one a line; `-` is stdin.
    #[arg(long, value_name = "FILE", conflicts_with = "scenes")]
    pub(crate) scenes_from: Option<PathBuf>,
    /// nuScenes: the order of quaternions in the tables. [default: wxyz]
    #[arg(long, value_enum)]
    pub(crate) quat_order: Option<QuatOrder>,
    /// nuScenes: values per point in sweep files; given, the files are taken at that word.
    #[arg(long, value_parser = clap::value_parser!(u8).range(4..=5))]
    pub(crate) columns: Option<u8>,
    /// Take raw labels and categories that the taxonomy does not name as this class.
    #[arg(long, value_name = "CLASS")]
    pub(crate) unknown_as: Option<String>,
    /// MCAP: which of a message's times counts. [default: header]
    #[arg(long, value_enum)]
    pub(crate) time_source: Option<TimeSourceArg>,
    /// MCAP: read a broken file up to where it is broken.
    #[arg(long)]
    pub(crate) recover: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// JSON tables, and a file of points for each sweep.
    Nuscenes,
    /// Waymo Open Dataset: TFRecord files (v1), or Parquet components (v2).
    Waymo,
    /// Sequences in the layout of SemanticKITTI, or of KITTI-360.
    Semantickitti,
    /// Argoverse 2 sensor logs.
    Av2,
    /// Sequences in the layout of CODa, a robot's campus.
    Coda,
    /// MCAP files, one scene each: ROS 1, ROS 2 and Foxglove messages.
    Mcap,
    /// Reconstructed clouds of points or surfels (PLY, PCD, LAS), with poses, cameras and tracks.
    Cloud,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum QuatOrder {
    Wxyz,
    Xyzw,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TimeSourceArg {
    /// The messages' own times.
    Header,
    /// The times at which they were recorded.
    Log,
}

/// What decides the labels.
#[derive(Debug, Args)]
pub(crate) struct ConfigArgs {
    /// A preset; `occlabel presets` lists them. [default: precise]
    #[arg(long, value_name = "NAME")]
    pub(crate) preset: Option<String>,
    /// A TOML file; keys it leaves out are as in `precise`.
    #[arg(long, value_name = "FILE", conflicts_with = "preset")]
    pub(crate) config: Option<PathBuf>,
    /// Set one key, after preset or file; any number of times. VALUE is TOML, or else a string.
    #[arg(long = "set", value_name = "table.key=VALUE")]
    pub(crate) settings: Vec<String>,
}

impl ConfigArgs {
    /// Whether nothing was said.
    pub(crate) fn is_empty(&self) -> bool {
        self.preset.is_none() && self.config.is_none() && self.settings.is_empty()
    }
}
