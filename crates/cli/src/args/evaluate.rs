//! The line of `evaluate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// The label set that is true.
    #[arg(long, value_name = "DIR")]
    pub(crate) truth: PathBuf,
    /// The label set that is scored: its keyframes are found by scene and token, or by token alone
    /// where its files name no scene, as in a challenge's submission.
    #[arg(long, value_name = "DIR")]
    pub(crate) prediction: PathBuf,
    /// The truth's dialect, where its manifest does not tell.
    #[arg(long, value_name = "DIALECT")]
    pub(crate) truth_dialect: Option<String>,
    /// The prediction's dialect, where its manifest does not tell.
    #[arg(long, value_name = "DIALECT")]
    pub(crate) prediction_dialect: Option<String>,
    /// Which of the truth's masks says where to ask. [default: camera, else lidar, else none:
    /// whichever the truth has]
    #[arg(long, value_enum)]
    pub(crate) mask: Option<MaskArg>,
    /// Which scores to take; `all` leaves out what the files cannot tell.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "miou")]
    pub(crate) metrics: Vec<MetricArg>,
    /// Origins of rays by keyframe, JSON: {"TOKEN": [[x, y, z], ...]}, metres in the grid frame.
    /// [default: the lidar's, as the manifest of the truth tells]
    #[arg(long, value_name = "FILE")]
    pub(crate) ray_origins: Option<PathBuf>,
    /// A table of scenes for a breakdown: `scene`, then any attributes, between tabs.
    #[arg(long, value_name = "FILE")]
    pub(crate) attributes: Option<PathBuf>,
    /// Break down by distance: outer radii, metres. [without radii: 10,20,30,40]
    #[arg(long, value_name = "METRES", value_delimiter = ',', num_args = 0..)]
    #[arg(default_missing_value = "10,20,30,40")]
    pub(crate) rings: Vec<f64>,
    /// These scenes only.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,
    /// Score what is there where predictions are missing; exit 3.
    #[arg(long)]
    pub(crate) allow_missing: bool,
    /// Classes whose instances are told apart. [default: vehicles, people, riders]
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    pub(crate) things: Option<Vec<String>>,
    /// Classes whose velocity is asked for. [default: vehicles, people, riders]
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    pub(crate) flow_classes: Option<Vec<String>>,
    /// Centres nearer than this meet, for the F-score. SurroundOcc: 0.5.
    #[arg(long, value_name = "METRES", default_value_t = 0.6)]
    pub(crate) f_threshold_m: f64,
    /// Centres of objects up to this far apart are one detection, for AVE-D.
    #[arg(long, value_name = "METRES", default_value_t = 2.0)]
    pub(crate) detection_m: f64,
    /// Segments of fewer voxels count as neither missed nor spurious.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) min_segment_voxels: u64,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) jobs: Option<u16>,
    /// Print one JSON object instead of the table.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MaskArg {
    /// What some camera sees.
    Camera,
    /// What the lidars observed; of SemanticKITTI what is not invalid.
    Lidar,
    /// Everything.
    None,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MetricArg {
    /// mIoU and all else that the confusion of classes gives.
    Miou,
    /// F-score and chamfer distance.
    Fscore,
    /// PQ, SQ, RQ.
    Panoptic,
    /// AVE-T, AVE-O, AVE-D.
    Velocity,
    /// RayIoU.
    Rayiou,
    /// RayIoU and RayPQ.
    Raypq,
    /// RayIoU, AVE along rays, and the score of the challenge of 2024.
    Rayflow,
    /// All that the files can tell.
    All,
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use crate::args::{Cli, Command};

    fn rings(more: &str) -> Vec<f64> {
        let line = format!("occlabel evaluate --truth a --prediction b{more}");
        match Cli::try_parse_from(line.split(' ')).expect("a good line").command {
            Command::Evaluate(args) => args.rings,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn rings_have_radii_of_their_own_or_the_usual_ones() {
        assert_eq!(rings(""), [0.0; 0]);
        assert_eq!(rings(" --rings --json"), [10.0, 20.0, 30.0, 40.0]);
        assert_eq!(rings(" --rings 5,7.5"), [5.0, 7.5]);
    }
}
