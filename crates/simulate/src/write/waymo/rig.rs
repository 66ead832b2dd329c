//! The sensors of a drive as the format has them.

use nalgebra::Vector3;
use occlabel_core::{Fault, Pose};

use crate::{Drive, Lidar, Pattern, World};

use super::align::{LEAST_COSINE, azimuth_rad, column, lidar_from_format, yaw_rad};
use super::ids::{CAMERAS, LIDARS, TOP, numbers};
use super::rig_camera::RigCamera;

/// All sensors, in the order of the world's.
pub(super) struct Rig {
    pub(super) lidars: Vec<RigLidar>,
    pub(super) cameras: Vec<RigCamera>,
}

/// A lidar whose rays all meet pixels of a range image.
pub(super) struct RigLidar {
    pub(super) number: u64,
    pub(super) ego_from_format: Pose,
    /// Of the rows, the lowest first, radians: the last row of an image comes first.
    pub(super) inclinations_rad: Vec<f64>,
    /// The row of each ring.
    pub(super) rows: Vec<usize>,
    /// The column of each shot.
    pub(super) columns: Vec<usize>,
}

impl Rig {
    /// The sensors of a drive.
    ///
    /// # Errors
    /// If the format has no words for one: the fault's place is the sensor's key in the world.
    pub(super) fn of(drive: &Drive) -> Result<Self, Fault> {
        let (world, poses) = (drive.world(), drive.poses());
        let lidar = |(at, number)| lidar(world, at, number, &poses.ego_from_lidar[at]);
        let camera = |(at, number): (usize, u64)| {
            let named = &world.cameras[at].named;
            RigCamera::new(&named.camera, number, &poses.ego_from_camera[at])
                .map_err(|found| refused(format!("camera.{}.model", named.name), A_LENS, found))
        };
        let lidars = lidar_numbers(world)?.into_iter().enumerate().map(lidar);
        let cameras = camera_numbers(world)?.into_iter().enumerate().map(camera);
        Ok(Self {
            lidars: lidars.collect::<Result<_, _>>()?,
            cameras: cameras.collect::<Result<_, _>>()?,
        })
    }
}

const A_LENS: &str =
    "pinhole or brown-conrady without skew, with at most 5 coefficients, for a Waymo log";

fn refused(key: String, expected: &str, found: impl Into<String>) -> Fault {
    Fault::new("world", key, expected, found)
}

/// The lidars' numbers; the keyframes' is TOP.
fn lidar_numbers(world: &World) -> Result<Vec<u64>, Fault> {
    let names: Vec<String> = world.lidars.iter().map(|lidar| lidar.name.clone()).collect();
    let reference = occlabel_core::reference_lidar(&names);
    let called = |name| if Some(name) == reference { TOP } else { name.as_str() };
    let called: Vec<&str> = names.iter().map(called).collect();
    let expected = format!("at most {} lidars in a Waymo log", LIDARS.len());
    numbers(&called, LIDARS)
        .ok_or_else(|| refused("lidar".into(), &expected, names.len().to_string()))
}

fn camera_numbers(world: &World) -> Result<Vec<u64>, Fault> {
    let names: Vec<&str> = world.cameras.iter().map(|camera| &*camera.named.name).collect();
    let expected = format!("at most {} cameras in a Waymo log", CAMERAS.len());
    numbers(&names, CAMERAS)
        .ok_or_else(|| refused("camera".into(), &expected, names.len().to_string()))
}

fn lidar(world: &World, at: usize, number: u64, ego_from_lidar: &Pose) -> Result<RigLidar, Fault> {
    let lidar = &world.lidars[at];
    let key = |key: &str| format!("lidar.{}.{key}", lidar.name);
    if matches!(lidar.pattern, Pattern::Rosette { .. }) {
        let expected = "spinning for a Waymo log: a range image has rows and columns";
        return Err(refused(key("pattern"), expected, "rosette"));
    }
    if number != 1 && lidar.rolling && lidar.deskew {
        let expected = "false for a Waymo log: only TOP has a pose for each pixel";
        return Err(refused(key("deskew"), expected, "true of a rolling lidar"));
    }
    let cosine = (ego_from_lidar.rotation * Vector3::z()).z;
    if cosine.abs() < LEAST_COSINE {
        let found = format!("a tilt of cosine {cosine}");
        return Err(refused(key("mounting"), "an axis that does not lie, for a Waymo log", found));
    }
    Ok(RigLidar::new(lidar, number, ego_from_lidar))
}

impl RigLidar {
    fn new(lidar: &Lidar, number: u64, ego_from_lidar: &Pose) -> Self {
        let pattern = &lidar.pattern;
        let lidar_from_format = lidar_from_format(ego_from_lidar, pattern);
        let ego_from_format = ego_from_lidar * lidar_from_format;
        let ray = |shot, ring| lidar_from_format.inverse() * pattern.direction(0, shot, ring);
        let yaw = yaw_rad(&ego_from_format.rotation);
        let width = pattern.shots();
        let column = |shot| column(azimuth_rad(&ray(shot, 0)) + yaw, width).round() as i64;
        let columns = (0..width).map(|shot| column(shot).rem_euclid(width as i64) as usize);
        let (rows, inclinations_rad) =
            rows((0..pattern.rings()).map(|ring| inclination_rad(&ray(0, ring))));
        Self { number, ego_from_format, inclinations_rad, rows, columns: columns.collect() }
    }

    /// Inclinations of the lowest row's lower edge and the highest row's upper one, half a row on.
    pub(super) fn span_rad(&self) -> [f64; 2] {
        let [first, .., last] = self.inclinations_rad[..] else {
            return [self.inclinations_rad[0]; 2];
        };
        let half_rad = (last - first) / (self.inclinations_rad.len() - 1) as f64 / 2.0;
        [first - half_rad, last + half_rad]
    }

    /// Whether it is the one with a pose for each pixel, and with labels.
    pub(super) fn is_top(&self) -> bool {
        self.number == 1
    }
}

/// Above the xy plane.
fn inclination_rad(ray: &Vector3<f64>) -> f64 {
    libm::atan2(ray.z, libm::hypot(ray.x, ray.y))
}

/// The row of each ring, the highest row 0; and the rows' inclinations, the lowest first.
fn rows(rings_rad: impl Iterator<Item = f64>) -> (Vec<usize>, Vec<f64>) {
    let mut sorted: Vec<(usize, f64)> = rings_rad.enumerate().collect();
    sorted.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let mut rows = vec![0; sorted.len()];
    for (from_below, (ring, _)) in sorted.iter().enumerate() {
        rows[*ring] = sorted.len() - 1 - from_below;
    }
    (rows, sorted.into_iter().map(|(_, inclination_rad)| inclination_rad).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{Point3, Translation3};

    use super::*;
    use crate::Beams;
    use crate::rotation::yaw_pitch_roll;

    /// Where a pixel's ray goes in the vehicle, by the devkit's formula alone.
    fn decoded(lidar: &RigLidar, row: usize, column: usize) -> Vector3<f64> {
        let extrinsic = lidar.ego_from_format.to_homogeneous();
        let width = lidar.columns.len() as f64;
        let share = (width - column as f64 - 0.5) / width;
        let azimuth = (2.0 * share - 1.0) * PI - libm::atan2(extrinsic[(1, 0)], extrinsic[(0, 0)]);
        let up = lidar.inclinations_rad[lidar.inclinations_rad.len() - 1 - row];
        let ((rise, flat), (left, ahead)) = (libm::sincos(up), libm::sincos(azimuth));
        let seen = Vector3::new(flat * ahead, flat * left, rise);
        (extrinsic * seen.push(0.0)).xyz()
    }

    #[test]
    fn every_ray_meets_the_pixel_of_its_own_row_and_column() {
        let elevations = vec![-0.5, 0.2, -0.3, 0.0];
        let mut rays = 0;
        for (azimuths, density) in [(1, 1), (2, 1), (7, 1), (180, 1), (1084, 2)] {
            let beams = Beams::ElevationsRad(elevations.clone());
            let pattern = Pattern::Spinning { beams, azimuths, density };
            for [yaw, pitch, roll] in [
                [0.0; 3],
                [-PI / 2.0, 0.0, 0.0],
                [2.6, 0.3, -0.4],
                [1.0, 1.2, 2.9],
                [-3.1, 0.0, PI],
            ] {
                let mounting = Pose::from_parts(
                    Translation3::new(1.0, 2.0, 3.0),
                    yaw_pitch_roll(yaw, pitch, roll),
                );
                rays += assert_all_meet(&mounting, &pattern);
            }
        }
        assert_eq!(rays, 5 * (4 * (1 + 2 + 7 + 180) + 7 * 2168));
    }

    fn assert_all_meet(mounting: &Pose, pattern: &Pattern) -> usize {
        let lidar = RigLidar::new(&lidar_of(pattern), 1, mounting);
        assert!(
            (lidar.ego_from_format * Point3::origin() - mounting * Point3::origin()).norm() < 1e-12
        );
        let mut seen = vec![false; lidar.rows.len() * lidar.columns.len()];
        for (shot, &column) in lidar.columns.iter().enumerate() {
            for (ring, &row) in lidar.rows.iter().enumerate() {
                let expected = mounting * pattern.direction(0, shot, ring);
                let off = (decoded(&lidar, row, column) - expected).norm();
                assert!(off < 1e-12, "{pattern:?} {mounting} {shot} {ring}: off by {off}");
                assert!(!std::mem::replace(&mut seen[row * lidar.columns.len() + column], true));
            }
        }
        seen.len()
    }

    fn lidar_of(pattern: &Pattern) -> Lidar {
        Lidar {
            name: "L".into(),
            ego_from_lidar: Pose::identity(),
            pattern: pattern.clone(),
            clock: crate::Clock::new(10.0, 0.0).unwrap(),
            max_range_m: 50.0,
            range_noise_m: 0.0,
            dropout: 0.0,
            rolling: false,
            deskew: true,
        }
    }
}
