//! Oriented boxes and the tracks they form.

use nalgebra::{Point3, Vector3};

use crate::{ClassId, Meaning, Pose, Timestamp};

/// A track's number within its scene: 1..N in byte order of the source's ids, so that 0 is "none".
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrackId(pub u16);

/// An oriented box. Its own frame has its origin at the centre, x forward, y left, z up.
#[derive(Clone, Debug, PartialEq)]
pub struct Box3 {
    /// Where the box stands.
    pub world_from_box: Pose,
    /// Length along x, width along y, height along z, metres, each above 0.
    pub size_m: Vector3<f64>,
}

impl Box3 {
    /// Length times width times height, cubic metres.
    pub fn volume(&self) -> f64 {
        self.size_m.x * self.size_m.y * self.size_m.z
    }
}

/// How much larger than its annotation a box is taken (labels.md section 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxGrowth {
    /// Factor on every side.
    pub scale: f64,
    /// Metres added on every face.
    pub margin_m: f64,
}

/// A grown box in its own frame: `lower <= p <= upper`, closed faces.
///
/// ```text
///        +--------------+  size_z * scale / 2 + margin
///        |  +--------+  |
///        |  |annotated  |
///        +--+--------+--+  -size_z / 2: the bottom stays, else every car takes a slice of road along
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrownBox {
    lower: Point3<f64>,
    upper: Point3<f64>,
}

impl GrownBox {
    /// Grows a box of this size.
    pub fn new(size_m: &Vector3<f64>, growth: &BoxGrowth) -> Self {
        let half = size_m * (growth.scale / 2.0) + Vector3::repeat(growth.margin_m);
        Self { lower: Point3::new(-half.x, -half.y, -size_m.z / 2.0), upper: Point3::from(half) }
    }

    /// Whether a point in box coordinates lies inside or on a face.
    #[inline]
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        (0..3).all(|axis| self.lower[axis] <= p[axis] && p[axis] <= self.upper[axis])
    }

    /// Lower and upper corner.
    pub fn corners(&self) -> (Point3<f64>, Point3<f64>) {
        (self.lower, self.upper)
    }

    /// Where the straight way from `origin` to `point`, which is inside, enters: `origin` itself if
    /// that is inside. Box coordinates.
    #[inline(always)]
    pub fn entry(&self, origin: &Point3<f64>, point: &Point3<f64>) -> Point3<f64> {
        let way = point - origin;
        let mut latest = 0.0_f64;
        for axis in 0..3 {
            let face = if way[axis] > 0.0 { self.lower[axis] } else { self.upper[axis] };
            let share = (face - origin[axis]) / way[axis];
            if share.is_finite() {
                latest = latest.max(share);
            }
        }
        origin + way * latest.min(1.0)
    }

    /// Distance from the centre to the farthest corner, metres.
    pub fn radius(&self) -> f64 {
        let farthest = |axis: usize| self.lower[axis].abs().max(self.upper[axis].abs());
        Vector3::new(farthest(0), farthest(1), farthest(2)).norm()
    }
}

/// One object through time.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxTrack {
    /// Its number in the scene.
    pub id: TrackId,
    /// The source's own id.
    pub source_id: String,
    /// The source's own category.
    pub category: String,
    /// What the category means.
    pub meaning: Meaning,
    /// Annotated boxes in world, times strictly increasing, at least one.
    pub boxes: Vec<(Timestamp, Box3)>,
}

impl BoxTrack {
    /// The track's class; `None` if its points are ignored.
    pub fn class(&self) -> Option<ClassId> {
        match self.meaning {
            Meaning::Class(class) => Some(class),
            Meaning::Ignore => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GROWTH: BoxGrowth = BoxGrowth { scale: 1.1, margin_m: 0.25 };

    #[test]
    fn section_4_a_grown_box_keeps_its_bottom() {
        let grown = GrownBox::new(&Vector3::new(4.0, 2.0, 1.0), &GROWTH);
        assert!(grown.contains(&Point3::new(2.45, 1.35, 0.8)), "grown faces are closed");
        assert!(!grown.contains(&Point3::new(2.46, 0.0, 0.0)));
        assert!(grown.contains(&Point3::new(0.0, 0.0, -0.5)), "the bottom face is closed");
        assert!(!grown.contains(&Point3::new(0.0, 0.0, -0.51)), "the bottom stays");
    }

    #[test]
    fn section_8_a_ray_enters_through_the_face_it_meets_last() {
        let grown =
            GrownBox::new(&Vector3::new(4.0, 2.0, 2.0), &BoxGrowth { scale: 1.0, margin_m: 0.0 });
        let entry = grown.entry(&Point3::new(10.0, 0.0, 0.0), &Point3::origin());
        assert_eq!(entry, Point3::new(2.0, 0.0, 0.0));
        let slanted = grown.entry(&Point3::new(8.0, 8.0, 0.0), &Point3::origin());
        assert_eq!(slanted, Point3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn section_8_an_origin_inside_is_its_own_entry() {
        let grown = GrownBox::new(&Vector3::new(4.0, 2.0, 2.0), &GROWTH);
        let origin = Point3::new(0.5, -0.5, 0.1);
        assert_eq!(grown.entry(&origin, &Point3::new(1.0, 0.2, 0.3)), origin);
    }

    #[test]
    fn volume_is_the_annotated_one() {
        let boxed = Box3 { world_from_box: Pose::identity(), size_m: Vector3::new(4.0, 2.0, 1.5) };
        assert_eq!(boxed.volume(), 12.0);
    }
}
