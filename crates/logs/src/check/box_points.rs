//! Annotated boxes that stand where no lidar saw anything.

use std::collections::BTreeMap;

use nalgebra::Point3;
use occlabel_core::{Box3, BoxTrack, Fault, PointCloud, PointLabel, SweepHeader};

/// Boxes up to this far from the lidar count, metres: a sound sweep hits most of them.
const REACH_M: f64 = 20.0;
/// A box may be so much older or younger than a sweep that hits it, seconds: half a turn of a lidar.
const SAME_TIME_S: f64 = 0.06;
/// The lowest share of a box's height does not count: the road is there wherever a box stands.
const BOTTOM_SHARE: f64 = 0.3;
/// Fewer boxes tell nothing.
const MIN_BOXES: usize = 10;
/// At least one box in so many holds a point.
const ONE_IN: usize = 5;

/// A box by its track's number and its own within the track.
type BoxPlace = (u16, usize);

/// The boxes near a sweep, each with whether it holds a point of it.
pub(super) fn near_boxes(
    sweep: &SweepHeader,
    cloud: &PointCloud<PointLabel>,
    tracks: &[BoxTrack],
) -> BTreeMap<BoxPlace, bool> {
    let lidar_from_world = sweep.world_from_lidar().inverse();
    let mut near = BTreeMap::new();
    for track in tracks {
        let boxes = track.boxes.iter().enumerate();
        let of_now = boxes.filter(|(_, (time, _))| time.seconds_apart(sweep.time) <= SAME_TIME_S);
        for (place, (_, boxed)) in of_now {
            let in_lidar =
                Box3 { world_from_box: lidar_from_world * boxed.world_from_box, ..*boxed };
            if in_lidar.world_from_box.translation.vector.norm() <= REACH_M {
                near.insert((track.id.0, place), holds_any(&in_lidar, &cloud.positions));
            }
        }
    }
    near
}

/// Whether any point, in the frame that the box is given in, lies in the box above its bottom.
fn holds_any(boxed: &Box3, points: &[Point3<f64>]) -> bool {
    let (half, from_world) = (boxed.size_m / 2.0, boxed.world_from_box.inverse());
    let lowest = -half.z + BOTTOM_SHARE * boxed.size_m.z;
    let centre = Point3::from(boxed.world_from_box.translation.vector);
    let is_near = |p: &&Point3<f64>| (*p - centre).norm_squared() <= half.norm_squared();
    points.iter().filter(is_near).any(|p| {
        let p = from_world * p;
        p.x.abs() <= half.x && p.y.abs() <= half.y && (lowest..=half.z).contains(&p.z)
    })
}

/// The boxes of a scene that sweeps came near to, and whether any of these hit them.
#[derive(Debug, Default)]
pub(super) struct BoxPoints {
    held: BTreeMap<BoxPlace, bool>,
}

impl BoxPoints {
    /// Adds a sweep's.
    pub(super) fn add(&mut self, near: BTreeMap<BoxPlace, bool>) {
        for (place, holds) in near {
            *self.held.entry(place).or_default() |= holds;
        }
    }

    /// Whether nearly none of the boxes holds a point.
    pub(super) fn fault(&self) -> Option<Fault> {
        let (all, held) = (self.held.len(), self.held.values().filter(|holds| **holds).count());
        if all < MIN_BOXES || held * ONE_IN >= all {
            return None;
        }
        let expected = format!("points in most boxes within {REACH_M} m of a lidar");
        let found = format!("points in {held} of {all}");
        let fault = Fault::new("boxes-empty", "boxes", expected, found);
        Some(fault.hint("boxes and sweeps do not lie in one frame, or not at one time"))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use occlabel_core::{LIDAR_ORIGIN, Meaning, TrackId};

    use super::*;
    use crate::check::test_drive::{pose, straight};

    /// A track with a box beside the vehicle at each sweep, moved by so much.
    fn track(sweeps: &[SweepHeader], aside_m: f64, late_s: f64) -> BoxTrack {
        let boxed = |sweep: &SweepHeader| {
            let x_m = sweep.world_from_ego.translation.x;
            let world_from_box = pose([x_m, aside_m, 6.0], [0.0, 0.0, 1.0]);
            let mut time = sweep.time;
            time.0 += (late_s * 1e9) as i64;
            (time, Box3 { world_from_box, size_m: Vector3::new(4.0, 2.0, 2.0) })
        };
        BoxTrack {
            id: TrackId(1),
            source_id: "car".into(),
            category: "car".into(),
            meaning: Meaning::Ignore,
            boxes: sweeps.iter().map(boxed).collect(),
        }
    }

    /// What is said of these boxes where each sweep has one point beside the vehicle and a road.
    fn fault(sweeps: usize, aside_m: f64, late_s: f64) -> Option<Fault> {
        let sweeps = straight(sweeps, 10.0);
        let tracks = [track(&sweeps, aside_m, late_s)];
        let road = (0..1600).map(|i| (f64::from(i % 40) - 20.0, f64::from(i / 40) - 20.0));
        let road = road.map(|(x, y)| Point3::new(x, y, -1.9));
        let points: Vec<_> = road.chain([Point3::new(-1.0, 8.5, -1.0)]).collect();
        let labels = vec![PointLabel::Unlabelled; points.len()];
        let cloud = PointCloud::from_one_origin(LIDAR_ORIGIN, points, labels);
        let mut all = BoxPoints::default();
        sweeps.iter().for_each(|sweep| all.add(near_boxes(sweep, &cloud, &tracks)));
        all.fault()
    }

    #[test]
    fn boxes_that_hold_points_are_fine() {
        assert_eq!(fault(12, 8.0, 0.0), None);
        assert_eq!(fault(12, 8.0, 0.05), None);
    }

    #[test]
    fn boxes_that_hold_nothing_but_road_are_told() {
        let fault = fault(12, -8.0, 0.0).expect("empty boxes");
        assert_eq!((fault.rule, fault.found.as_str()), ("boxes-empty", "points in 0 of 12"));
    }

    #[test]
    fn few_boxes_far_ones_and_those_of_other_times_say_nothing() {
        assert_eq!(fault(9, -8.0, 0.0), None);
        assert_eq!(fault(12, -25.0, 0.0), None);
        assert_eq!(fault(12, -8.0, 100.0), None);
    }
}
