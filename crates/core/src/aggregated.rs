//! A whole scene's points, sorted into world and boxes.

use nalgebra::Point3;

use crate::{Body, Box3, Brush, Bundles, ClassId, PointCloud, Timestamp, TrackId};

/// A scene's points: what stands in the world, and what moves with a track; and bodies beside them.
///
/// `L` is `Option<ClassId>` until the background is relabelled, then [`ClassId`].
#[derive(Clone, Debug)]
pub struct AggregatedScene<L> {
    /// One cloud a sweep, in world coordinates.
    pub background: Vec<BackgroundSweep<L>>,
    /// One cloud for each track in each sweep that has points in its box.
    pub objects: Vec<ObjectSweep>,
    /// Who is known by their surface, in order of time and track.
    pub bodies: Vec<Body>,
    /// What was left out.
    pub dropped: DropCounts,
    /// Where the classes of its points come from; zero until the background is relabelled.
    pub class_from: ClassCounts,
}

/// The background points of one sweep. World coordinates.
#[derive(Clone, Debug)]
pub struct BackgroundSweep<L> {
    /// The sweep's time; none if its points are of no time and serve every keyframe.
    pub time: Option<Timestamp>,
    /// Its points.
    pub cloud: PointCloud<L>,
    /// Boxes around neighbouring points.
    pub bundles: Bundles,
    /// What masks say of each point; empty if they say nothing of any.
    pub brushes: Vec<Brush>,
}

impl<L> BackgroundSweep<L> {
    /// A sweep of points in world coordinates. The more neighbours stand beside each other, the
    /// faster they are worked on.
    pub fn new(time: impl Into<Option<Timestamp>>, cloud: PointCloud<L>) -> Self {
        let bundles = Bundles::of(&cloud);
        Self { time: time.into(), cloud, bundles, brushes: Vec::new() }
    }
}

/// The points of one track in one sweep. Box coordinates of that moment, ray origins too.
#[derive(Clone, Debug)]
pub struct ObjectSweep {
    /// Whose points these are.
    pub track: TrackId,
    /// The sweep's time; none if its points are of no time and serve every keyframe.
    pub time: Option<Timestamp>,
    /// The box at that time, as annotated, interpolated or extrapolated; the first one if there is none.
    pub boxed: Box3,
    /// The points, each labelled with the track's class.
    pub cloud: PointCloud<ClassId>,
}

/// How many points were dropped, and why. A dropped point's whole ray is dropped with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DropCounts {
    /// A coordinate that is no finite number.
    pub not_finite: u64,
    /// Exactly at the ray's origin.
    pub at_origin: u64,
    /// Inside the ego volume.
    pub ego: u64,
    /// Farther than `max_range_m`.
    pub far: u64,
    /// Its raw label means `ignore`.
    pub ignored_label: u64,
    /// Inside a track whose category means `ignore`.
    pub ignored_track: u64,
    /// Without a label, a neighbour in reach, or an `unknown_class`.
    pub unknown: u64,
    /// Of a class of `drop_ghosts`, outside every box.
    pub ghost: u64,
}

impl std::ops::AddAssign for DropCounts {
    fn add_assign(&mut self, other: Self) {
        self.not_finite += other.not_finite;
        self.at_origin += other.at_origin;
        self.ego += other.ego;
        self.far += other.far;
        self.ignored_label += other.ignored_label;
        self.ignored_track += other.ignored_track;
        self.unknown += other.unknown;
        self.ghost += other.ghost;
    }
}

/// How many points have their class from where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClassCounts {
    /// The log's own point labels.
    pub labels: u64,
    /// The pixels of masks that they fall on.
    pub masks: u64,
    /// The track in whose box they are.
    pub boxes: u64,
    /// The vote of labelled neighbours.
    pub neighbours: u64,
    /// None in reach: the `unknown_class`.
    pub unknown: u64,
}

impl std::ops::AddAssign for ClassCounts {
    fn add_assign(&mut self, other: Self) {
        self.labels += other.labels;
        self.masks += other.masks;
        self.boxes += other.boxes;
        self.neighbours += other.neighbours;
        self.unknown += other.unknown;
    }
}

impl<L> AggregatedScene<L> {
    /// A scene of these points, of which nothing was dropped.
    pub fn new(background: Vec<BackgroundSweep<L>>, objects: Vec<ObjectSweep>) -> Self {
        let (dropped, class_from) = (DropCounts::default(), ClassCounts::default());
        Self { background, objects, bodies: Vec::new(), dropped, class_from }
    }

    /// How many points are left.
    pub fn point_count(&self) -> usize {
        let background: usize = self.background.iter().map(|sweep| sweep.cloud.len()).sum();
        background + self.objects.iter().map(|object| object.cloud.len()).sum::<usize>()
    }

    /// The bodies of a time, in order of their tracks.
    pub fn bodies_at(&self, time: Timestamp) -> &[Body] {
        let first = self.bodies.partition_point(|body| body.time < time);
        let count = self.bodies[first..].partition_point(|body| body.time == time);
        &self.bodies[first..first + count]
    }
}

impl ObjectSweep {
    /// The ray origin of point `i`, box coordinates.
    pub fn origin(&self, i: usize) -> Point3<f64> {
        self.cloud.origin(i)
    }
}
