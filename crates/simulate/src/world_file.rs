//! A world as its TOML file says it; unknown keys are errors.

use std::sync::Arc;

use nalgebra::{Translation3, Vector3};
use occlabel_core::{Fault, Pose};
use serde::Deserialize;

use crate::annotator::Annotator;
use crate::camera::CameraFile;
use crate::check::{angles, each, inside, lengths, metres, need, within};
use crate::ego::Ego;
use crate::ground::Ground;
use crate::lidar::LidarFile;
use crate::mover::{Mover, Part, Path, Pivot};
use crate::reconstruction::Reconstruction;
use crate::repeat::RepeatWay;
use crate::rotation::PoseFile;
use crate::shape::{Shape, ShapeFile};
use crate::standing::StaticFile;
use crate::swing::Swing;
use crate::towed::{Lengths, Towed};
use crate::trajectory::Trajectory;

/// So many trailers one thing draws in a row at most.
const MOST_TRAILERS: f64 = 8.0;

/// The whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WorldFile {
    pub(crate) name: String,
    pub(crate) duration_s: f64,
    #[serde(default)]
    pub(crate) seed: u64,
    pub(crate) taxonomy: String,
    pub(crate) keyframe_hz: f64,
    pub(crate) ground: Ground,
    pub(crate) ego: Ego,
    #[serde(default, rename = "static")]
    pub(crate) statics: Vec<StaticFile>,
    #[serde(default, rename = "mover")]
    pub(crate) movers: Vec<MoverFile>,
    #[serde(rename = "lidar")]
    pub(crate) lidars: Vec<LidarFile>,
    #[serde(default, rename = "camera")]
    pub(crate) cameras: Vec<CameraFile>,
    #[serde(default)]
    pub(crate) annotator: Annotator,
    #[serde(default)]
    pub(crate) reconstruction: Reconstruction,
}

/// Something with a box annotation: `[[mover]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MoverFile {
    name: String,
    category: String,
    size_m: [f64; 3],
    #[serde(default)]
    lift_m: f64,
    /// Its parts; left out: a solid of its box's size.
    #[serde(default, rename = "part")]
    parts: Vec<PartFile>,
    trajectory: Option<Trajectory>,
    towed: Option<TowedFile>,
    /// Added to the phase of all its pivots, so that not all people walk in step.
    #[serde(default)]
    phase_rad: f64,
    repeat: Option<RepeatWay>,
}

/// A rigid piece of a mover: `[[mover.part]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartFile {
    shape: ShapeFile,
    #[serde(default)]
    pose: PoseFile,
    pivot: Option<PivotFile>,
}

/// A hinge along the mover's y axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PivotFile {
    at_m: [f64; 3],
    pitch_rad: Swing,
}

/// What draws a trailer: a mover that stands earlier in the file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TowedFile {
    by: String,
    hitch_m: f64,
    axle_m: f64,
    centre_m: f64,
}

impl MoverFile {
    /// The mover as often as it is repeated.
    pub(crate) fn copies(self) -> Result<Vec<Self>, Fault> {
        let Some(repeat) = self.repeat else { return Ok(vec![self]) };
        repeat.check()?;
        need("repeat", self.towed.is_none(), "a way of its own to repeat", "`towed`")?;
        let copy = |number| Self {
            name: repeat.name(&self.name, number),
            trajectory: self.trajectory.as_ref().map(|way| way.shifted(repeat.offset_m(number))),
            ..self.clone()
        };
        Ok((0..repeat.count).map(copy).collect())
    }

    /// The mover, given those that stand before it in the file and how long its way must be known.
    pub(crate) fn build(self, earlier: &[Mover], until_s: f64) -> Result<Mover, Fault> {
        lengths("size_m", &self.size_m)?;
        metres("lift_m", &[self.lift_m])?;
        angles("phase_rad", &[self.phase_rad])?;
        let path = path(self.trajectory, self.towed, earlier, until_s)?;
        let parts = match self.parts.is_empty() {
            true => vec![PartFile {
                shape: ShapeFile::Box { size_m: self.size_m },
                pose: PoseFile::default(),
                pivot: None,
            }],
            false => self.parts,
        };
        Ok(Mover {
            name: self.name,
            category: self.category,
            size_m: Vector3::from(self.size_m),
            lift_m: self.lift_m,
            parts: each("part", parts, |part| part.build(self.phase_rad))?,
            path,
        })
    }
}

impl PartFile {
    fn build(self, phase_rad: f64) -> Result<Part, Fault> {
        let pivot = self.pivot.map(|pivot| inside("pivot", pivot.build(phase_rad))).transpose()?;
        Ok(Part {
            shape: Arc::new(inside("shape", self.shape.try_into())?),
            mover_from_part: inside("pose", self.pose.try_into())?,
            pivot,
        })
    }
}

impl PivotFile {
    fn build(self, phase_rad: f64) -> Result<Pivot, Fault> {
        metres("at_m", &self.at_m)?;
        inside("pitch_rad", self.pitch_rad.check())?;
        let own = self.pitch_rad;
        let pitch = Swing { phase_rad: own.phase_rad + phase_rad, ..own };
        Ok(Pivot { at_m: Vector3::from(self.at_m), pitch })
    }
}

fn path(
    own: Option<Trajectory>,
    towed: Option<TowedFile>,
    earlier: &[Mover],
    until_s: f64,
) -> Result<Path, Fault> {
    match (own, towed) {
        (Some(trajectory), None) => {
            inside("trajectory", trajectory.check())?;
            Ok(Path::Own(trajectory))
        }
        (None, Some(towed)) => inside("towed", towed.build(earlier, until_s)).map(Path::Towed),
        (own, _) => {
            let found = if own.is_some() { "both" } else { "neither" };
            Err(Fault::new("world", "trajectory", "either it or `towed`", found))
        }
    }
}

impl TowedFile {
    fn build(self, earlier: &[Mover], until_s: f64) -> Result<Towed, Fault> {
        let tower = earlier.iter().find(|mover| mover.name == self.by);
        let Some(tower) = tower else {
            return Err(Fault::new("world", "by", "a mover earlier in the file", self.by));
        };
        within("by, trailers in a row", tower.path.trailers() as f64 + 1.0, 1.0, MOST_TRAILERS)?;
        metres("hitch_m", &[self.hitch_m])?;
        lengths("axle_m", &[self.axle_m])?;
        metres("centre_m", &[self.centre_m])?;
        let (hitch_m, axle_m, centre_m) = (self.hitch_m, self.axle_m, self.centre_m);
        let lengths = Lengths { hitch_m, axle_m, centre_m };
        Ok(Towed::new(Arc::new(tower.path.clone()), lengths, until_s))
    }
}

/// The ego's own body as a shape, and where it stands in the ego frame.
pub(crate) fn ego_body(ego: &Ego) -> Result<Option<(Arc<Shape>, Pose)>, Fault> {
    let Some(body) = &ego.body else { return Ok(None) };
    let (min, max) = (Vector3::from(body.min_m), Vector3::from(body.max_m));
    let shape = Shape::try_from(ShapeFile::Box { size_m: (max - min).into() })?;
    let centre = Pose::from_parts(Translation3::from((min + max) / 2.0), nalgebra::one());
    Ok(Some((Arc::new(shape), centre)))
}
