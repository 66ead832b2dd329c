//! One instant of a scene, in the frame of its grid.

use std::borrow::Cow;

use nalgebra::Point3;

use crate::{
    AggregatedScene, BackgroundSweep, Box3, ClassId, GrownBox, ObjectSweep, Pose, Timestamp,
    TrackId,
};

/// Everything that stands in a grid at one instant: views of the scene's clouds, each with the pose
/// that brings it into the grid frame. Nothing is copied but what is cut.
///
/// What is occupied and what was hit are both read from here, so they cannot disagree.
#[derive(Clone, Debug)]
pub struct Instant<'a> {
    /// The keyframe's time.
    pub time: Timestamp,
    /// The world, in the grid frame.
    pub grid_from_world: Pose,
    /// Where the reference lidar stands, grid frame.
    pub reference_lidar: Point3<f64>,
    /// Background sweeps of the window, in order: whole, or cut to what is near enough.
    pub background: Vec<Cow<'a, BackgroundSweep<ClassId>>>,
    /// Object sweeps of the window, in order.
    pub objects: Vec<PlacedObject<'a>>,
    /// Tracks that stand at this instant.
    pub standing: Vec<StandingBox>,
}

/// The points of a track in one sweep, and where they belong now.
#[derive(Clone, Debug)]
pub struct PlacedObject<'a> {
    /// The points, in box coordinates.
    pub object: &'a ObjectSweep,
    /// Where the sweep saw their box.
    pub grid_from_seen_box: Pose,
    /// That box, grown.
    pub seen: GrownBox,
    /// Where the track stands at this instant; `None` if it is absent.
    pub grid_from_box: Option<Pose>,
}

/// A track that stands at this instant.
#[derive(Clone, Debug)]
pub struct StandingBox {
    /// Which track.
    pub track: TrackId,
    /// Its box now.
    pub boxed: Box3,
    /// Its box, grown as for splitting sweeps.
    pub grown: GrownBox,
    /// Where it stands in the grid frame.
    pub grid_from_box: Pose,
}

impl<'a> Instant<'a> {
    /// How many points of the window serve this instant, each with its ray.
    pub fn ray_count(&self) -> u64 {
        let background: usize = self.background.iter().map(|sweep| sweep.cloud.len()).sum();
        let objects: usize = self.objects.iter().map(|placed| placed.object.cloud.len()).sum();
        (background + objects) as u64
    }

    /// The same without the points of some tracks.
    pub fn without(&self, tracks: &[TrackId]) -> Self {
        let mut rest = self.clone();
        rest.objects.retain(|placed| !tracks.contains(&placed.object.track));
        rest
    }

    /// The instant of a whole scene in which nothing moves, its grid being world: for tests and
    /// examples.
    pub fn still(scene: &'a AggregatedScene<ClassId>) -> Self {
        Self {
            time: Timestamp::default(),
            grid_from_world: Pose::identity(),
            reference_lidar: Point3::origin(),
            background: scene.background.iter().map(Cow::Borrowed).collect(),
            objects: Vec::new(),
            standing: Vec::new(),
        }
    }
}
