//! Pictures of small known labels.

use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};
use occlabel_core::{GridSpec, Palette, VoxelGrid, VoxelIndex};
use occlabel_testkit::assert_golden;
use occlabel_view::{BirdsEye, Orbit, Painted, birds_eye, perspective, png};

const FREE: u8 = 17;
const CAR: u8 = 0;
const ROAD: u8 = 1;
/// Around the map of a picture from above.
const MARGIN_PX: u32 = 28;

/// Labels that own their grids; all observed and seen, all free.
struct Labels {
    spec: GridSpec,
    semantics: VoxelGrid<u8>,
    mask_lidar: VoxelGrid<u8>,
    mask_camera: VoxelGrid<u8>,
    palette: Palette,
}

impl Labels {
    /// Voxels of half a metre, far from the ego, whose mark would cover them.
    fn empty(shape: [usize; 3]) -> Self {
        let min_m = [100.0, -50.0, 1.0];
        let max_m = std::array::from_fn(|axis| min_m[axis] + 0.5 * shape[axis] as f64);
        let spec = GridSpec::new(min_m, max_m, [0.5; 3]).unwrap();
        let seen = VoxelGrid::filled(&spec, 1);
        Self {
            semantics: VoxelGrid::filled(&spec, FREE),
            mask_lidar: seen.clone(),
            mask_camera: seen,
            palette: Palette::of(&["car", "driveable_surface"]),
            spec,
        }
    }

    /// A road with a step in it, a car on it, and a column that nobody saw.
    fn street() -> Self {
        let mut labels = Self::empty([10, 8, 4]);
        for (x, y) in (0..10).flat_map(|x| (2..7).map(move |y| (x, y))) {
            labels.put([x, y, usize::from(x > 7)], ROAD);
        }
        for (x, z) in [(3, 1), (4, 1), (4, 2), (5, 1)] {
            labels.put([x, 4, z], CAR);
            labels.put([x, 5, z], CAR);
        }
        (0..4).for_each(|z| labels.hide([9, 7, z]));
        labels
    }

    fn flat(&self, voxel: [usize; 3]) -> usize {
        self.spec.flat(VoxelIndex(voxel.map(|i| i as i64))).unwrap()
    }

    fn put(&mut self, voxel: [usize; 3], class: u8) {
        let flat = self.flat(voxel);
        self.semantics.values_mut()[flat] = class;
    }

    fn hide(&mut self, voxel: [usize; 3]) {
        let flat = self.flat(voxel);
        self.mask_lidar.values_mut()[flat] = 0;
        self.mask_camera.values_mut()[flat] = 0;
    }

    fn painted(&self) -> Painted<'_> {
        Painted {
            spec: &self.spec,
            semantics: &self.semantics,
            mask_lidar: Some(&self.mask_lidar),
            mask_camera: Some(&self.mask_camera),
            free: FREE,
            palette: &self.palette,
            heading_rad: Some(0.0),
        }
    }
}

/// The middle of a column's pixels on a map of 20 pixels a voxel: forward is up, left is left.
fn above(picture: &RgbImage, [nx, ny]: [u32; 2], [x, y]: [u32; 2]) -> Rgb<u8> {
    let (column, row) = ((ny - 1 - y) * 20 + 10, (nx - 1 - x) * 20 + 10);
    *picture.get_pixel(MARGIN_PX + column, MARGIN_PX + row)
}

#[test]
fn a_column_is_drawn_forward_up_and_left_left() {
    let mut labels = Labels::empty([10, 8, 4]);
    let empty = birds_eye(&labels.painted(), &BirdsEye { map_px: 200 });
    let mut tried = 0;
    for [x, y] in [[0, 0], [9, 0], [0, 7], [6, 2]] {
        labels.put([x, y, 3], CAR);
        let picture = birds_eye(&labels.painted(), &BirdsEye { map_px: 200 });
        let at = [x as u32, y as u32];
        assert_eq!(
            above(&picture, [10, 8], at),
            Rgb(labels.palette.color(CAR)),
            "the top is undimmed"
        );
        assert_ne!(above(&empty, [10, 8], at), above(&picture, [10, 8], at));
        tried += 1;
    }
    assert_eq!(tried, 4);
}

#[test]
fn low_is_darker_than_high_and_states_differ() {
    let mut labels = Labels::empty([10, 8, 4]);
    labels.put([2, 2, 0], CAR);
    labels.put([6, 2, 3], CAR);
    labels.put([6, 5, 3], CAR);
    let unseen_car = labels.flat([6, 5, 3]);
    labels.mask_camera.values_mut()[unseen_car] = 0;
    (0..4).for_each(|z| labels.hide([4, 4, z]));
    let picture = birds_eye(&labels.painted(), &BirdsEye { map_px: 200 });
    let at = |x, y| above(&picture, [10, 8], [x, y]);
    let (low, high, dull, unobserved, free) = (at(2, 2), at(6, 2), at(6, 5), at(4, 4), at(8, 2));
    assert!((0..3).all(|i| low.0[i] <= high.0[i]) && low.0[2] < high.0[2], "{low:?} {high:?}");
    let blue_excess = |c: Rgb<u8>| i32::from(c.0[2]) - i32::from(c.0[0]);
    assert!(blue_excess(dull) < blue_excess(low) && blue_excess(dull) > 40, "{dull:?}");
    assert!(unobserved.0[1] + 30 < free.0[1], "{unobserved:?} {free:?}");
}

/// Where a point is drawn, from the camera's place and angles alone: turned by the azimuth about the
/// vertical, then tilted by the elevation.
fn projected(orbit: &Orbit, p: Point3<f64>) -> (u32, u32) {
    let off = p - orbit.target;
    let (sin_a, cos_a) = libm::sincos(orbit.azimuth_rad);
    let (sin_e, cos_e) = libm::sincos(orbit.elevation_rad);
    let (near, right) = (off.x * cos_a + off.y * sin_a, off.y * cos_a - off.x * sin_a);
    let depth = orbit.distance_m - near * cos_e - off.z * sin_e;
    let up = off.z * cos_e - near * sin_e;
    let focal_px = f64::from(orbit.height) / 2.0 / 0.32;
    let x = f64::from(orbit.width) / 2.0 + right / depth * focal_px;
    let y = f64::from(orbit.height) / 2.0 - up / depth * focal_px;
    (x as u32, y as u32)
}

#[test]
fn a_voxel_is_drawn_where_the_formula_says_and_its_faces_by_their_light() {
    let mut labels = Labels::empty([8, 8, 4]);
    let mut tried = 0;
    for (step, voxel) in [[1, 2, 0], [6, 1, 3], [3, 7, 2]].into_iter().enumerate() {
        labels.semantics = VoxelGrid::filled(&labels.spec, FREE);
        labels.put(voxel, CAR);
        let centre = labels.spec.centre(VoxelIndex(voxel.map(|i| i as i64)));
        let behind = Orbit::behind(&labels.spec, 500, 400);
        let orbit = Orbit { azimuth_rad: 3.6 + 0.25 * step as f64, ..behind };
        let picture = perspective(&labels.painted(), &orbit);
        let faces = [(Vector3::z(), 1.0), (-Vector3::x(), 0.80), (-Vector3::y(), 0.64)];
        for (normal, light) in faces {
            let (x, y) = projected(&orbit, centre + normal * 0.25);
            let color = labels.palette.color(CAR).map(|c| (f64::from(c) * light + 0.5) as u8);
            assert_eq!(picture.get_pixel(x, y).0, color, "{voxel:?} {normal:?}");
            tried += 1;
        }
    }
    assert_eq!(tried, 9);
}

#[test]
fn what_no_camera_sees_is_dull_unless_there_is_no_camera() {
    let mut labels = Labels::empty([8, 8, 4]);
    labels.put([3, 3, 1], CAR);
    let flat = labels.flat([3, 3, 1]);
    let orbit = Orbit::behind(&labels.spec, 500, 400);
    let draw = |labels: &Labels| perspective(&labels.painted(), &orbit);
    let seen = draw(&labels);
    labels.mask_camera.values_mut()[flat] = 0;
    assert_ne!(draw(&labels), seen);
    labels.mask_camera.values_mut().fill(0);
    assert_eq!(draw(&labels), seen);
}

#[test]
fn a_picture_is_the_same_on_any_number_of_threads() {
    let labels = Labels::street();
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let orbit = Orbit::behind(&labels.spec, 700, 300);
            let above = birds_eye(&labels.painted(), &BirdsEye { map_px: 333 });
            (png(&above), png(&perspective(&labels.painted(), &orbit)))
        })
    };
    assert_eq!(draw(1), draw(2));
}

#[test]
fn pictures_of_any_size_can_be_drawn() {
    let labels = Labels::street();
    for (width, height) in [(0, 0), (1, 1), (0, 9), (9, 0), (541, 3), (2, 900)] {
        let picture = perspective(&labels.painted(), &Orbit::behind(&labels.spec, width, height));
        assert_eq!(picture.dimensions(), (width, height));
    }
    for map_px in [0, 1, 3] {
        assert!(birds_eye(&labels.painted(), &BirdsEye { map_px }).height() > 2 * MARGIN_PX);
    }
    let lost = Orbit { distance_m: f64::NAN, ..Orbit::behind(&labels.spec, 20, 20) };
    assert_eq!(perspective(&labels.painted(), &lost).width(), 20);
}

/// A picture as text: a letter for what a pixel is nearest to in hue, capital where it is bright.
fn text(picture: &RgbImage) -> String {
    let letter = |pixel: &Rgb<u8>| {
        let [r, g, b] = pixel.0.map(i32::from);
        match (r - g > 60, b - r > 60, r.max(b) > 180) {
            (true, _, true) => 'R',
            (true, _, false) => 'r',
            (_, true, true) => 'C',
            (_, true, false) => 'c',
            _ if b > 60 => '.',
            _ => ' ',
        }
    };
    let row = |row: image::buffer::Pixels<Rgb<u8>>| row.map(letter).collect::<String>();
    picture.rows().map(row).map(|row| row.trim_end().to_owned() + "\n").collect()
}

#[test]
fn the_street_from_behind_looks_like_this() {
    let labels = Labels::street();
    let picture = perspective(&labels.painted(), &Orbit::behind(&labels.spec, 64, 32));
    assert_golden("view/street-from-behind.txt", &text(&picture));
}

#[test]
fn the_street_from_above_looks_like_this() {
    let labels = Labels::street();
    let picture = birds_eye(&labels.painted(), &BirdsEye { map_px: 20 });
    let map = image::imageops::crop_imm(&picture, MARGIN_PX, MARGIN_PX, 16, 20).to_image();
    assert_golden("view/street-from-above.txt", &text(&map));
}
