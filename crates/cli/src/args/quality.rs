//! The line of `quality`.

use std::path::PathBuf;

use clap::Args;

use super::{ConfigArgs, LogArgs};

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
    #[arg(requires_all = ["format", "input"])]
    #[arg(required_unless_present_any = ["world_truth", "painted"])]
    pub(crate) held_out: Option<u16>,
    /// Compare the classes that masks of images give labelled points with the points' labels.
    #[arg(long, requires_all = ["format", "input"])]
    #[arg(conflicts_with_all = ["world_truth", "held_out", "trees"])]
    pub(crate) painted: bool,
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

/// Metres of noise: 0 or more.
fn parse_noise(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(metres) if metres.is_finite() && metres >= 0.0 => Ok(metres),
        _ => Err(format!("expected metres, 0 or more, found `{text}`")),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use crate::args::Cli;

    #[test]
    fn quality_refuses_what_it_would_not_use() {
        let parses = |more: &str| {
            let line = format!("occlabel quality {more}");
            Cli::try_parse_from(line.split(' ')).is_ok()
        };
        assert!(parses("tree --world-truth log --quick --json --jobs 2"));
        assert!(parses("--held-out 5 --format nuscenes --input log --preset paper"));
        assert!(parses("--painted --format mcap --input log --set paint.masks=masks --json"));
        assert!(
            !parses("--painted --format mcap --input log --held-out 5") && !parses("--painted")
        );
        for unused in ["--preset paper", "--set a.b=1", "--range-noise-m 0.5", "--input log"] {
            assert!(!parses(&format!("tree --world-truth log {unused}")), "{unused}");
        }
        for unused in ["tree", "--quick", "--limits precise", "--world-truth log"] {
            let held_out = format!("--held-out 5 --format nuscenes --input log {unused}");
            assert!(!parses(&held_out), "{unused}");
        }
    }
}
