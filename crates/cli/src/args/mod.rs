//! The command line: what all commands share, and a file for each that has much of its own.

mod compare;
mod convert;
mod describe;
mod evaluate;
mod label;
mod log;
mod picture;
mod polarization;
mod quality;
mod report;
mod simulate;
mod verify;
mod view;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use compare::CompareArgs;
pub(crate) use convert::ConvertArgs;
pub(crate) use describe::DescribeArgs;
pub(crate) use evaluate::{EvaluateArgs, MaskArg, MetricArg};
pub(crate) use label::{LabelArgs, OnError, PlanArgs, ProgressArg, ResumeArg, Shard, WorkArgs};
pub(crate) use log::{ConfigArgs, Format, LogArgs, QuatOrder, TimeSourceArg};
pub(crate) use picture::{AcrossArg, PictureArg, PictureArgs};
pub(crate) use polarization::PolarizationArgs;
pub(crate) use quality::QualityArgs;
pub(crate) use report::ReportArgs;
pub(crate) use simulate::{ImagesArg, SimulateArgs, WrittenFormat};
pub(crate) use verify::VerifyArgs;
pub(crate) use view::{MeshArg, ViewArgs};

/// Ground truth for 3D semantic occupancy: dense voxel labels and visibility masks from logged
/// drives.
#[derive(Debug, Parser)]
#[command(name = "occlabel", bin_name = "occlabel", version)]
#[command(
    after_help = "Exit codes: 0 complete, 1 failed, 2 usage or configuration, 3 finished with \
    something skipped or degraded, 130 interrupted (the same command goes on from there).\n\
    Begin with `occlabel demo`."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// How messages on stderr are written.
    #[arg(long, value_enum, default_value_t = LogFormat::Text, global = true)]
    pub(crate) log_format: LogFormat,
    /// Print errors and results, nothing else.
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    Text,
    /// One JSON object a line.
    Json,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a small street, label it, judge it against its exact truth, draw it.
    Demo(DemoArgs),
    /// Label a log: the main job.
    Label(Box<LabelArgs>),
    /// List a log's scenes with what labelling each will cost, as JSON lines; nothing is written.
    Plan(Box<PlanArgs>),
    /// Find every fault of a log at once; nothing is written.
    Check(Box<CheckArgs>),
    /// Measure how right labels are.
    Quality(Box<QualityArgs>),
    /// Score predictions by the benchmarks' own scores.
    Evaluate(Box<EvaluateArgs>),
    /// Show how two label sets differ; exit 0 if they do not.
    Compare(CompareArgs),
    /// Turn labels of one dialect into another's.
    Convert(Box<ConvertArgs>),
    /// Tell which dialect label files look like, what they hold, and what is odd about them.
    Describe(DescribeArgs),
    /// Show labels: as a picture, for Foxglove and Rerun, as a mesh, or as a page.
    View(Box<ViewArgs>),
    /// Put images of how light is polarized beside the labels, from four cameras behind polarizers.
    Polarization(Box<PolarizationArgs>),
    /// Show a whole run on one page, what strays from the rest first.
    Report(ReportArgs),
    /// Make the manifests of a run in shards one, as an undivided run would have written it.
    MergeManifests(MergeArgs),
    /// Check a label tree against its manifest, every bit of it.
    Verify(VerifyArgs),
    /// Show what a log holds.
    Inspect(InspectArgs),
    /// Drive through an exactly known world: a log with its truth.
    Simulate(SimulateArgs),
    /// List the presets, or print one with the source of every key.
    Presets {
        /// The preset, or `taxonomies/NAME`.
        name: Option<String>,
    },
    /// Print a completion script, or the manual page.
    Completions {
        /// bash, zsh, fish, powershell, elvish, or man.
        shell: String,
    },
    /// Print the manual page.
    Man,
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Where the log and its labels go.
    #[arg(long, default_value = "occlabel-demo")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// The label tree.
    #[arg(value_name = "DIR")]
    pub(crate) labels: PathBuf,
    /// Do with the shards that have ended; the others can be merged in later.
    #[arg(long)]
    pub(crate) without_missing: bool,
}

#[derive(Debug, Args)]
pub(crate) struct InspectArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 nothing wrong, 1 errors, 2 usage or configuration, 3 warnings."
)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }
}
