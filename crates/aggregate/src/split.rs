//! Splitting a sweep into background and objects (labels.md section 4).

use nalgebra::Point3;
use occlabel_core::{
    BackgroundSweep, Box3, BoxGrowth, ClassId, DropCounts, ObjectSweep, PointCloud, PointLabel,
    RigidMap, Sweep, TrackId, is_finite,
};

use crate::beam_order::beam_order;
use crate::cabinet::Cabinet;

/// What is left out of a sweep, and how boxes are grown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitSettings {
    /// Lower and upper corner of the ego vehicle's body, ego frame, metres; closed faces.
    pub ego_box_m: Option<(Point3<f64>, Point3<f64>)>,
    /// Points farther than this from their ray's origin are dropped, metres.
    pub max_range_m: f64,
    /// How boxes are grown.
    pub growth: BoxGrowth,
}

/// A track's box at a sweep's time.
#[derive(Clone, Debug)]
pub struct TrackBox {
    /// Which track.
    pub track: TrackId,
    /// Its class; `None` if its category means `ignore`.
    pub class: Option<ClassId>,
    /// The box, in world.
    pub boxed: Box3,
}

/// A sweep, sorted.
#[derive(Clone, Debug)]
pub struct SplitSweep {
    /// Points outside every box, world coordinates.
    pub background: BackgroundSweep<Option<ClassId>>,
    /// Points inside a box, box coordinates: one entry for each track that has any.
    pub objects: Vec<ObjectSweep>,
    /// What was dropped.
    pub dropped: DropCounts,
}

/// Sorts the points of a sweep: dropped, inside a box, or background. `boxes` are those of the
/// sweep's time. The points come out beam by beam.
pub fn split_sweep(sweep: &Sweep, boxes: &[TrackBox], settings: &SplitSettings) -> SplitSweep {
    let world_from_lidar = RigidMap::from(&sweep.header.world_from_lidar());
    let cloud = &sweep.cloud;
    let filter = PointFilter::new(sweep, settings);
    let mut cabinet = Cabinet::new(boxes, &settings.growth);
    let origins = cloud.origins.iter().map(|origin| world_from_lidar.apply(origin)).collect();
    let mut background = PointCloud::with_origins(origins);
    background.reserve(cloud.len());
    let mut dropped = DropCounts::default();
    for i in beam_order(cloud) {
        let i = i as usize;
        let Some(label) = filter.judge(i, &mut dropped) else { continue };
        let position = world_from_lidar.apply(&cloud.positions[i]);
        let origin = cloud.origin_of[i];
        match cabinet.claim(&position) {
            Some((_, drawer)) if drawer.is_ignored() => dropped.ignored_track += 1,
            Some((in_box, drawer)) => drawer.put(in_box, &background.origins, origin),
            None => background.push(position, label, origin),
        }
    }
    SplitSweep {
        background: BackgroundSweep::new(sweep.header.time, background),
        objects: cabinet.close(sweep.header.time),
        dropped,
    }
}

/// Decides which points of a sweep are dropped before any box is asked.
struct PointFilter<'a> {
    cloud: &'a PointCloud<PointLabel>,
    ego_from_lidar: RigidMap,
    settings: &'a SplitSettings,
}

impl<'a> PointFilter<'a> {
    fn new(sweep: &'a Sweep, settings: &'a SplitSettings) -> Self {
        let ego_from_lidar = RigidMap::from(&sweep.header.ego_from_lidar);
        Self { cloud: &sweep.cloud, ego_from_lidar, settings }
    }

    /// The label of a point that stays; a point that does not is counted.
    fn judge(&self, i: usize, dropped: &mut DropCounts) -> Option<Option<ClassId>> {
        let (position, origin) = (&self.cloud.positions[i], &self.cloud.origin(i));
        let reason = if !is_finite(position) {
            &mut dropped.not_finite
        } else if position == origin {
            &mut dropped.at_origin
        } else if self.is_ego(position) {
            &mut dropped.ego
        } else if (position - origin).norm() > self.settings.max_range_m {
            &mut dropped.far
        } else {
            match self.cloud.labels[i] {
                PointLabel::Unlabelled => return Some(None),
                PointLabel::Class(class) => return Some(Some(class)),
                PointLabel::Ignored => &mut dropped.ignored_label,
            }
        };
        *reason += 1;
        None
    }

    fn is_ego(&self, position: &Point3<f64>) -> bool {
        let Some((lower, upper)) = &self.settings.ego_box_m else { return false };
        let p = self.ego_from_lidar.apply(position);
        (0..3).all(|axis| lower[axis] <= p[axis] && p[axis] <= upper[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};
    use occlabel_core::{LIDAR_ORIGIN, PointsOf, Pose, SweepHeader, Timestamp};

    const CAR: ClassId = ClassId(4);

    fn settings() -> SplitSettings {
        SplitSettings {
            ego_box_m: None,
            max_range_m: 50.0,
            growth: BoxGrowth { scale: 1.0, margin_m: 0.0 },
        }
    }

    fn header(world_from_ego: Pose, ego_from_lidar: Pose) -> SweepHeader {
        SweepHeader {
            time: Timestamp(7),
            lidar: "TOP".into(),
            source_id: "a".into(),
            file: "a.bin".into(),
            world_from_ego,
            ego_from_lidar,
            labelled: true,
            points_of: PointsOf::Moment,
        }
    }

    fn track_box(track: u16, class: Option<ClassId>, x: f64, size: [f64; 3]) -> TrackBox {
        let world_from_box = Pose::translation(x, 0.0, 0.0);
        let boxed = Box3 { world_from_box, size_m: size.into() };
        TrackBox { track: TrackId(track), class, boxed }
    }

    fn split(points: &[[f64; 3]], boxes: &[TrackBox], settings: &SplitSettings) -> SplitSweep {
        let header = header(Pose::identity(), Pose::identity());
        let positions: Vec<_> = points.iter().map(|p| Point3::from(*p)).collect();
        let labels = vec![PointLabel::Class(ClassId(15)); positions.len()];
        let cloud = PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels);
        split_sweep(&Sweep { header: &header, cloud }, boxes, settings)
    }

    #[test]
    fn fault_06_fault_08_points_that_are_no_points_are_dropped_and_counted() {
        let odd = [[f64::NAN, 0.0, 0.0], [1.0, f64::INFINITY, 0.0], [0.0; 3], [1.0, 0.0, 0.0]];
        let found = split(&odd, &[], &settings());
        assert_eq!((found.dropped.not_finite, found.dropped.at_origin), (2, 1));
        assert_eq!(found.background.cloud.len(), 1);
    }

    #[test]
    fn fault_07_far_points_are_dropped_and_the_limit_is_closed() {
        let found = split(&[[50.0, 0.0, 0.0], [50.1, 0.0, 0.0], [1e7, 0.0, 0.0]], &[], &settings());
        assert_eq!((found.dropped.far, found.background.cloud.len()), (2, 1));
    }

    #[test]
    fn fault_11_the_ego_volume_stands_in_the_ego_frame_with_closed_faces() {
        let mut with_ego = settings();
        with_ego.ego_box_m = Some((Point3::new(-1.0, -1.0, 0.0), Point3::new(3.0, 1.0, 2.0)));
        let quarter =
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
        let ego_from_lidar = Pose::from_parts(Vector3::new(1.0, 0.0, 1.0).into(), quarter);
        let header = header(Pose::translation(500.0, 0.0, 0.0), ego_from_lidar);
        let positions = vec![Point3::new(0.5, -2.0, 1.0), Point3::new(0.5, -2.1, 1.0)];
        let labels = vec![PointLabel::Unlabelled; 2];
        let cloud = PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels);
        let found = split_sweep(&Sweep { header: &header, cloud }, &[], &with_ego);
        assert_eq!((found.dropped.ego, found.background.cloud.len()), (1, 1));
        let kept = found.background.cloud.positions[0];
        assert!((kept - Point3::new(503.1, 0.5, 2.0)).norm() < 1e-9, "{kept}");
    }

    #[test]
    fn fault_24_of_overlapping_boxes_the_smallest_wins_then_the_lower_id() {
        let boxes = [
            track_box(1, Some(CAR), 10.0, [4.0, 4.0, 4.0]),
            track_box(2, Some(CAR), 10.0, [2.0, 2.0, 2.0]),
            track_box(3, Some(CAR), 10.0, [2.0, 2.0, 2.0]),
        ];
        let found =
            split(&[[10.5, 0.0, 0.0], [11.5, 0.0, 0.0], [13.0, 0.0, 0.0]], &boxes, &settings());
        let held: Vec<_> = found.objects.iter().map(|o| (o.track.0, o.cloud.len())).collect();
        assert_eq!(held, [(2, 1), (1, 1)]);
        assert_eq!(found.background.cloud.len(), 1);
    }

    #[test]
    fn section_4_a_boxed_point_takes_box_coordinates_and_the_tracks_class() {
        let found =
            split(&[[9.0, 0.5, 0.2]], &[track_box(1, Some(CAR), 10.0, [4.0; 3])], &settings());
        let object = &found.objects[0];
        assert_eq!(object.cloud.positions, [Point3::new(-1.0, 0.5, 0.2)]);
        assert_eq!(object.origin(0), Point3::new(-10.0, 0.0, 0.0));
        assert_eq!((object.cloud.labels[0], object.time), (CAR, Some(Timestamp(7))));
    }

    #[test]
    fn section_4_an_ignored_track_takes_its_points_away() {
        let found = split(&[[10.0, 0.0, 0.0]], &[track_box(1, None, 10.0, [4.0; 3])], &settings());
        assert_eq!((found.dropped.ignored_track, found.objects.len()), (1, 0));
        assert!(found.background.cloud.is_empty());
    }

    #[test]
    fn section_4_ignored_labels_are_dropped_before_any_box_is_asked() {
        let header = header(Pose::identity(), Pose::identity());
        let labels = vec![PointLabel::Ignored];
        let cloud =
            PointCloud::from_one_origin(LIDAR_ORIGIN, vec![Point3::new(10.0, 0.0, 0.0)], labels);
        let boxes = [track_box(1, Some(CAR), 10.0, [4.0; 3])];
        let found = split_sweep(&Sweep { header: &header, cloud }, &boxes, &settings());
        assert_eq!((found.dropped.ignored_label, found.objects.len()), (1, 0));
    }
}
