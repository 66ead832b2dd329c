//! What stands: the `[[static]]` entries of a world.

use std::sync::Arc;

use nalgebra::Translation3;
use occlabel_core::{Fault, Pose};
use serde::Deserialize;

use crate::bodies::{Bodies, Body};
use crate::check::{inside, need};
use crate::ground::Ground;
use crate::instant::What;
use crate::repeat::Repeat;
use crate::rotation::PoseFile;
use crate::shape::{Shape, ShapeFile};

/// Something that stands: `[[static]]`, one shape of one class or several parts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StaticFile {
    class: Option<String>,
    shape: Option<ShapeFile>,
    /// Its parts, if it is not one shape of one class.
    #[serde(default, rename = "part")]
    parts: Vec<PieceFile>,
    #[serde(default)]
    pose: PoseFile,
    /// Whether the pose's z counts from the ground's surface at its x and y.
    #[serde(default)]
    on_ground: bool,
    repeat: Option<Repeat>,
}

/// A piece of something that stands: `[[static.part]]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PieceFile {
    class: String,
    shape: ShapeFile,
    #[serde(default)]
    pose: PoseFile,
}

/// A piece, built.
struct Piece<'f> {
    class: &'f str,
    shape: Arc<Shape>,
    thing_from_piece: Pose,
}

/// All that stands, and the class of each shape in the order of their numbers.
pub(crate) fn standing(
    things: &[StaticFile],
    ground: &Ground,
) -> Result<(Bodies, Vec<String>), Fault> {
    let (mut bodies, mut classes) = (Vec::new(), Vec::new());
    for (at, thing) in things.iter().enumerate() {
        let key = format!("static[{at}]");
        let (pieces, poses) = inside(&key, thing.build(ground))?;
        for (world_from_thing, piece) in
            poses.iter().flat_map(|pose| pieces.iter().map(move |piece| (pose, piece)))
        {
            let pose = world_from_thing * piece.thing_from_piece;
            bodies.push(Body::new(piece.shape.clone(), pose, What::Static(classes.len())));
            classes.push(piece.class.to_owned());
        }
    }
    Ok((Bodies::new(bodies), classes))
}

impl StaticFile {
    /// Its pieces, and where it and its copies stand.
    fn build(&self, ground: &Ground) -> Result<(Vec<Piece<'_>>, Vec<Pose>), Fault> {
        let first: Pose = inside("pose", self.pose.try_into())?;
        let mut poses = vec![first];
        if let Some(repeat) = self.repeat {
            repeat.check()?;
            poses = (0..repeat.count).map(|number| repeat.pose(&first, number)).collect();
        }
        if self.on_ground {
            poses.iter_mut().for_each(|pose| set_on(pose, ground));
        }
        Ok((self.pieces()?, poses))
    }

    fn pieces(&self) -> Result<Vec<Piece<'_>>, Fault> {
        match (&self.class, &self.shape) {
            (Some(class), Some(shape)) if self.parts.is_empty() => {
                let shape = Arc::new(inside("shape", shape.clone().try_into())?);
                Ok(vec![Piece { class, shape, thing_from_piece: nalgebra::one() }])
            }
            (class, shape) => {
                let only = class.is_none() && shape.is_none() && !self.parts.is_empty();
                need("shape", only, "either it and `class`, or `part`", "neither or both")?;
                crate::check::each("part", &self.parts, PieceFile::build)
            }
        }
    }
}

impl PieceFile {
    fn build(&self) -> Result<Piece<'_>, Fault> {
        Ok(Piece {
            class: &self.class,
            shape: Arc::new(inside("shape", self.shape.clone().try_into())?),
            thing_from_piece: inside("pose", self.pose.try_into())?,
        })
    }
}

fn set_on(pose: &mut Pose, ground: &Ground) {
    let foot = pose.translation;
    pose.translation = foot * Translation3::new(0.0, 0.0, ground.surface_m(foot.x, foot.y));
}
