//! A segment of a drive, as either version of the format gives it.

use nalgebra::Vector3;
use occlabel_core::{Fault, Pose, Timestamp};

use crate::wire::Span;

/// What is known of a segment besides its points.
#[derive(Debug)]
pub(super) struct Segment {
    pub(super) lidars: Vec<LidarCalibration>,
    pub(super) cameras: Vec<CameraCalibration>,
    /// In order of time; in place of one that cannot be used, why.
    pub(super) frames: Vec<Result<Frame, Fault>>,
    /// What is odd but can be lived with.
    pub(super) warnings: Vec<Fault>,
}

impl Frame {
    /// The image that a camera took at a time.
    pub(super) fn image(&self, camera: &str, time: Timestamp) -> Option<&Image> {
        let is_it = |image: &&Image| image.camera == camera && image.exposed(self.time) == time;
        self.images.iter().find(is_it)
    }
}

impl Image {
    /// When the vehicle stood where the image says; its frame's time, if the image does not say when.
    pub(super) fn exposed(&self, of_frame: Timestamp) -> Timestamp {
        match self.time_s.is_finite() && self.time_s > 0.0 {
            true => Timestamp::from_micros((self.time_s * 1e6).round() as i64),
            false => of_frame,
        }
    }
}

/// Images are taken while their frame's lidars turn, or shortly before or after.
const MAX_IMAGE_OFF_S: f64 = 0.25;

/// Whether the frame of a time, microseconds, may hold an image that was taken at another.
pub(super) fn is_near(micros: i64, time: Timestamp) -> bool {
    Timestamp::from_micros(micros).seconds_apart(time) <= MAX_IMAGE_OFF_S
}

/// One lidar of a segment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LidarCalibration {
    pub(super) lidar: Lidar,
    pub(super) ego_from_lidar: Pose,
    pub(super) inclinations: Inclinations,
}

/// How steep the beams of a lidar are, radians, up is positive.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Inclinations {
    /// Of each row of a range image, the lowest row first.
    Each(Vec<f64>),
    /// Spread evenly from the lower edge of the lowest row to the upper edge of the highest.
    Between { min_rad: f64, max_rad: f64 },
}

/// One camera of a segment, as far as the format's numbers make one.
#[derive(Clone, Debug)]
pub(super) struct CameraCalibration {
    pub(super) name: &'static str,
    /// `f_u f_v c_u c_v k1 k2 p1 p2 k3`.
    pub(super) intrinsic: Vec<f64>,
    /// 4 x 4, rows first. The camera looks along x, its left is y, its up is z.
    pub(super) ego_from_camera: Vec<f64>,
    pub(super) width: i64,
    pub(super) height: i64,
    pub(super) shutter_direction: i64,
    pub(super) place: Place,
}

/// One revolution of the lidars, with what goes with it.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) place: Place,
    pub(super) time: Timestamp,
    pub(super) world_from_ego: Pose,
    /// The lidars that have a range image, each with whether it is labelled.
    pub(super) lidars: Vec<(Lidar, bool)>,
    pub(super) images: Vec<Image>,
    pub(super) boxes: Vec<BoxLabel>,
}

/// One camera's image.
#[derive(Debug)]
pub(super) struct Image {
    pub(super) place: Place,
    pub(super) camera: &'static str,
    /// 4 x 4, rows first.
    pub(super) world_from_ego: Vec<f64>,
    /// When the vehicle stood there, seconds.
    pub(super) time_s: f64,
    /// From the first line to the last; not a number if it is not known.
    pub(super) readout_s: f64,
    /// Where its JPEG stands in a file of v1.
    pub(super) jpeg: Option<Span>,
}

/// One box, in the vehicle's frame.
#[derive(Debug)]
pub(super) struct BoxLabel {
    pub(super) place: Place,
    pub(super) track: String,
    pub(super) kind: i64,
    pub(super) center_m: Vector3<f64>,
    /// Length, width, height.
    pub(super) size_m: Vector3<f64>,
    pub(super) heading_rad: f64,
}

/// Where something stands, for faults.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// The file, relative to the log's root.
    pub(super) file: String,
    /// What of it.
    pub(super) record: String,
    /// At which byte of it.
    pub(super) offset: Option<u64>,
}

impl Place {
    /// A fault of what stands here.
    pub(super) fn fault(
        &self,
        rule: &'static str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Fault {
        let fault = Fault::new(rule, &self.file, expected, found).record(&self.record);
        Fault { offset: self.offset, ..fault }
    }
}

/// A lidar, by the format's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Lidar(u8);

/// Names by number, from 1.
const LIDARS: [&str; 5] = ["TOP", "FRONT", "SIDE_LEFT", "SIDE_RIGHT", "REAR"];
const CAMERAS: [&str; 8] = [
    "FRONT",
    "FRONT_LEFT",
    "FRONT_RIGHT",
    "SIDE_LEFT",
    "SIDE_RIGHT",
    "REAR_LEFT",
    "REAR",
    "REAR_RIGHT",
];

impl Lidar {
    /// The lidar of a number.
    pub(super) fn of_number(number: i64) -> Option<Self> {
        (1..=LIDARS.len() as i64).contains(&number).then_some(Self(number as u8))
    }

    /// The lidar of a name.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        let place = LIDARS.iter().position(|known| *known == name)?;
        Self::of_number(place as i64 + 1)
    }

    /// Its number.
    #[cfg(feature = "waymo-v2")]
    pub(super) fn number(self) -> i64 {
        self.0.into()
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        LIDARS[usize::from(self.0) - 1]
    }
}

/// The number of a camera.
#[cfg(feature = "waymo-v2")]
pub(super) fn camera_number(name: &str) -> Option<i64> {
    CAMERAS.iter().position(|known| *known == name).map(|place| place as i64 + 1)
}

/// The camera of a number.
pub(super) fn camera_name(number: i64) -> Option<&'static str> {
    let place = usize::try_from(number).ok()?.checked_sub(1)?;
    CAMERAS.get(place).copied()
}

impl Inclinations {
    /// Those of a range image of `height` rows, the highest row first, as images have it.
    ///
    /// # Errors
    /// What was found, if there are not as many as rows, or one is not finite.
    pub(super) fn rows(&self, height: usize) -> Result<Vec<f64>, String> {
        let mut rows = match self {
            Self::Each(rows) => rows.clone(),
            Self::Between { min_rad, max_rad } => {
                let row =
                    |i: usize| min_rad + (i as f64 + 0.5) / height as f64 * (max_rad - min_rad);
                (0..height).map(row).collect()
            }
        };
        rows.reverse();
        if rows.len() != height {
            return Err(format!("{} inclinations for {height} rows", rows.len()));
        }
        match rows.iter().all(|inclination| inclination.is_finite()) {
            true => Ok(rows),
            false => Err("an inclination that is not finite".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_with_the_highest() {
        let between = Inclinations::Between { min_rad: -0.4, max_rad: 0.0 };
        let rows = between.rows(4).unwrap();
        let expected = [-0.05, -0.15, -0.25, -0.35];
        assert!(rows.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{rows:?}");
        assert_eq!(Inclinations::Each(vec![-0.3, 0.1]).rows(2).unwrap(), [0.1, -0.3]);
        assert!(Inclinations::Each(vec![-0.3, 0.1]).rows(3).is_err());
        assert!(Inclinations::Each(vec![f64::NAN]).rows(1).is_err());
    }

    #[test]
    fn names_go_by_number() {
        assert_eq!(Lidar::of_number(5).map(Lidar::name), Some("REAR"));
        assert_eq!(Lidar::of_name("TOP"), Lidar::of_number(1));
        assert!(Lidar::of_number(0).is_none() && Lidar::of_number(6).is_none());
        assert_eq!((camera_name(1), camera_name(0), camera_name(9)), (Some("FRONT"), None, None));
        assert_eq!(camera_name(i64::MIN), None);
    }
}
