//! Range images decode to the exact points of the program that wrote them.

use occlabel_core::{PointLabel, Sweep, SweepHeader};
use occlabel_logs::{SceneSource, WaymoLog};

use crate::log::{MICROS, expected_points, fixtures, options};

/// The largest distance of a point, and of an origin, from where it should be, metres; and how many
/// points were looked at, labelled ones apart.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) off_m: f64,
    origin_off_m: f64,
    pub(crate) points: usize,
    pub(crate) labelled: usize,
}

impl Comparison {
    fn take(&mut self, sweep: &Sweep<'_>, expected: &[[f64; 7]]) {
        let (header, cloud) = (sweep.header, &sweep.cloud);
        assert_eq!(cloud.len(), expected.len(), "{}", header.source_id);
        for (i, [x, y, z, from_x, from_y, from_z, class]) in expected.iter().enumerate() {
            let p_ego = header.ego_from_lidar * cloud.positions[i];
            let origin = header.ego_from_lidar * cloud.origin(i);
            let off_m = (p_ego.coords - nalgebra::Vector3::new(*x, *y, *z)).norm();
            let from = nalgebra::Vector3::new(*from_x, *from_y, *from_z);
            self.off_m = self.off_m.max(off_m);
            self.origin_off_m = self.origin_off_m.max((origin.coords - from).norm());
            let label = match cloud.labels[i] {
                PointLabel::Class(class) => f64::from(class.0),
                PointLabel::Unlabelled => -1.0,
                PointLabel::Ignored => -2.0,
            };
            // The format's 0 is no label.
            let class = if *class == 0.0 { -1.0 } else { *class };
            assert_eq!(label, class, "{} point {i}", header.source_id);
            self.labelled += usize::from(label >= 0.0);
            self.points += 1;
        }
    }
}

/// How far a log's points are from those that its writer computed.
pub(crate) fn compare(log: &WaymoLog) -> Comparison {
    let mut expected = expected_points();
    let scene = log.load(&log.scene_names()[0]).unwrap();
    let mut comparison = Comparison::default();
    for header in &scene.sweeps {
        let points = log.read_sweep(header).unwrap();
        assert!(points.warnings.is_empty());
        let name = format!("{}/{}", header.time.0 / 1000, header.lidar);
        let sweep = Sweep { header, cloud: points.cloud };
        comparison.take(&sweep, &expected.remove(&name).unwrap());
    }
    assert!(expected.is_empty(), "sweeps that were not read: {:?}", expected.keys());
    comparison
}

#[test]
fn v1_range_images_decode_to_their_writers_points() {
    let found = compare(&WaymoLog::open(&fixtures().join("v1"), options()).unwrap());
    println!("{found:?}");
    assert!(found.off_m < 1e-5, "{} m", found.off_m);
    // Origins that are nearer each other than this share one.
    assert!(found.origin_off_m < 1.1e-4, "{} m", found.origin_off_m);
    assert_eq!((found.points, found.labelled), (POINTS, LABELLED));
}

/// Points of the fixture, and the labelled among them.
pub(crate) const POINTS: usize = 1496;
pub(crate) const LABELLED: usize = 489;

#[test]
fn section_2_each_lidar_has_its_own_origin_and_the_top_one_moves_with_its_pixels() {
    let log = WaymoLog::open(&fixtures().join("v1"), options()).unwrap();
    let scene = log.load(&log.scene_names()[0]).unwrap();
    let origins = |sweep: &SweepHeader| log.read_sweep(sweep).unwrap().cloud.origins;
    let mut counts = [0, 0];
    for sweep in &scene.sweeps {
        let origins = origins(sweep);
        match sweep.lidar.as_str() {
            // One a column, more in the two columns whose pixels differ.
            "TOP" => assert!((36..=52).contains(&origins.len()), "{}", origins.len()),
            _ => assert_eq!(origins, [occlabel_core::LIDAR_ORIGIN]),
        }
        counts[usize::from(sweep.lidar == "TOP")] += 1;
    }
    assert_eq!(counts, [4 * MICROS.len(), MICROS.len()]);
}

#[test]
fn a_scenes_points_are_estimated_with_room_to_spare() {
    let log = WaymoLog::open(&fixtures().join("v1"), options()).unwrap();
    let estimate = log.scene_points(&log.load(&log.scene_names()[0]).unwrap());
    assert!((POINTS as u64..2 * POINTS as u64).contains(&estimate), "{estimate}");
}
