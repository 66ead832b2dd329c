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

#[cfg(test)]
mod tests {
    use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};

    use crate::{WORLDS, World};

    /// What is farther apart does not touch, metres.
    const TOUCH_M: f64 = 0.03;

    /// Whether some point below the bounds lies in the ground.
    fn is_grounded(world: &World, bounds: &Aabb) -> bool {
        let (low, high) = (bounds.mins, bounds.maxs);
        let share = |at: i32| f64::from(at) / 10.0;
        (0..=10).flat_map(|i| (0..=10).map(move |j| [share(i), share(j)])).any(|[i, j]| {
            let (x, y) = (low.x + i * (high.x - low.x), low.y + j * (high.y - low.y));
            world.ground.surface_m(x, y) > low.z - TOUCH_M
        })
    }

    /// Bounds that stand on the ground or, over others, on those that do.
    fn held(world: &World, all: &[Aabb]) -> Vec<bool> {
        let mut held: Vec<bool> = all.iter().map(|bounds| is_grounded(world, bounds)).collect();
        let mut growing = true;
        while growing {
            growing = false;
            for at in 0..all.len() {
                let near = all[at].loosened(TOUCH_M);
                if !held[at] && (0..all.len()).any(|on| held[on] && near.intersects(&all[on])) {
                    (held[at], growing) = (true, true);
                }
            }
        }
        held
    }

    #[test]
    fn nothing_that_stands_in_a_shipped_world_floats() {
        let mut count = 0;
        for shipped in WORLDS {
            let world = World::parse(shipped.text, shipped.name).unwrap();
            let all = world.standing.bounds();
            let floating = held(&world, &all).iter().position(|held| !held);
            assert_eq!(floating.map(|at| all[at]), None, "{}", shipped.name);
            count += all.len();
        }
        assert!(count > 500, "{count}");
    }

    #[test]
    fn copies_stand_on_the_slope_and_on_the_kerb() {
        let posts = r#"
            [[static]]
            class = "pole"
            pose.position_m = [10.0, 3.0, 0.5]
            shape.box.size_m = [0.1, 0.1, 1.0]
            on_ground = true
            repeat = { count = 3, step_m = [20.0, 1.0, 0.0] }
            [ground]
            slope = [0.1, 0.0]
            bands = [{ until_y_m = 3.5, class = "road" }, { class = "sidewalk", raise_m = 0.2 }]
        "#;
        #[derive(serde::Deserialize)]
        struct File {
            ground: crate::Ground,
            r#static: Vec<super::StaticFile>,
        }
        let file: File = toml::from_str(posts).unwrap();
        let (bodies, classes) = super::standing(&file.r#static, &file.ground).unwrap();
        let feet: Vec<f64> = bodies.bounds().iter().map(|bounds| bounds.mins.z).collect();
        for (found, expected) in feet.iter().zip([1.0, 3.2, 5.2]) {
            assert!((found - expected).abs() < 1e-5, "{feet:?}");
        }
        assert_eq!(classes, ["pole"; 3]);
    }
}
