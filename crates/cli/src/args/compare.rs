//! The line of `compare`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 equal within the tolerance, 1 not, or failed, 2 usage or configuration."
)]
pub(crate) struct CompareArgs {
    /// The label set that is compared with.
    #[arg(value_name = "A")]
    pub(crate) a: PathBuf,
    /// The label set that is compared.
    #[arg(value_name = "B")]
    pub(crate) b: PathBuf,
    /// The dialect of A, where it does not tell itself.
    #[arg(long, value_name = "NAME")]
    pub(crate) a_dialect: Option<String>,
    /// The dialect of B, where it does not tell itself.
    #[arg(long, value_name = "NAME")]
    pub(crate) b_dialect: Option<String>,
    /// The share of a keyframe's voxels that may differ, from 0 to 1.
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = parse_share)]
    pub(crate) tolerance: f64,
    /// Only these scenes.
    #[arg(long, value_delimiter = ',', value_name = "NAME,...")]
    pub(crate) scenes: Vec<String>,
    /// Compare the arrays that both sets have: one that only one has is no difference.
    #[arg(long)]
    pub(crate) shared_arrays: bool,
    /// Leave out RayIoU, which takes most of the time.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Origins of rays by keyframe, JSON: {"TOKEN": [[x, y, z], ...]}, metres in the grid frame.
    /// [default: the lidar's, as the manifest of A tells]
    #[arg(long, value_name = "FILE", conflicts_with = "quick")]
    pub(crate) ray_origins: Option<PathBuf>,
    /// How many of the keyframes that differ most are told.
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub(crate) worst: usize,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err(format!("expected a share from 0 to 1, found `{text}`")),
    }
}
