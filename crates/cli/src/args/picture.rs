//! The flags of `view` that say what a .png shows.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// What a .png shows. Each picture takes a few of these flags and refuses the others.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures (.png)")]
pub(crate) struct PictureArgs {
    /// Which picture a .png is. [default: sheet]
    #[arg(long, value_enum, value_name = "KIND")]
    pub(crate) picture: Option<PictureArg>,
    /// Its width and height in pixels. [default: 1600x900]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<(u32, u32)>,
    /// Seen by this camera of the log (perspective, overlay).
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// From which side: 0 from ahead, 90 from the left, 180 from behind (sheet, perspective,
    /// difference). [default: 200]
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub(crate) azimuth_deg: Option<f64>,
    /// From how high: 0 level, 90 from straight above. [default: 35, beside a map 50]
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true)]
    pub(crate) elevation_deg: Option<f64>,
    /// From how far from the grid's middle. [default: so that the grid fills the picture]
    #[arg(long, value_name = "M", value_parser = distance)]
    pub(crate) distance_m: Option<f64>,
    /// Through which axis slices cut. [default: z]
    #[arg(long, value_enum, value_name = "AXIS")]
    pub(crate) across: Option<AcrossArg>,
    /// The other labels of the same keyframes, shown as they differ from DIR (difference).
    #[arg(long, value_name = "DIR")]
    pub(crate) against: Option<PathBuf>,
    /// The dialect of those, where they do not tell themselves.
    #[arg(long, value_name = "NAME", requires = "against")]
    pub(crate) against_dialect: Option<String>,
}

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureArg {
    /// From above, and beside it as cubes.
    Sheet,
    /// From above: the class of the topmost occupied voxel.
    BirdsEye,
    /// Occupied voxels as lit cubes.
    Perspective,
    /// Over the images of the log's cameras.
    Overlay,
    /// Every level of the grid.
    Slices,
    /// The keyframes of the scene from above, side by side.
    Strip,
    /// Where two label sets differ.
    Difference,
}

/// An axis of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AcrossArg {
    /// Upright cuts from back to front.
    X,
    /// Upright cuts from right to left.
    Y,
    /// Levels.
    Z,
}

const LEAST_PX: u32 = 16;
/// Both a bound on memory, and the most that viewers take.
const MOST_PX: u32 = 16_384;

fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |side: &str| side.parse().ok().filter(|px| (LEAST_PX..=MOST_PX).contains(px));
    let sides = text.split_once('x').and_then(|(w, h)| Some((side(w)?, side(h)?)));
    sides.ok_or_else(|| format!("expected WxH such as 1600x900, each from {LEAST_PX} to {MOST_PX}"))
}

fn degrees(text: &str) -> Result<f64, String> {
    let angle = text.parse().ok().filter(|degrees: &f64| degrees.abs() <= 360.0);
    angle.ok_or_else(|| "expected degrees from -360 to 360".to_owned())
}

fn distance(text: &str) -> Result<f64, String> {
    let distance = text.parse().ok().filter(|m| (0.1..=100_000.0).contains(m));
    distance.ok_or_else(|| "expected metres from 0.1 to 100000".to_owned())
}
