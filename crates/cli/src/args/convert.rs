//! The line of `convert`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(
    after_help = "Labels keep their grid: nothing is resampled. What is lost is printed, and \
    stands in the manifest.\nExit codes: 0 complete, 1 failed, 2 usage, 130 interrupted."
)]
pub(crate) struct ConvertArgs {
    /// The labels to convert: a folder.
    #[arg(value_name = "DIR")]
    pub(crate) input: PathBuf,
    /// The dialect to write.
    #[arg(long, value_name = "DIALECT")]
    pub(crate) to: String,
    /// The dialect to read. [default: the one that the folder tells]
    #[arg(long, value_name = "DIALECT")]
    pub(crate) from: Option<String>,
    /// Where the converted labels go: an empty folder, or one that this command left.
    #[arg(long)]
    pub(crate) output: PathBuf,
    /// A class becomes this class of the other dialect, `free` or `ignored`: bus=truck.
    #[arg(long, value_name = "CLASS=CLASS", value_parser = parse_pair)]
    pub(crate) map: Vec<(String, String)>,
    /// Only these scenes.
    #[arg(long, value_delimiter = ',', value_name = "NAME,...")]
    pub(crate) scenes: Vec<String>,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print one JSON object.
    #[arg(long)]
    pub(crate) json: bool,
}

fn parse_pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((from, to)) if !from.is_empty() && !to.is_empty() => {
            Ok((from.to_owned(), to.to_owned()))
        }
        _ => Err(format!("expected CLASS=CLASS, found `{text}`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_of_classes_has_two_names() {
        let pair = ("traffic light".to_owned(), "others".to_owned());
        assert_eq!(parse_pair("traffic light=others"), Ok(pair));
        assert!(["bus", "=car", "bus="].iter().all(|text| parse_pair(text).is_err()));
    }
}
