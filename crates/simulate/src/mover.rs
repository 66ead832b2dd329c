//! Things that move: their parts, and how they stand at a time.

use std::sync::Arc;

use nalgebra::{Translation3, Vector3};
use occlabel_core::{Box3, Pose};

use crate::Shape;
use crate::ground::Ground;
use crate::rotation::yaw_pitch_roll;
use crate::swing::Swing;
use crate::towed::Towed;
use crate::trajectory::{Place, Trajectory};

/// A thing with a box annotation.
///
/// Its own frame is that of its box: origin at the box's centre, x forward, y left, z up.
#[derive(Clone, Debug)]
pub struct Mover {
    /// The track's source id.
    pub name: String,
    /// Box category and raw point label.
    pub category: String,
    /// Length, width, height of the annotated box, metres.
    pub size_m: Vector3<f64>,
    /// How far the box's bottom stands above the terrain (kerbs not counted in), metres.
    pub lift_m: f64,
    pub(crate) parts: Vec<Part>,
    pub(crate) path: Path,
}

/// A rigid piece of a mover.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) shape: Arc<Shape>,
    pub(crate) mover_from_part: Pose,
    pub(crate) pivot: Option<Pivot>,
}

/// A hinge along y about which a part swings, as a leg does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivot {
    pub(crate) at_m: Vector3<f64>,
    pub(crate) pitch: Swing,
}

/// How a mover goes.
#[derive(Clone, Debug)]
pub(crate) enum Path {
    Own(Trajectory),
    Towed(Towed),
}

impl Path {
    pub(crate) fn at(&self, time_s: f64) -> Place {
        match self {
            Self::Own(trajectory) => trajectory.at(time_s),
            Self::Towed(towed) => towed.at(time_s),
        }
    }

    /// How many trailers there are from the one that drives itself to this one.
    pub(crate) fn trailers(&self) -> usize {
        match self {
            Self::Own(_) => 0,
            Self::Towed(towed) => towed.trailers(),
        }
    }
}

impl Mover {
    /// Where it is on the map.
    pub fn place(&self, time_s: f64) -> Place {
        self.path.at(time_s)
    }

    /// Its true box at a time.
    pub fn box_at(&self, time_s: f64, ground: &Ground) -> Box3 {
        let footing = ground.stand(&self.place(time_s), [self.size_m.x / 2.0, self.size_m.y / 2.0]);
        let centre_m = self.lift_m + self.size_m.z / 2.0;
        let world_from_box = footing * Translation3::new(0.0, 0.0, centre_m);
        Box3 { world_from_box, size_m: self.size_m }
    }
}

impl Part {
    /// Where the part stands in its mover's frame.
    pub(crate) fn mover_from_part(&self, time_s: f64) -> Pose {
        let Some(pivot) = &self.pivot else { return self.mover_from_part };
        let hinge = Translation3::from(pivot.at_m);
        hinge
            * yaw_pitch_roll(0.0, pivot.pitch.at(time_s), 0.0)
            * hinge.inverse()
            * self.mover_from_part
    }
}
