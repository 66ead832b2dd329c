//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

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

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a small street, label it, judge it against its exact truth, draw it.
    Demo(DemoArgs),
    /// Label a log: the main job.
    Label(Box<LabelArgs>),
    /// Find every fault of a log at once; nothing is written.
    Check(Box<CheckArgs>),
    /// Measure how right labels are.
    Quality(Box<QualityArgs>),
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

#[derive(Debug, Args)]
pub(crate) struct LabelArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    /// Where the label tree goes.
    #[arg(long)]
    pub(crate) output: PathBuf,
    /// Only every N-th scene, counted from the I-th: a share of a larger run, I from 0.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// Write only these keyframes; what is aggregated stays the same.
    #[arg(long, value_delimiter = ',', value_name = "TOKEN,...")]
    pub(crate) keyframes: Vec<String>,
    /// Write `evidence.npz` beside `labels.npz`.
    #[arg(long)]
    pub(crate) evidence: bool,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Memory to stay under, as 8GiB or 500MB.
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes)]
    pub(crate) memory: Option<u64>,
    /// What to do with the keyframes that an earlier run finished.
    #[arg(long, value_enum, default_value_t = ResumeArg::IfSame)]
    pub(crate) resume: ResumeArg,
    /// What to do with a record, sweep, keyframe or scene that cannot be used.
    #[arg(long, value_enum, default_value_t = OnError::Fail)]
    pub(crate) on_error: OnError,
    /// Label although listed sweep files are absent.
    #[arg(long)]
    pub(crate) allow_missing_sweeps: bool,
    /// Show scenes, keyframes, rays and bytes; write nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// How progress is shown on stderr.
    #[arg(long, value_enum, default_value_t = ProgressArg::Auto)]
    pub(crate) progress: ProgressArg,
}

#[derive(Debug, Args)]
#[command(mut_arg("format", |arg| arg.required(false)))]
#[command(mut_arg("input", |arg| arg.required(false)))]
pub(crate) struct QualityArgs {
    /// Label trees to judge by --world-truth; those of one grid share the work.
    #[arg(value_name = "DIR", requires = "world_truth", conflicts_with = "held_out")]
    pub(crate) trees: Vec<PathBuf>,
    /// Judge by an exactly known world: a simulated log's folder, a world file, or a shipped
    /// world's name.
    #[arg(long, value_name = "T", requires = "trees")]
    #[arg(conflicts_with_all = ["held_out", "LogArgs", "ConfigArgs", "range_noise_m"])]
    pub(crate) world_truth: Option<PathBuf>,
    /// Leave out the costly figures: denser rays (A2d) and cameras (A6c, A6g).
    #[arg(long, requires = "world_truth", conflicts_with = "held_out")]
    pub(crate) quick: bool,
    /// Fail if a figure does not keep its limit: `precise`, or a TOML file.
    #[arg(long, value_name = "FILE", requires = "world_truth", conflicts_with = "held_out")]
    pub(crate) limits: Option<PathBuf>,
    /// Keep every N-th sweep of each lidar out of the fusion, and ask it afterwards.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..))]
    #[arg(requires_all = ["format", "input"], required_unless_present = "world_truth")]
    pub(crate) held_out: Option<u16>,
    #[command(flatten)]
    pub(crate) log: Option<LogArgs>,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    /// Standard deviation of the lidar's range noise, metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.02, value_parser = parse_noise)]
    pub(crate) range_noise_m: f64,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print JSON, scene by scene, instead of the table.
    #[arg(long)]
    pub(crate) json: bool,
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
    /// Which exposures become image files, with a mask of classes each (mcap: without; waymo: none).
    #[arg(long, value_enum, default_value_t = ImagesArg::Keyframes)]
    pub(crate) images: ImagesArg,
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
    Mcap,
    /// Waymo Open Dataset, v1: a TFRecord file.
    Waymo,
    /// Waymo Open Dataset, v2: Parquet components.
    WaymoV2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ImagesArg {
    None,
    Keyframes,
    All,
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
    /// MCAP files, one scene each: ROS 1, ROS 2 and Foxglove messages.
    Mcap,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TimeSourceArg {
    /// The messages' own times.
    Header,
    /// The times at which they were recorded.
    Log,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum QuatOrder {
    Wxyz,
    Xyzw,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ResumeArg {
    /// Keep them if version, configuration and inputs are the same, else stop.
    IfSame,
    /// Remove what that run wrote and start anew.
    Never,
    /// Keep them whatever they were made from.
    Always,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum OnError {
    /// Stop.
    Fail,
    /// Leave it out, go on, and exit with 3.
    Skip,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressArg {
    /// A bar on a terminal, plain lines elsewhere.
    Auto,
    Bar,
    Plain,
    /// One JSON object a line.
    Json,
    None,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    Text,
    /// One JSON object a line.
    Json,
}

/// A share of the scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    pub(crate) index: usize,
    pub(crate) count: usize,
}

impl Shard {
    fn parse(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(i, n)| (i.parse::<usize>(), n.parse::<usize>()));
        match numbers {
            Some((Ok(index), Ok(count))) if index < count => Ok(Self { index, count }),
            _ => Err(format!("expected I/N with 0 <= I < N, found `{text}`")),
        }
    }
}

/// Bytes of a size such as `8GiB`, `500MB` or `1000000`.
fn parse_bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit: u64 = match &text[digits.len()..] {
        "" | "B" => 1,
        "kB" | "KB" => 1_000,
        "MB" => 1_000_000,
        "GB" => 1_000_000_000,
        "KiB" => 1 << 10,
        "MiB" => 1 << 20,
        "GiB" => 1 << 30,
        unit => {
            return Err(format!("expected a unit of B, kB, MB, GB, KiB, MiB, GiB, found `{unit}`"));
        }
    };
    match digits.trim().parse::<f64>() {
        Ok(number) if number > 0.0 => Ok((number * unit as f64) as u64),
        _ => Err(format!("expected a number above 0 with a unit, found `{text}`")),
    }
}

/// Metres of noise: 0 or more.
fn parse_noise(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(metres) if metres.is_finite() && metres >= 0.0 => Ok(metres),
        _ => Err(format!("expected metres, 0 or more, found `{text}`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }

    #[test]
    fn quality_refuses_what_it_would_not_use() {
        let parses = |more: &str| {
            let line = format!("occlabel quality {more}");
            Cli::try_parse_from(line.split(' ')).is_ok()
        };
        assert!(parses("tree --world-truth log --quick --json --jobs 2"));
        assert!(parses("--held-out 5 --format nuscenes --input log --preset paper"));
        for unused in ["--preset paper", "--set a.b=1", "--range-noise-m 0.5", "--input log"] {
            assert!(!parses(&format!("tree --world-truth log {unused}")), "{unused}");
        }
        for unused in ["tree", "--quick", "--limits precise", "--world-truth log"] {
            let held_out = format!("--held-out 5 --format nuscenes --input log {unused}");
            assert!(!parses(&held_out), "{unused}");
        }
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(parse_bytes("8GiB"), Ok(8 << 30));
        assert_eq!(parse_bytes("1.5kB"), Ok(1500));
        assert_eq!(parse_bytes("12"), Ok(12));
        assert!(
            parse_bytes("8GiX").is_err()
                && parse_bytes("-1GB").is_err()
                && parse_bytes("").is_err()
        );
    }

    #[test]
    fn shards_count_from_0() {
        assert_eq!(Shard::parse("0/3"), Ok(Shard { index: 0, count: 3 }));
        assert!(
            Shard::parse("3/3").is_err()
                && Shard::parse("a/3").is_err()
                && Shard::parse("1").is_err()
        );
    }
}
