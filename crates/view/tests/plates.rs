//! Plates of small known labels: what is at which pixel, told by other means.

use image::{Rgb, RgbImage};
use nalgebra::{Isometry3, Point2, Point3, Quaternion, UnitQuaternion, Vector3};
use occlabel_core::camera::{BodyMask, CameraModel, Intrinsics, KannalaBrandt, Ocam, Pinhole};
use occlabel_core::{Camera, GridSpec, Palette, VoxelGrid, VoxelIndex};
use occlabel_view::{
    Across, Aim, CameraView, Change, Difference, NO_LABEL, Painted, Plate, Strip, png,
};

const FREE: u8 = 17;
/// Each is brightest in a channel of its own.
const CLASSES: [&str; 3] = ["pedestrian", "vegetation", "car"];

struct Labels {
    spec: GridSpec,
    semantics: VoxelGrid<u8>,
    mask_lidar: VoxelGrid<u8>,
    mask_camera: VoxelGrid<u8>,
    palette: Palette,
}

impl Labels {
    fn empty(shape: [usize; 3]) -> Self {
        let min_m = [-1.0, -3.0, -1.0];
        let size_m = [0.5, 0.5, 0.4];
        let max_m = std::array::from_fn(|axis| min_m[axis] + size_m[axis] * shape[axis] as f64);
        let spec = GridSpec::new(min_m, max_m, size_m).unwrap();
        let seen = VoxelGrid::filled(&spec, 1);
        Self {
            semantics: VoxelGrid::filled(&spec, FREE),
            mask_lidar: seen.clone(),
            mask_camera: seen,
            palette: Palette::of(&CLASSES),
            spec,
        }
    }

    /// About one voxel in fourteen occupied.
    fn random(shape: [usize; 3], seed: u64) -> Self {
        let mut labels = Self::empty(shape);
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        for value in labels.semantics.values_mut() {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            if state.is_multiple_of(14) {
                *value = (state / 14 % 3) as u8;
            }
        }
        labels
    }

    fn put(&mut self, voxel: [i64; 3], class: u8) {
        let flat = self.spec.flat(VoxelIndex(voxel)).unwrap();
        self.semantics.values_mut()[flat] = class;
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

    /// The first occupied voxel's class on a ray, of all boxes asked one by one.
    fn first_on(&self, eye: &Point3<f64>, way: &Vector3<f64>) -> Option<(f64, usize)> {
        let occupied = |flat: &usize| self.semantics.values()[*flat] != FREE;
        let met = (0..self.spec.len()).filter(occupied).filter_map(|flat| {
            let [_, ny, nz] = self.spec.shape();
            let voxel = [flat / (ny * nz), flat / nz % ny, flat % nz].map(|i| i as i64);
            let (centre, half) = (self.spec.centre(VoxelIndex(voxel)), self.spec.size_m() / 2.0);
            Some((slabs(eye, way, &(centre - half), &(centre + half))?, flat))
        });
        met.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// When a ray enters a box that does not hold its origin.
fn slabs(
    eye: &Point3<f64>,
    way: &Vector3<f64>,
    low: &Point3<f64>,
    high: &Point3<f64>,
) -> Option<f64> {
    let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let [a, b] = [low, high].map(|face| (face[axis] - eye[axis]) / way[axis]);
        (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
    }
    (enters > 0.0 && enters < leaves).then_some(enters)
}

fn intrinsics(focal: f64) -> Intrinsics {
    Intrinsics::from_matrix(&[[focal, 0.0, 24.0], [0.0, focal, 20.0], [0.0, 0.0, 1.0]]).unwrap()
}

/// Cameras of 48 x 40 pixels: straight, fisheye, and one that sees behind itself.
fn cameras() -> [Camera; 3] {
    let fisheye = KannalaBrandt::new(intrinsics(16.0), &[0.02, -0.004, 0.0, 0.0]).unwrap();
    let ocam = Ocam::new(&[14.0, 0.0, -0.018], [24.0, 20.0], [1.0, 0.0, 0.0], 1.9).unwrap();
    let models = [
        CameraModel::Pinhole(Pinhole::new(intrinsics(30.0))),
        CameraModel::KannalaBrandt(fisheye),
        CameraModel::Ocam(ocam),
    ];
    models.map(|model| Camera {
        model,
        width: 48,
        height: 40,
        body_mask: None,
        rolling_shutter: None,
    })
}

/// At a place in the grid, looking along x with its own x to the right.
fn looking_ahead() -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(0.5, -0.5, 0.5, -0.5));
    Isometry3::from_parts(Vector3::new(0.6, 0.1, 0.35).into(), rotation)
}

fn view<'a>(camera: &'a Camera, image: Option<&'a RgbImage>) -> CameraView<'a> {
    CameraView { name: "CAM", camera, grid_from_camera: looking_ahead(), image }
}

/// Where every ray of a pixel meets one voxel, or none, the overlay shows its class, or the image.
#[test]
fn an_overlay_shows_the_first_voxel_on_each_line_of_sight_through_any_camera() {
    let black = RgbImage::new(48, 40);
    let mut counts = [[0, 0]; 3];
    for (kind, camera) in cameras().iter().enumerate() {
        for seed in 1..6 {
            let labels = Labels::random([14, 12, 6], seed);
            let picture = view(camera, Some(&black)).overlay(&labels.painted(), (48, 40));
            for (x, y, pixel) in picture.enumerate_pixels() {
                let Some(expected) = told_by_rays(&labels, camera, x, y) else { continue };
                let brightest = (0..3).max_by_key(|&channel| pixel.0[channel]);
                let shown = brightest.filter(|_| pixel.0 != [0; 3]);
                assert_eq!(shown, expected, "{kind} {seed} {x} {y}: {pixel:?}");
                counts[kind][usize::from(shown.is_some())] += 1;
            }
        }
    }
    for [bare, covered] in counts {
        assert!(bare > 300 && covered > 1500, "{counts:?}");
    }
}

/// The class at a pixel, if its corners and its centre agree: `Some(None)` is no voxel.
fn told_by_rays(labels: &Labels, camera: &Camera, x: u32, y: u32) -> Option<Option<usize>> {
    let offs = [(0.5, 0.5), (0.02, 0.02), (0.98, 0.02), (0.02, 0.98), (0.98, 0.98)];
    let pose = looking_ahead();
    let mut met = offs.map(|(dx, dy)| {
        let way = camera.model.unproject(&Point2::new(f64::from(x) + dx, f64::from(y) + dy))?;
        let first = labels.first_on(&pose.translation.vector.into(), &(pose * way.into_inner()));
        first.map(|(_, flat)| flat)
    });
    met.sort_unstable();
    let one = met[0] == met[4];
    one.then(|| met[0].map(|flat| usize::from(labels.semantics.values()[flat])))
}

#[test]
fn an_overlay_lets_the_image_through_and_leaves_the_rest_of_it_alone() {
    let [camera, ..] = cameras();
    let image = RgbImage::from_pixel(48, 40, Rgb([100, 100, 100]));
    let mut labels = Labels::empty([14, 12, 6]);
    labels.put([9, 6, 3], 0);
    let picture = view(&camera, Some(&image)).overlay(&labels.painted(), (48, 40));
    let eye = looking_ahead().inverse();
    let centre = labels.spec.centre(VoxelIndex([9, 6, 3]));
    let at = camera.pixel_of(&(eye * centre)).unwrap();
    let red = 255.0 * 0.80 * 0.55 + 100.0 * 0.45;
    assert_eq!(picture.get_pixel(at.0, at.1).0, [red as u8, 45, 45], "a wall's light");
    assert_eq!(picture.get_pixel(2, 2), image.get_pixel(2, 2));
    let bare = view(&camera, None).overlay(&labels.painted(), (48, 40));
    assert!(bare.get_pixel(2, 2).0.iter().all(|channel| *channel < 30), "dark without an image");
}

#[test]
fn the_vehicles_own_body_is_not_painted_over() {
    let [camera, ..] = cameras();
    let covered = (0..40 * 48).map(|at| at / 48 >= 20).collect();
    let mask = BodyMask::new(48, 40, covered).unwrap();
    let camera = Camera { body_mask: Some(mask), ..camera };
    let image = RgbImage::from_pixel(48, 40, Rgb([1, 2, 3]));
    let mut labels = Labels::empty([14, 12, 6]);
    labels.semantics.values_mut()[3 * 12 * 6..].fill(1);
    let picture = view(&camera, Some(&image)).overlay(&labels.painted(), (48, 40));
    assert!((0..48).all(|x| (20..40).all(|y| picture.get_pixel(x, y).0 == [1, 2, 3])));
    assert!((0..48).all(|x| (0..19).all(|y| picture.get_pixel(x, y).0 != [1, 2, 3])));
}

#[test]
fn a_difference_counts_each_voxel_once() {
    let (mut one, mut two) = (Labels::empty([6, 6, 4]), Labels::empty([6, 6, 4]));
    one.put([0, 0, 0], 0);
    one.put([1, 1, 1], 1);
    two.put([1, 1, 1], 2);
    one.put([2, 2, 2], 2);
    two.put([2, 2, 2], 2);
    [[3, 3, 3], [4, 3, 3]].into_iter().for_each(|voxel| two.put(voxel, 0));
    (0..3).for_each(|x| two.put([x, 5, 0], NO_LABEL));
    two.mask_camera.values_mut()[7] = 0;
    let sets = Difference { from: one.painted(), to: two.painted() };
    let counts = sets.counts();
    let of = [Change::Gained, Change::Lost, Change::Class, Change::Mask].map(|c| counts.of(c));
    assert_eq!(of, [2, 1, 1, 4]);
    let back = Difference { from: two.painted(), to: one.painted() }.counts();
    assert_eq!([back.of(Change::Gained), back.of(Change::Lost)], [1, 2]);
}

#[test]
fn masks_that_one_set_lacks_do_not_differ() {
    let (one, mut two) = (Labels::empty([3, 3, 2]), Labels::empty([3, 3, 2]));
    two.mask_lidar.values_mut().fill(0);
    let bare = Painted { mask_lidar: None, mask_camera: None, ..one.painted() };
    let counts = Difference { from: bare, to: two.painted() }.counts();
    assert_eq!(counts, Default::default());
}

/// Draws every kind of plate.
fn all(labels: &Labels, plate: &Plate) -> Vec<RgbImage> {
    let painted = labels.painted();
    let cameras = cameras();
    let views: Vec<_> = cameras.iter().map(|camera| view(camera, None)).collect();
    let mut strip = Strip::new(*plate, &labels.palette, &labels.spec, 3);
    (0..3).for_each(|keyframe| strip.add(&painted, &format!("keyframe {keyframe}")));
    let other = Labels::random(labels.spec.shape(), 99);
    let sets = Difference { from: painted, to: other.painted() };
    let axes = [Across::X, Across::Y, Across::Z];
    let mut plates = axes.map(|across| plate.slices(&painted, across)).to_vec();
    plates.extend([
        plate.sheet(&painted, &Aim::default()),
        plate.birds_eye(&painted),
        plate.perspective(&painted, &Aim { distance_m: Some(9.0), ..Aim::default() }),
        plate.through_camera(&painted, &views[2]),
        plate.overlay(&painted, &views),
        plate.difference(&sets, &Aim::default()),
        strip.finish(),
    ]);
    plates
}

#[test]
fn every_page_has_the_size_that_was_asked_for() {
    let mut drawn = 0;
    for (shape, (width, height)) in [
        ([14, 12, 6], (1, 1)),
        ([14, 12, 6], (16, 16)),
        ([1, 1, 1], (541, 230)),
        ([40, 3, 70], (200, 700)),
        ([14, 12, 6], (900, 500)),
    ] {
        let plate = Plate { width, height, title: "a title that is far too long for its plate" };
        for picture in all(&Labels::random(shape, 7), &plate) {
            assert_eq!(picture.dimensions(), (width, height));
            drawn += 1;
        }
    }
    assert_eq!(drawn, 50);
}

#[test]
fn pages_are_the_same_on_any_number_of_threads() {
    let labels = Labels::random([14, 12, 6], 3);
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let plate = Plate { width: 700, height: 400, title: "threads" };
        pool.install(|| all(&labels, &plate).iter().map(png).collect::<Vec<_>>())
    };
    assert_eq!(draw(1), draw(2));
}

/// The share of a plate's body, legend left out, that has a colour.
fn share(picture: &RgbImage, color: [u8; 3]) -> f64 {
    let same = picture.pixels().filter(|pixel| pixel.0 == color).count();
    same as f64 / f64::from(picture.width() * picture.height())
}

#[test]
fn slices_show_every_state_apart() {
    let mut labels = Labels::empty([8, 8, 1]);
    for (at, value) in labels.semantics.values_mut().iter_mut().enumerate() {
        *value = [0, FREE, FREE, NO_LABEL][at / 16];
    }
    labels.mask_lidar.values_mut()[32..48].fill(0);
    let plate = Plate { width: 300, height: 300, title: "" };
    let picture = plate.slices(&labels.painted(), Across::Z);
    let (car, free, unobserved, unlabelled) =
        (labels.palette.color(0), [88, 97, 112], [14, 16, 20], [74, 62, 44]);
    let shares = [car, free, unobserved, unlabelled].map(|color| share(&picture, color));
    assert!(shares.iter().all(|share| (share - shares[0]).abs() < 0.01), "{shares:?}");
    assert!(shares[0] > 0.15, "{shares:?}");
    let rows = |color: [u8; 3]| picture.enumerate_pixels().find(|(.., p)| p.0 == color).unwrap().1;
    assert!(rows(unlabelled) < rows(unobserved) && rows(unobserved) < rows(free));
    assert!(rows(free) < rows(car), "x grows up");
}

#[test]
fn upright_slices_have_up_above_and_left_left() {
    for across in [Across::X, Across::Y] {
        let mut labels = Labels::empty([1, 1, 1]);
        let spec = GridSpec::new([0.0; 3], [2.0, 2.0, 2.0], [1.0; 3]).unwrap();
        labels.semantics = VoxelGrid::filled(&spec, 1);
        labels.mask_lidar = VoxelGrid::filled(&spec, 1);
        labels.mask_camera = VoxelGrid::filled(&spec, 1);
        labels.spec = spec;
        (0..2).for_each(|i| labels.put(if across == Across::X { [i, 1, 1] } else { [1, i, 1] }, 0));
        let picture =
            Plate { width: 400, height: 200, title: "" }.slices(&labels.painted(), across);
        let color = |class| labels.palette.color(class);
        let mut of_first = picture.enumerate_pixels().filter(|(x, ..)| *x < 200);
        let inked = of_first.find(|(.., p)| [color(0), color(1)].contains(&p.0)).unwrap();
        assert_eq!(inked.2.0, color(0), "{across:?}: the upper left voxel");
        let lower = picture.get_pixel(inked.0 + 2, inked.1 + 120);
        assert_eq!(lower.0, color(1), "{across:?}: under it");
    }
}

/// Where on the map's ring of 10 pixels around the ego its mark reaches: above, left, below, right.
fn reached(labels: &Labels, heading_rad: Option<f64>) -> [bool; 4] {
    let painted = Painted { heading_rad, ..labels.painted() };
    let picture = occlabel_view::birds_eye(&painted, &occlabel_view::BirdsEye { map_px: 240 });
    let (ego_x, ego_y) = (28 + 120, 28 + 120);
    let is_ink = |x: i32, y: i32| picture.get_pixel(x as u32, y as u32).0 == [232, 236, 242];
    [(0, -10), (-10, 0), (0, 10), (10, 0)].map(|(dx, dy)| is_ink(ego_x + dx, ego_y + dy))
}

#[test]
fn the_ego_points_where_it_drives_and_nowhere_if_nobody_tells() {
    let mut labels = Labels::empty([24, 24, 2]);
    labels.spec = GridSpec::new([-12.0, -12.0, 0.0], [12.0, 12.0, 2.0], [1.0; 3]).unwrap();
    assert_eq!(reached(&labels, Some(0.0)), [true, false, false, false], "along x: up");
    let quarter = std::f64::consts::FRAC_PI_2;
    assert_eq!(reached(&labels, Some(quarter)), [false, true, false, false], "along y: left");
    assert_eq!(reached(&labels, Some(-quarter)), [false, false, false, true]);
    assert_eq!(reached(&labels, None), [false; 4]);
}
