//! Range images, and the points that they tell of.
//!
//! ```text
//!             column 0      azimuth          column W - 1
//!   row 0     +pi - 1/2 px ... 0 ... -pi + 1/2 px    highest beam
//!     ...     azimuth about the vehicle's z axis: the lidar's own yaw is taken off
//!   row H - 1                                        lowest beam
//! ```
//!
//! A pixel is range, intensity, elongation, and 1 in a no-label zone; no return where the range is not
//! above 0. Where pixels have poses, the vehicle moved while the image was taken: each point was seen
//! from its pixel's pose, and is told from where the vehicle stood at the frame's pose.
//! Source: the public definition of the format (dataset.proto, range_image_utils.py).

use std::f64::consts::PI;

use nalgebra::Point3;
use occlabel_core::{LIDAR_ORIGIN, PointCloud, PointLabel, Pose, RigidMap, SweepHeader};

use super::matrix::Matrix;
use crate::transform::pose_from_angles;

/// Values of a pixel.
pub(super) const PIXEL: usize = 4;
/// Values of a pixel's pose: roll, pitch, yaw, x, y, z.
pub(super) const POSE: usize = 6;
/// Values of a pixel's label: instance, class.
pub(super) const LABEL: usize = 2;

/// Origins of one column that are this near each other are one, metres: less than the lattice of
/// rays tells apart.
const SAME_ORIGIN_M: f64 = 1e-4;

/// What one lidar saw in one revolution.
#[derive(Debug)]
pub(super) struct RangeImages {
    /// First and second returns.
    pub(super) returns: Vec<Return>,
    /// The vehicle's pose in world at each pixel, for all returns.
    pub(super) poses: Option<Matrix<f32>>,
}

/// One return of each pixel.
#[derive(Debug)]
pub(super) struct Return {
    pub(super) pixels: Matrix<f32>,
    pub(super) labels: Option<Matrix<i32>>,
}

impl RangeImages {
    /// Rows and columns of the image.
    pub(super) fn size(&self) -> (usize, usize) {
        self.returns.first().map_or((0, 0), |first| first.pixels.size())
    }

    /// Whether all that belongs together has one size; else what has not.
    pub(super) fn check(&self) -> Result<(), String> {
        let sizes = self.returns.iter().flat_map(|one| {
            let labels = one.labels.as_ref().map(Matrix::size);
            [Some(one.pixels.size()), labels]
        });
        let poses = self.poses.as_ref().map(Matrix::size);
        match sizes.chain([poses]).flatten().find(|size| *size != self.size()) {
            Some(other) => Err(format!("{other:?} beside {:?} rows and columns", self.size())),
            None => Ok(()),
        }
    }
}

/// The points of all returns in the lidar's frame, row by row, the first return's first.
///
/// `rows` are the inclinations of the image's rows; `classify` tells what a raw class means.
pub(super) fn points(
    images: &RangeImages,
    rows: &[f64],
    sweep: &SweepHeader,
    mut classify: impl FnMut(i32) -> PointLabel,
) -> PointCloud<PointLabel> {
    let beams = Beams::new(images.size(), rows, &sweep.ego_from_lidar);
    let mut cloud = PointCloud::with_origins(vec![LIDAR_ORIGIN]);
    let mut motion = images.poses.as_ref().map(|poses| Motion::new(poses, sweep));
    for one in &images.returns {
        for (i, pixel) in one.pixels.data.as_chunks::<PIXEL>().0.iter().enumerate() {
            let range_m = f64::from(pixel[0]);
            if range_m.is_nan() || range_m <= 0.0 {
                continue;
            }
            let seen = beams.point(i, range_m);
            let (point, origin) = match &mut motion {
                Some(motion) => motion.place(i, &seen, &mut cloud.origins),
                None => (seen, 0),
            };
            let raw = one.labels.as_ref().filter(|_| pixel[3] != 1.0);
            let raw = raw.map(|labels| labels.data[i * LABEL + 1]);
            cloud.push(point, raw.map_or(PointLabel::Unlabelled, &mut classify), origin);
        }
    }
    cloud
}

/// Cosine and sine of every row's inclination and every column's azimuth.
struct Beams {
    rows: Vec<(f64, f64)>,
    columns: Vec<(f64, f64)>,
}

impl Beams {
    fn new((_, width): (usize, usize), rows: &[f64], ego_from_lidar: &Pose) -> Self {
        let axes = ego_from_lidar.rotation.to_rotation_matrix();
        let yaw = libm::atan2(axes[(1, 0)], axes[(0, 0)]);
        let azimuth = |j: usize| {
            let share = (width as f64 - j as f64 - 0.5) / width as f64;
            (2.0 * share - 1.0) * PI - yaw
        };
        let direction = |angle: f64| (libm::cos(angle), libm::sin(angle));
        Self {
            rows: rows.iter().map(|&inclination| direction(inclination)).collect(),
            columns: (0..width).map(|j| direction(azimuth(j))).collect(),
        }
    }

    /// The point that pixel `i` sees at a range, in the lidar's frame.
    fn point(&self, i: usize, range_m: f64) -> Point3<f64> {
        let (cos_inclination, sin_inclination) = self.rows[i / self.columns.len()];
        let (cos_azimuth, sin_azimuth) = self.columns[i % self.columns.len()];
        Point3::new(
            range_m * cos_azimuth * cos_inclination,
            range_m * sin_azimuth * cos_inclination,
            range_m * sin_inclination,
        )
    }
}

/// The vehicle's motion while an image was taken.
struct Motion<'a> {
    poses: &'a Matrix<f32>,
    lidar_from_world: Pose,
    ego_from_lidar: Pose,
    /// What the last pixel of each column found: neighbours in a column were seen nearly at once.
    columns: Vec<Option<Column>>,
}

#[derive(Clone, Copy)]
struct Column {
    pose: [f32; POSE],
    /// From the lidar at that pixel to the lidar at the sweep's pose.
    map: RigidMap,
    origin: u32,
}

impl<'a> Motion<'a> {
    fn new(poses: &'a Matrix<f32>, sweep: &SweepHeader) -> Self {
        Self {
            poses,
            lidar_from_world: sweep.world_from_lidar().inverse(),
            ego_from_lidar: sweep.ego_from_lidar,
            columns: vec![None; poses.size().1],
        }
    }

    /// Where a point seen by pixel `i` lies from where the sweep stands, and its origin's index.
    fn place(
        &mut self,
        i: usize,
        seen: &Point3<f64>,
        origins: &mut Vec<Point3<f64>>,
    ) -> (Point3<f64>, u32) {
        let pose = self.poses.data.as_chunks::<POSE>().0[i];
        let place = i % self.columns.len();
        let column = match self.columns[place] {
            Some(column) if column.pose == pose => column,
            before => self.column(pose, before.map(|column| column.origin), origins),
        };
        self.columns[place] = Some(column);
        (column.map.apply(seen), column.origin)
    }

    fn column(
        &self,
        pose: [f32; POSE],
        above: Option<u32>,
        origins: &mut Vec<Point3<f64>>,
    ) -> Column {
        let world_from_ego = pose_from_angles(pose.map(f64::from));
        let moved = self.lidar_from_world * world_from_ego * self.ego_from_lidar;
        let map = RigidMap::from(&moved);
        let here = map.apply(&LIDAR_ORIGIN);
        let near = |origin: &u32| (origins[*origin as usize] - here).norm() <= SAME_ORIGIN_M;
        let origin = above.filter(near).unwrap_or_else(|| {
            origins.push(here);
            origins.len() as u32 - 1
        });
        Column { pose, map, origin }
    }
}

#[cfg(test)]
mod tests {
    use occlabel_core::{ClassId, PointsOf, Timestamp};

    use super::*;

    fn sweep() -> SweepHeader {
        SweepHeader {
            time: Timestamp(0),
            lidar: "TOP".into(),
            source_id: "s/0/TOP".into(),
            file: "f".into(),
            world_from_ego: Pose::identity(),
            ego_from_lidar: Pose::translation(0.0, 0.0, 2.0),
            labelled: true,
            points_of: PointsOf::Moment,
        }
    }

    /// An image of one row, each pixel a return at 10 m; the last lies in a no-label zone.
    fn images(width: i32) -> RangeImages {
        let zone = |j| if j == width - 1 { 1.0 } else { -1.0 };
        let pixels = (0..width).flat_map(|j| [10.0, 0.5, 0.0, zone(j)]).collect();
        let labels = (0..width).flat_map(|j| [7, j]).collect();
        let pixels = Matrix::new(&[1, width, 4], PIXEL, pixels).unwrap();
        let labels = Matrix::new(&[1, width, 2], LABEL, labels).ok();
        RangeImages { returns: vec![Return { pixels, labels }], poses: None }
    }

    fn class(raw: i32) -> PointLabel {
        PointLabel::Class(ClassId(raw as u8))
    }

    #[test]
    fn columns_go_round_from_behind_over_the_left_to_behind() {
        let cloud = points(&images(4), &[0.0], &sweep(), class);
        let half = 10.0 * std::f64::consts::FRAC_1_SQRT_2;
        let expected = [[-half, half], [half, half], [half, -half], [-half, -half]];
        for (point, [x, y]) in cloud.positions.iter().zip(expected) {
            assert!((point - Point3::new(x, y, 0.0)).norm() < 1e-12, "{point}");
        }
    }

    #[test]
    fn fault_09_a_pixel_without_a_return_is_no_point_and_labels_stay_with_theirs() {
        let mut images = images(6);
        for (j, range_m) in [(0, -1.0), (2, 0.0), (3, f32::NAN)] {
            images.returns[0].pixels.data[j * PIXEL] = range_m;
        }
        let cloud = points(&images, &[0.0], &sweep(), class);
        assert_eq!(cloud.labels, [class(1), class(4), PointLabel::Unlabelled]);
        assert!(cloud.positions.iter().all(|p| (p.coords.norm() - 10.0).abs() < 1e-9));
    }

    #[test]
    fn fault_28_a_point_in_a_no_label_zone_is_unlabelled() {
        let cloud = points(&images(3), &[0.0], &sweep(), class);
        assert_eq!(cloud.labels, [class(0), class(1), PointLabel::Unlabelled]);
    }

    #[test]
    fn pixels_that_move_have_origins_of_their_own_and_near_ones_share() {
        let mut image = images(1);
        let x = [0.0, 0.00005, 0.00009, 0.5];
        let pixels = [10.0, 0.5, 0.0, -1.0].repeat(x.len());
        image.returns[0] =
            Return { pixels: Matrix::new(&[4, 1, 4], PIXEL, pixels).unwrap(), labels: None };
        let poses = x.iter().flat_map(|&x| [0.0, 0.0, 0.0, x, 0.0, 0.0]).collect();
        image.poses = Matrix::new(&[4, 1, 6], POSE, poses).ok();
        let cloud = points(&image, &[0.0; 4], &sweep(), class);
        assert_eq!(cloud.origin_of, [1, 1, 1, 2]);
        assert!((cloud.origin(3) - Point3::new(0.5, 0.0, 0.0)).norm() < 1e-12);
        let step_m = (cloud.positions[3] - cloud.positions[1]).norm();
        assert!((step_m - 0.49995).abs() < 1e-7, "points move by their own poses: {step_m}");
    }
}
