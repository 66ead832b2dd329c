//! What a camera sees of a world: classes, instances and distances, pixel by pixel.

use nalgebra::{Point3, Vector3};
use occlabel_core::{Camera, ClassId, Exposure, PointLabel, Pose, Timestamp};
use rayon::prelude::*;

use crate::{Drive, Hit, Instant, Ray, What};

/// The class of a pixel that shows none: sky, what is not part of the labels, the ego's own body.
pub const NO_CLASS: u8 = u8::MAX;

/// What is farther is sky, metres.
const FARTHEST_M: f64 = 2000.0;
/// How bright a surface is that faces away from the light.
const AMBIENT: f64 = 0.45;
/// Where the light comes from, in world: above, from the left behind of who looks along x.
const LIGHT: [f64; 3] = [-0.48, 0.36, 0.8];

const SKY: [u8; 3] = [205, 222, 240];
const BODY: [u8; 3] = [24, 24, 28];
/// A surface without a class.
const UNKNOWN: [u8; 3] = [128, 128, 128];

/// An image of a world, as arrays by rows, a pixel after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Class ids of the taxonomy, [`NO_CLASS`] where there is none.
    pub classes: Vec<u8>,
    /// A mover's number in the world plus 1; 0 where there is no mover.
    pub instances: Vec<u16>,
    /// Distance from the camera to the surface, metres; infinite where there is none.
    pub distances_m: Vec<f32>,
    /// Red, green, blue of each pixel: the class's colour, shaded by the surface's normal.
    pub rgb: Vec<u8>,
}

#[derive(Clone, Copy, Debug)]
struct Pixel {
    class: u8,
    instance: u16,
    distance_m: f32,
    rgb: [u8; 3],
}

/// Casts a ray through every pixel's centre into the true world of an exposure's time, from where
/// its camera truly stood. Parallel over rows.
///
/// All rows are taken at the exposure's time, whatever the camera's shutter. The ego's body is seen
/// where the camera's body mask says, and nowhere else.
pub fn render(drive: &Drive, exposure: &Exposure) -> ClassImage {
    let (world, time_s) = (drive.world(), exposure.time.seconds_since(Timestamp(0)));
    let instant = Instant::without_ego(world, |_| time_s);
    let camera = &world.cameras[exposure.camera];
    let world_from_camera = world.world_from_ego(time_s) * camera.ego_from_camera;
    let camera = &camera.named.camera;
    let row = |row| {
        let pixel = |column| look(drive, &instant, camera, &world_from_camera, column, row);
        (0..camera.width).map(pixel).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Pixel>> = (0..camera.height).into_par_iter().map(row).collect();
    ClassImage::new(camera.width, camera.height, &rows.concat())
}

impl ClassImage {
    fn new(width: u32, height: u32, pixels: &[Pixel]) -> Self {
        Self {
            width,
            height,
            classes: pixels.iter().map(|pixel| pixel.class).collect(),
            instances: pixels.iter().map(|pixel| pixel.instance).collect(),
            distances_m: pixels.iter().map(|pixel| pixel.distance_m).collect(),
            rgb: pixels.iter().flat_map(|pixel| pixel.rgb).collect(),
        }
    }
}

impl Pixel {
    fn empty(rgb: [u8; 3]) -> Self {
        Self { class: NO_CLASS, instance: 0, distance_m: f32::INFINITY, rgb }
    }
}

fn look(
    drive: &Drive,
    instant: &Instant,
    camera: &Camera,
    world_from_camera: &Pose,
    column: u32,
    row: u32,
) -> Pixel {
    let empty = Pixel::empty(if camera.is_body(column, row) { BODY } else { SKY });
    let Some(direction) = camera.ray_of(column, row) else { return empty };
    let ray = Ray { origin: Point3::origin(), direction: *direction }.moved(world_from_camera);
    instant.cast(&ray, FARTHEST_M).map_or(empty, |hit| shown(drive, &hit))
}

fn shown(drive: &Drive, hit: &Hit) -> Pixel {
    let (class, colour) = match drive.label_of(hit.what) {
        PointLabel::Class(ClassId(class)) => (class, drive.colour(ClassId(class))),
        PointLabel::Ignored | PointLabel::Unlabelled => (NO_CLASS, UNKNOWN),
    };
    let instance = match hit.what {
        What::Mover(at) => at as u16 + 1,
        What::Ground(_) | What::Static(_) | What::Ego => 0,
    };
    let facing = hit.normal.dot(&Vector3::from(LIGHT)).max(0.0);
    let bright = AMBIENT + (1.0 - AMBIENT) * facing;
    let rgb = colour.map(|channel| (f64::from(channel) * bright).round() as u8);
    Pixel { class, instance, distance_m: hit.distance_m as f32, rgb }
}
