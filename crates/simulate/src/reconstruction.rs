//! What a reconstruction makes of a drive's images: the points that pixels show, a little off.

use nalgebra::Point3;
use occlabel_core::{Camera, Exposure, Fault, Pose, Timestamp};
use rayon::prelude::*;
use serde::Deserialize;

use crate::check::{need, within};
use crate::noise::{Chance, Kind};
use crate::{Drive, Instant, Ray, What};

/// The `[reconstruction]` of a world, checked: how a cloud is made of what its cameras see.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Reconstruction {
    /// Every how many-th exposure of each camera shows points.
    pub exposure_stride: usize,
    /// Every how many-th pixel of each row and column does.
    pub pixel_stride: u32,
    /// What is farther from a camera is not reconstructed by it, metres.
    pub max_range_m: f64,
    /// Deviation of a point along its pixel's ray, metres.
    pub noise_m: f64,
    /// What each metre of distance adds to that, metres.
    pub noise_per_m: f64,
}

impl Default for Reconstruction {
    fn default() -> Self {
        Self {
            exposure_stride: 6,
            pixel_stride: 6,
            max_range_m: 60.0,
            noise_m: 0.01,
            noise_per_m: 0.001,
        }
    }
}

impl Reconstruction {
    pub(crate) fn check(&self) -> Result<(), Fault> {
        need("exposure_stride", self.exposure_stride > 0, "at least 1", 0)?;
        need("pixel_stride", self.pixel_stride > 0, "at least 1", 0)?;
        within("max_range_m", self.max_range_m, 0.1, 1000.0)?;
        within("noise_m", self.noise_m, 0.0, 1e3)?;
        within("noise_per_m", self.noise_per_m, 0.0, 1.0)
    }
}

/// A point that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudPoint {
    /// Where it is taken to be; world.
    pub position: Point3<f64>,
    /// What it is a point of.
    pub what: What,
}

/// The points that an exposure shows, in the order of its pixels. `number` tells it from the camera's other
/// exposures, so that each pixel has a chance of its own. Parallel; the same on any number of threads.
///
/// The ego's own body shows none, as pixels that it covers look at nothing.
pub fn exposure_cloud(drive: &Drive, exposure: &Exposure, number: usize) -> Vec<CloudPoint> {
    let world = drive.world();
    let time_s = exposure.time.seconds_since(Timestamp(0));
    let look = Look {
        drive,
        instant: Instant::without_ego(world, |_| time_s),
        camera: &world.cameras[exposure.camera].named.camera,
        world_from_camera: drive.world_from_camera(exposure),
        number: number * world.cameras.len() + exposure.camera,
    };
    let stride = world.reconstruction.pixel_stride as usize;
    let rows: Vec<u32> = (0..look.camera.height).step_by(stride).collect();
    let row = |row: &u32| {
        let columns = (0..look.camera.width).step_by(stride);
        columns.filter_map(|column| look.point(column, *row)).collect::<Vec<_>>()
    };
    rows.par_iter().flat_map_iter(row).collect()
}

/// An exposure, and the world around it.
struct Look<'a> {
    drive: &'a Drive,
    instant: Instant<'a>,
    camera: &'a Camera,
    world_from_camera: Pose,
    number: usize,
}

impl Look<'_> {
    fn point(&self, column: u32, row: u32) -> Option<CloudPoint> {
        let settings = &self.drive.world().reconstruction;
        let direction = self.camera.ray_of(column, row)?;
        let ray = Ray { origin: Point3::origin(), direction: *direction };
        let ray = ray.moved(&self.world_from_camera);
        let hit = self.instant.cast(&ray, settings.max_range_m)?;
        let pixel = row as usize * self.camera.width as usize + column as usize;
        let chance = Chance::of(self.drive.world().seed, Kind::Pixel, self.number, pixel);
        let deviation_m = settings.noise_m + settings.noise_per_m * hit.distance_m;
        let position = ray.at(hit.distance_m + deviation_m * chance.normal());
        Some(CloudPoint { position, what: hit.what })
    }
}
