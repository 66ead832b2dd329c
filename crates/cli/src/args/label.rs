//! The lines of `label` and `plan`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{ConfigArgs, LogArgs};

/// What is to be labelled, and with what: all that decides the work, and what it costs.
#[derive(Debug, Args)]
pub(crate) struct WorkArgs {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(flatten)]
    pub(crate) config: ConfigArgs,
    /// Write only these keyframes; what is aggregated stays the same.
    #[arg(long, value_delimiter = ',', value_name = "TOKEN,...")]
    pub(crate) keyframes: Vec<String>,
    /// Write `evidence.npz` beside `labels.npz`.
    #[arg(long, conflicts_with = "dialect")]
    pub(crate) evidence: bool,
    /// Write the files of a dialect, in its published grid, instead of our own.
    #[arg(long, value_name = "NAME")]
    pub(crate) dialect: Option<String>,
    /// Further grids of the same aggregation: voxel sizes in metres to pool the labels into, dialects
    /// to write in their grids, files with a `[grid]` to label in.
    #[arg(long, value_delimiter = ',', value_name = "SIZE|DIALECT|FILE,...")]
    pub(crate) also: Vec<String>,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Memory to stay under, as 8GiB or 500MB.
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes)]
    pub(crate) memory: Option<u64>,
    /// What to do with a record, sweep, keyframe or scene that cannot be used.
    #[arg(long, value_enum, default_value_t = OnError::Fail)]
    pub(crate) on_error: OnError,
    /// Label although listed sweep files are absent.
    #[arg(long)]
    pub(crate) allow_missing_sweeps: bool,
}

#[derive(Debug, Args)]
pub(crate) struct LabelArgs {
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// Where the label tree goes.
    #[arg(long)]
    pub(crate) output: PathBuf,
    /// Only every N-th scene, counted from the I-th: a share of a larger run, I from 0.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// What to do with the keyframes that an earlier run finished.
    #[arg(long, value_enum, default_value_t = ResumeArg::IfSame)]
    pub(crate) resume: ResumeArg,
    /// Label these keyframes again although an earlier run finished them: SCENE/TOKEN a line, as
    /// `verify --redo-list` writes them.
    #[arg(long, value_name = "FILE")]
    pub(crate) redo: Option<PathBuf>,
    /// Show scenes, keyframes, rays and bytes; write nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// How progress is shown on stderr.
    #[arg(long, value_enum, default_value_t = ProgressArg::Auto)]
    pub(crate) progress: ProgressArg,
}

#[derive(Debug, Args)]
pub(crate) struct PlanArgs {
    #[command(flatten)]
    pub(crate) work: WorkArgs,
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

#[cfg(test)]
mod tests {
    use super::*;

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
