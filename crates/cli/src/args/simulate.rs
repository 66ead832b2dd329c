//! The line of `simulate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// A shipped world (street, crossing, …), or a world file.
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) world: String,
    /// The log's format.
    #[arg(long, value_enum)]
    pub(crate) format: WrittenFormat,
    /// Where the log goes: a folder that is absent or empty.
    #[arg(long)]
    pub(crate) output: PathBuf,
    /// Set one key of the world file; any number of times. VALUE is TOML, or else a string.
    #[arg(long = "set", value_name = "key.path=VALUE")]
    pub(crate) settings: Vec<String>,
    /// Which exposures become image files, with a mask of classes each (mcap: without; waymo, cloud: none).
    #[arg(long, value_enum, default_value_t = ImagesArg::Keyframes)]
    pub(crate) images: ImagesArg,
    /// Write masks of classes and instances of these exposures into `masks`, whatever the format.
    #[arg(long)]
    pub(crate) masks: bool,
    /// Write the surfaces of people at keyframes too, as OBJ files below `meshes` (nuscenes, mcap).
    #[arg(long)]
    pub(crate) meshes: bool,
    /// nuScenes: so many scenes, each with a seed of its own.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=9999))]
    pub(crate) scenes: u32,
}

/// A format that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WrittenFormat {
    Nuscenes,
    /// One lidar, no boxes, no images.
    Semantickitti,
    /// One lidar, two cameras that it triggers; point labels of terrain alone.
    Coda,
    Mcap,
    /// Waymo Open Dataset, v1: a TFRecord file.
    Waymo,
    /// Waymo Open Dataset, v2: Parquet components.
    WaymoV2,
    /// What the cameras alone make of it: a cloud, without lidar and images.
    Cloud,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ImagesArg {
    None,
    Keyframes,
    All,
}
