//! `visible` against a slow oracle: labels.md section 10 in plain loops, one ray after the other.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point2, Point3, UnitQuaternion, Vector3};
use occlabel_core::camera::{BodyMask, CameraModel, Intrinsics, Ocam, Pinhole};
use occlabel_core::{
    Camera, ClassId, ClassSet, GridSpec, LatticePoint, Pose, VoxelGrid, VoxelState, VoxelVote,
    traverse,
};
use occlabel_occlusion::{
    CameraRays, Eye, Lenses, Matter, Occluders, OcclusionSettings, matter, visible,
};
use proptest::prelude::*;

const ROAD: ClassId = ClassId(11);
const POLE: ClassId = ClassId(15);

#[test]
fn section_10_bits_are_what_the_rules_say_ray_by_ray() {
    let tally = RefCell::new(Tally::default());
    proptest!(cases(3_000), |(case in case())| {
        let bits = case.visible(&case.matter());
        prop_assert_eq!(case.bits_by_oracle(&mut tally.borrow_mut()), bits.values());
    });
    tally.borrow().assert_at_least(&[
        ("pinhole", 500),
        ("omnidirectional", 500),
        ("camera inside the grid", 500),
        ("camera outside the grid", 500),
        ("camera in an occupied voxel", 200),
        ("ray to a voxel", 10_000),
        ("ray through a pixel", 10_000),
        ("pixel of the body", 3_000),
        ("pixel beyond the model", 300),
        ("ray stopped", 10_000),
        ("ray at its end", 3_000),
        ("unobserved, passed", 3_000),
        ("ground, passed", 2_000),
        ("ground, in view only", 100),
        ("in view", 10_000),
        ("too far", 10_000),
        ("exactly at the limit", 10),
        ("out of the model", 10_000),
        ("out of the image", 3_000),
        ("behind the body", 1_000),
        ("seen", 10_000),
    ]);
}

#[test]
fn section_10_more_occupied_voxels_never_show_another() {
    let (hidden, kept) = (RefCell::new(0), RefCell::new(0));
    proptest!(cases(1_500), |(mut case in case(), more in prop::collection::vec(0_usize..1_000, 1..6))| {
        case.settings.rays = CameraRays::Pixels;
        case.settings.occluders = Occluders::All;
        let before = case.matter();
        let mut after = before.clone();
        for at in more {
            let at = at % before.values().len();
            after.values_mut()[at] = Matter::Solid;
        }
        let (before, after) = (case.visible(&before), case.visible(&after));
        for (before, after) in before.values().iter().zip(after.values()) {
            prop_assert_eq!(after & !before, 0, "bits {:b}, then {:b}", before, after);
            *hidden.borrow_mut() += (before & !after).count_ones();
            *kept.borrow_mut() += after.count_ones();
        }
    });
    let (hidden, kept) = (hidden.into_inner(), kept.into_inner());
    assert!(hidden > 500 && kept > 5_000, "{hidden} hidden, {kept} kept");
}

#[test]
fn section_10_fewer_occluders_and_more_rays_show_no_less() {
    let more_by = RefCell::new([0, 0]);
    proptest!(cases(500), |(case in case())| {
        let with = |rays, occluders| {
            let settings = OcclusionSettings { rays, occluders, ..case.settings };
            Case { settings, ..case.clone() }.visible(&case.matter())
        };
        let rays = case.settings.rays;
        let (all, non_flat) = (with(rays, Occluders::All), with(rays, Occluders::NonFlat));
        let occupied = with(CameraRays::OccupiedCenters, case.settings.occluders);
        let centres = with(CameraRays::AllCenters, case.settings.occluders);
        for (i, (less, more)) in [(all, non_flat), (occupied, centres)].iter().enumerate() {
            let pairs = || less.values().iter().zip(more.values());
            prop_assert!(pairs().all(|(less, more)| less & !more == 0));
            more_by.borrow_mut()[i] += pairs().map(|(less, more)| (more & !less).count_ones()).sum::<u32>();
        }
    });
    let [by_ground, by_air] = more_by.into_inner();
    assert!(by_ground > 500 && by_air > 5_000, "{by_ground} by ground, {by_air} by air");
}

/// Failures are not written down: there is no source tree to keep them beside.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

/// How often each thing happened.
#[derive(Debug, Default)]
struct Tally(BTreeMap<&'static str, u64>);

impl Tally {
    fn note(&mut self, what: &'static str) {
        *self.0.entry(what).or_default() += 1;
    }

    fn assert_at_least(&self, least: &[(&'static str, u64)]) {
        println!("{self:#?}");
        for (what, n) in least {
            let found = self.0.get(what).copied().unwrap_or(0);
            assert!(found >= *n, "{what}: {found}, expected at least {n}");
        }
    }
}

#[derive(Clone, Debug)]
struct Voxel {
    state: VoxelState,
    class: ClassId,
}

#[derive(Clone, Debug)]
struct Seer {
    bit: usize,
    camera: Camera,
    /// Focal length and centre of a pinhole.
    pinhole: Option<(f64, f64, f64)>,
    grid_from_camera: Pose,
}

#[derive(Clone, Debug)]
struct Case {
    min_m: [f64; 3],
    size_m: [f64; 3],
    shape: [i64; 3],
    voxels: Vec<Voxel>,
    seers: Vec<Seer>,
    settings: OcclusionSettings,
}

/// Section 10, in its own order.
impl Case {
    fn bits_by_oracle(&self, tally: &mut Tally) -> Vec<u16> {
        let mut bits = vec![0; self.voxels.len()];
        for seer in &self.seers {
            for voxel in self.seen_by(seer, tally) {
                tally.note("seen");
                bits[self.place(voxel).unwrap()] |= 1 << seer.bit;
            }
        }
        bits
    }

    fn seen_by(&self, seer: &Seer, tally: &mut Tally) -> BTreeSet<[i64; 3]> {
        self.note_camera(seer, tally);
        let mut seen = BTreeSet::new();
        for end in self.ray_ends(seer, tally) {
            self.look(seer, end, &mut seen, tally);
        }
        for voxel in self.all_voxels() {
            let is_ground = self.is_occupied(voxel) && self.voxel(voxel).class == ROAD;
            let is_open = self.settings.occluders == Occluders::NonFlat && is_ground;
            if is_open && self.is_in_view(seer, voxel, &mut Tally::default()) && seen.insert(voxel)
            {
                tally.note("ground, in view only");
            }
        }
        seen
    }

    fn note_camera(&self, seer: &Seer, tally: &mut Tally) {
        let own = voxel_of(self.snap(&position(seer)));
        let is_pinhole = seer.pinhole.is_some();
        tally.note(if is_pinhole { "pinhole" } else { "omnidirectional" });
        let is_inside = self.place(own).is_some();
        tally.note(if is_inside { "camera inside the grid" } else { "camera outside the grid" });
        if is_inside && self.is_occupied(own) {
            tally.note("camera in an occupied voxel");
        }
    }

    /// Which rays are cast.
    fn ray_ends(&self, seer: &Seer, tally: &mut Tally) -> Vec<LatticePoint> {
        if self.settings.rays == CameraRays::Pixels {
            return self.pixel_ends(seer, tally);
        }
        let mut ends = Vec::new();
        for voxel in self.all_voxels() {
            let is_asked = self.settings.rays == CameraRays::AllCenters || self.is_occupied(voxel);
            if is_asked && self.is_in_view(seer, voxel, tally) {
                tally.note("ray to a voxel");
                ends.push(LatticePoint(voxel.map(|i| 2048 * i + 1025)));
            }
        }
        ends
    }

    fn pixel_ends(&self, seer: &Seer, tally: &mut Tally) -> Vec<LatticePoint> {
        let (stride, depth_m) = (self.settings.pixel_stride, self.settings.depth_max_m);
        let mut ends = Vec::new();
        for row in (0..seer.camera.height).step_by(stride) {
            for column in (0..seer.camera.width).step_by(stride) {
                if seer.camera.is_body(column, row) {
                    tally.note("pixel of the body");
                } else if let Some(way) = seer.direction(column, row) {
                    tally.note("ray through a pixel");
                    let end = seer.grid_from_camera * Point3::from(way / way.norm() * depth_m);
                    ends.push(self.snap(&end));
                } else {
                    tally.note("pixel beyond the model");
                }
            }
        }
        ends
    }

    fn is_in_view(&self, seer: &Seer, voxel: [i64; 3], tally: &mut Tally) -> bool {
        let away = self.centre(voxel) - position(seer);
        let p = Point3::from(seer.grid_from_camera.rotation.inverse() * away);
        if away.norm() == self.settings.depth_max_m {
            tally.note("exactly at the limit");
        }
        let (what, is_in_view) = if away.norm() > self.settings.depth_max_m {
            ("too far", false)
        } else if let Some(pixel) = seer.pixel(&p) {
            seer.what_is_at(&pixel)
        } else {
            ("out of the model", false)
        };
        tally.note(what);
        is_in_view
    }

    /// From the camera's own voxel to the first that blocks.
    fn look(
        &self,
        seer: &Seer,
        end: LatticePoint,
        seen: &mut BTreeSet<[i64; 3]>,
        tally: &mut Tally,
    ) {
        let start = self.snap(&position(seer));
        if self.place(voxel_of(start)).is_some() {
            seen.insert(voxel_of(start));
        }
        for voxel in traverse(start, end).map(|voxel| voxel.0) {
            if self.place(voxel).is_none() {
                continue;
            }
            seen.insert(voxel);
            if self.blocks(voxel) {
                return tally.note("ray stopped");
            }
            if self.voxel(voxel).state == VoxelState::Unobserved {
                tally.note("unobserved, passed");
            } else if self.is_occupied(voxel) {
                tally.note("ground, passed");
            }
        }
        tally.note("ray at its end");
    }

    fn blocks(&self, voxel: [i64; 3]) -> bool {
        let is_spared =
            self.settings.occluders == Occluders::NonFlat && self.voxel(voxel).class == ROAD;
        self.is_occupied(voxel) && !is_spared
    }

    fn is_occupied(&self, voxel: [i64; 3]) -> bool {
        self.voxel(voxel).state == VoxelState::Occupied
    }

    fn voxel(&self, voxel: [i64; 3]) -> &Voxel {
        &self.voxels[self.place(voxel).unwrap()]
    }

    fn all_voxels(&self) -> Vec<[i64; 3]> {
        let [nx, ny, nz] = self.shape;
        let mut all = Vec::new();
        for x in 0..nx {
            for y in 0..ny {
                (0..nz).for_each(|z| all.push([x, y, z]));
            }
        }
        all
    }

    /// In C order, if it is in the grid.
    fn place(&self, voxel: [i64; 3]) -> Option<usize> {
        let is_in_grid = (0..3).all(|axis| 0 <= voxel[axis] && voxel[axis] < self.shape[axis]);
        let [x, y, z] = voxel;
        is_in_grid.then_some(((x * self.shape[1] + y) * self.shape[2] + z) as usize)
    }

    fn centre(&self, voxel: [i64; 3]) -> Point3<f64> {
        Point3::from(std::array::from_fn::<f64, 3, _>(|axis| {
            self.min_m[axis] + (voxel[axis] as f64 + 0.5) * self.size_m[axis]
        }))
    }

    /// q = 2 * floor(u * 1024) + 1, u = (p - min) / size.
    fn snap(&self, p: &Point3<f64>) -> LatticePoint {
        LatticePoint(std::array::from_fn(|axis| {
            let u = (p[axis] - self.min_m[axis]) / self.size_m[axis];
            2 * (u * 1024.0).floor() as i64 + 1
        }))
    }
}

fn voxel_of(q: LatticePoint) -> [i64; 3] {
    q.0.map(|q| q.div_euclid(2048))
}

fn position(seer: &Seer) -> Point3<f64> {
    seer.grid_from_camera.translation.vector.into()
}

impl Seer {
    /// The pixel of a point of the camera frame, in the image or not.
    fn pixel(&self, p: &Point3<f64>) -> Option<Point2<f64>> {
        match self.pinhole {
            Some((f, cx, cy)) if p.z > 0.0 => {
                Some(Point2::new(f * (p.x / p.z) + cx, f * (p.y / p.z) + cy))
            }
            Some(_) => None,
            None => self.camera.model.project(p),
        }
    }

    fn direction(&self, column: u32, row: u32) -> Option<Vector3<f64>> {
        let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        match self.pinhole {
            Some((f, cx, cy)) => Some(Vector3::new((x - cx) / f, (y - cy) / f, 1.0)),
            None => self.camera.model.unproject(&Point2::new(x, y)).map(|way| way.into_inner()),
        }
    }

    fn what_is_at(&self, pixel: &Point2<f64>) -> (&'static str, bool) {
        let (w, h) = (f64::from(self.camera.width), f64::from(self.camera.height));
        if !(0.0 <= pixel.x && pixel.x < w && 0.0 <= pixel.y && pixel.y < h) {
            ("out of the image", false)
        } else if self.camera.is_body(pixel.x.floor() as u32, pixel.y.floor() as u32) {
            ("behind the body", false)
        } else {
            ("in view", true)
        }
    }
}

/// The same case in the words of the crates.
impl Case {
    fn spec(&self) -> GridSpec {
        let max = |axis| self.min_m[axis] + self.shape[axis] as f64 * self.size_m[axis];
        GridSpec::new(self.min_m, std::array::from_fn(max), self.size_m).unwrap()
    }

    /// Voxels that are not occupied have votes too: of points that rays contradicted.
    fn matter(&self) -> VoxelGrid<Matter> {
        let vote = |voxel: &Voxel| Some(VoxelVote { class: voxel.class, instance: None });
        let states = self.voxels.iter().map(|voxel| voxel.state).collect();
        let votes = self.voxels.iter().map(vote).collect();
        let flat: ClassSet = [ROAD].into_iter().collect();
        let spec = self.spec();
        matter(&VoxelGrid::from_values(&spec, states), &VoxelGrid::from_values(&spec, votes), &flat)
    }

    fn visible(&self, matter: &VoxelGrid<Matter>) -> VoxelGrid<u16> {
        let eyes = self.seers.iter().map(|seer| Eye {
            bit: seer.bit,
            camera: &seer.camera,
            grid_from_camera: seer.grid_from_camera,
        });
        visible(&eyes.collect::<Vec<_>>(), &Lenses::default(), &self.spec(), matter, &self.settings)
    }
}

/// Straight along the grid and often on faces and centres of voxels, or anyhow; in the grid or near.
fn pose() -> impl Strategy<Value = Pose> {
    let coarse = |reach: i32| (-reach..=reach).prop_map(|i| f64::from(i) * 0.25);
    let straight = prop_oneof![2 => Just(3), 1 => Just(8)]
        .prop_flat_map(move |reach| [coarse(reach), coarse(reach), coarse(reach)])
        .prop_map(|p| Pose::from_parts(Vector3::from(p).into(), UnitQuaternion::identity()));
    let fine = |reach: f64| -reach..reach;
    let turned = (prop_oneof![2 => Just(0.75), 1 => Just(2.0)], [fine(3.0), fine(3.0), fine(3.0)])
        .prop_flat_map(move |(reach, turn)| ([fine(reach), fine(reach), fine(reach)], Just(turn)))
        .prop_map(|(p, axis_angle)| {
            let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(axis_angle));
            Pose::from_parts(Vector3::from(p).into(), rotation)
        });
    prop_oneof![straight, turned]
}

prop_compose! {
    /// A body mask, where there is one, covers a rectangle in a corner.
    fn body(width: u32, height: u32)(columns in 0..width, rows in 0..height, is_there in prop::bool::ANY)
        -> Option<BodyMask> {
        let covered = (0..width * height).map(|at| at % width < columns && at / width < rows);
        is_there.then(|| BodyMask::new(width, height, covered.collect()).unwrap())
    }
}

/// A pinhole, or an OCam that sees to beyond 90 degrees.
fn seer() -> impl Strategy<Value = Seer> {
    (3_u32..24, 3_u32..18)
        .prop_flat_map(|(w, h)| (Just((w, h)), body(w, h), 1.5..10.0_f64, prop::bool::ANY, pose()))
        .prop_map(|((width, height), body_mask, f, is_pinhole, grid_from_camera)| {
            let (cx, cy) = (f64::from(width) / 2.0, f64::from(height) / 2.0);
            let k = [[f, 0.0, cx], [0.0, f, cy], [0.0, 0.0, 1.0]];
            let polynomial = [f, 0.0, -0.25 / f];
            let model = if is_pinhole {
                CameraModel::Pinhole(Pinhole::new(Intrinsics::from_matrix(&k).unwrap()))
            } else {
                CameraModel::Ocam(Ocam::new(&polynomial, [cx, cy], [1.0, 0.0, 0.0], 1.9).unwrap())
            };
            let camera = Camera { model, width, height, body_mask, rolling_shutter: None };
            let pinhole = is_pinhole.then_some((f, cx, cy));
            Seer { bit: 0, camera, pinhole, grid_from_camera }
        })
}

fn voxel() -> impl Strategy<Value = Voxel> {
    let state = prop_oneof![
        2 => Just(VoxelState::Unobserved),
        2 => Just(VoxelState::Free),
        1 => Just(VoxelState::Occupied),
    ];
    (state, prop_oneof![Just(ROAD), Just(POLE)]).prop_map(|(state, class)| Voxel { state, class })
}

fn settings() -> impl Strategy<Value = OcclusionSettings> {
    let rays = vec![CameraRays::OccupiedCenters, CameraRays::AllCenters, CameraRays::Pixels];
    let occluders = vec![Occluders::All, Occluders::NonFlat];
    (
        prop::sample::select(rays),
        prop::sample::select(occluders),
        1_usize..4,
        prop::sample::select(vec![0.75, 1.25, 2.3, 10.0, 50.0]),
    )
        .prop_map(|(rays, occluders, pixel_stride, depth_max_m)| OcclusionSettings {
            rays,
            occluders,
            pixel_stride,
            depth_max_m,
        })
}

prop_compose! {
    fn case()(shape in [3_i64..8, 3_i64..8, 2_i64..7])
        (voxels in prop::collection::vec(voxel(), shape.iter().product::<i64>() as usize),
        shape in Just(shape),
        mut seers in prop::collection::vec(seer(), 1..4),
        bits in prop::sample::subsequence((0..16).collect::<Vec<usize>>(), 3),
        size_m in prop::sample::select(vec![[0.5; 3], [0.4; 3], [0.25, 0.5, 0.75]]),
        min_m in prop::sample::select(vec![[-1.0, -1.0, -0.5], [-1.2, -0.9, -0.7]]),
        settings in settings()) -> Case {
        seers.iter_mut().zip(bits).for_each(|(seer, bit)| seer.bit = bit);
        Case { min_m, size_m, shape, voxels, seers, settings }
    }
}
