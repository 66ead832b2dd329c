//! A scene: what one drive recorded, in our own terms.

use nalgebra::Point3;

use crate::{BoxTrack, Camera, Fault, PointCloud, PointLabel, Pose, Timestamp, TrackId};

/// One revolution of one lidar, without its points.
#[derive(Clone, Debug)]
pub struct SweepHeader {
    /// When it was taken.
    pub time: Timestamp,
    /// The lidar's name.
    pub lidar: String,
    /// The format's own id of the sweep.
    pub source_id: String,
    /// The file that holds the points, relative to the log's root.
    pub file: String,
    /// The ego vehicle's pose at that time.
    pub world_from_ego: Pose,
    /// The lidar's mounting.
    pub ego_from_lidar: Pose,
    /// Whether the points carry labels.
    pub labelled: bool,
    /// What its points are points of.
    pub points_of: PointsOf,
}

/// What the points of a sweep are points of.
///
/// A lidar's are of its moment. Logs of reconstructions have clouds of no time instead: they serve
/// every keyframe, and no lidar looked along a ray at them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointsOf {
    /// Whatever was there at the sweep's time: the boxes of that time sort them.
    #[default]
    Moment,
    /// Nothing: the sweep tells a pose alone.
    Nothing,
    /// What stands still at all times; the sweep's frame is world.
    World,
    /// A track at all times; the sweep's frame is the box of that track, whenever it stands.
    Track(TrackId),
}

impl PointsOf {
    /// Whether the points are of no time.
    pub fn is_timeless(self) -> bool {
        matches!(self, Self::World | Self::Track(_))
    }
}

impl SweepHeader {
    /// The lidar's own pose in world at the sweep's time.
    pub fn world_from_lidar(&self) -> Pose {
        self.world_from_ego * self.ego_from_lidar
    }
}

/// One revolution of one lidar. The cloud stands in the lidar's frame.
#[derive(Clone, Debug)]
pub struct Sweep<'a> {
    /// Its time and poses.
    pub header: &'a SweepHeader,
    /// Its points, with their ray origins.
    pub cloud: PointCloud<PointLabel>,
}

/// What a camera saw once.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// Index into the scene's cameras.
    pub camera: usize,
    /// When it was exposed.
    pub time: Timestamp,
    /// Where the camera stood then.
    pub world_from_camera: Pose,
    /// The image's file, relative to the log's root, where the log has images as files of their own;
    /// the file may be absent.
    pub image: Option<String>,
}

/// A moment that gets a grid of labels.
#[derive(Clone, Debug)]
pub struct Keyframe {
    /// The name of its output folder.
    pub token: String,
    /// The reference sweep's time.
    pub time: Timestamp,
    /// Index of the reference sweep.
    pub sweep: usize,
    /// At most one exposure of each camera, in order of cameras.
    pub exposures: Vec<Exposure>,
}

/// A camera of a scene, under the name of its channel.
#[derive(Clone, Debug)]
pub struct NamedCamera {
    /// The channel.
    pub name: String,
    /// Its model, size and masks.
    pub camera: Camera,
}

/// One drive: the unit of work and of failure.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Its name.
    pub name: String,
    /// Sweeps ordered by (time, lidar name, file).
    pub sweeps: Vec<SweepHeader>,
    /// Tracks in order of their ids 1..N.
    pub tracks: Vec<BoxTrack>,
    /// Cameras in byte order of their names: bit i of `camera_bits` is the i-th.
    pub cameras: Vec<NamedCamera>,
    /// Keyframes in order of time.
    pub keyframes: Vec<Keyframe>,
    /// Of each camera everything that it saw, in order of time, between keyframes too. What cannot be
    /// used is left out.
    pub exposures: Vec<Vec<Exposure>>,
    /// What is odd but can be lived with.
    pub warnings: Vec<Fault>,
    /// Records that were refused and left out.
    pub refused: Vec<Refusal>,
}

/// A part of a scene that could not be read, and why.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// What is lost by it.
    pub loss: Loss,
    /// What was wrong.
    pub fault: Fault,
}

/// What a refusal costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// One annotated box.
    Annotation,
    /// One sweep.
    Sweep,
    /// One keyframe.
    Keyframe,
    /// One camera's image at a keyframe, or the camera.
    Camera,
    /// What stands behind the place where a file is broken: it was asked to be read so.
    Remainder,
    /// What a record says of its neighbours in time: the order of times takes its place.
    Link,
}

impl Scene {
    /// Whether any sweep carries point labels.
    pub fn has_point_labels(&self) -> bool {
        self.sweeps.iter().any(|sweep| sweep.labelled)
    }

    /// Whether some points are of no time, which no rays led to.
    pub fn has_timeless_points(&self) -> bool {
        self.sweeps.iter().any(|sweep| sweep.points_of.is_timeless())
    }

    /// The sweep whose pose places a keyframe's grid, and whose time is the keyframe's.
    pub fn reference_sweep(&self, keyframe: &Keyframe) -> &SweepHeader {
        &self.sweeps[keyframe.sweep]
    }
}

/// The origin of rays whose lidar says nothing better: the lidar's own.
pub const LIDAR_ORIGIN: Point3<f64> = Point3::new(0.0, 0.0, 0.0);
