//! `visible` against casting each ray by itself, in worlds large enough for its bundles of rays.

mod plain;

use std::cell::RefCell;

use nalgebra::{UnitQuaternion, Vector3};
use occlabel_core::camera::{
    BodyMask, BrownConrady, CameraModel, Intrinsics, KannalaBrandt, Mei, Ocam, Pinhole,
};
use occlabel_core::{Camera, GridSpec, Pose, VoxelGrid};
use occlabel_occlusion::{CameraRays, Eye, Lenses, Matter, Occluders, OcclusionSettings, visible};
use proptest::prelude::*;

use plain::visible_plainly;

const MODELS: [&str; 5] = ["pinhole", "brown-conrady", "kannala-brandt", "mei", "ocam"];

#[derive(Clone, Debug)]
struct World {
    spec: GridSpec,
    matter: VoxelGrid<Matter>,
    cameras: Vec<(Camera, Pose)>,
    settings: OcclusionSettings,
}

/// What was exercised.
#[derive(Debug, Default)]
struct Tally {
    /// Cameras by model.
    models: [u32; 5],
    outside: u32,
    masked: u32,
    tall: u32,
    /// Worlds by rays: occupied centres, all centres, pixels.
    rays: [u32; 3],
    seen: usize,
    hidden: usize,
}

#[test]
fn section_10_bundles_of_rays_see_what_each_ray_sees_by_itself() {
    let tally = RefCell::new(Tally::default());
    let config = ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() };
    proptest!(config, |(world in world())| {
        let eyes: Vec<Eye> = world.cameras.iter().enumerate()
            .map(|(bit, (camera, pose))| Eye { bit, camera, grid_from_camera: *pose })
            .collect();
        let (World { spec, matter, .. }, lenses) = (&world, Lenses::default());
        for occluders in [Occluders::All, Occluders::NonFlat] {
            let settings = OcclusionSettings { occluders, ..world.settings };
            let expected = visible_plainly(&eyes, spec, matter, &settings);
            let found = visible(&eyes, &lenses, spec, matter, &settings);
            let differ = expected.values().iter().zip(found.values()).position(|(a, b)| a != b);
            prop_assert_eq!(differ, None, "the first voxel that differs");
            tally.borrow_mut().note(&world, &expected);
        }
    });
    tally.into_inner().assert_enough();
}

impl Tally {
    fn note(&mut self, world: &World, bits: &VoxelGrid<u16>) {
        for (camera, pose) in &world.cameras {
            let model = MODELS.iter().position(|name| *name == camera.model.name()).unwrap();
            self.models[model] += 1;
            self.masked += u32::from(camera.body_mask.is_some());
            let at = world.spec.snap(&pose.translation.vector.into()).voxel();
            self.outside += u32::from(world.spec.flat(at).is_none());
        }
        self.rays[world.settings.rays as usize] += 1;
        self.tall += u32::from(world.spec.shape()[2] > 64);
        let seen = bits.values().iter().filter(|bits| **bits != 0).count();
        self.seen += seen;
        self.hidden += bits.values().len() - seen;
    }

    fn assert_enough(&self) {
        println!("{self:?}");
        assert!(self.models.iter().chain(&self.rays).all(|n| *n >= 20), "{self:?}");
        assert!([self.outside, self.masked, self.tall].iter().all(|n| *n >= 20), "{self:?}");
        assert!(self.seen > 100_000 && self.hidden > 100_000, "{self:?}");
    }
}

/// Ground, boxes on it, and loose voxels in the air; some of it in tall grids.
fn world() -> impl Strategy<Value = World> {
    let shape = prop_oneof![3 => Just([40, 44, 16]), 1 => Just([18, 15, 70])];
    let size_m = prop::sample::select(vec![[0.4; 3], [0.5, 0.4, 0.3]]);
    (shape, size_m, any::<u64>(), prop::collection::vec(camera(), 1..4), settings()).prop_map(
        |(shape, size_m, seed, mut cameras, settings)| {
            let max = [0, 1, 2].map(|axis| shape[axis] as f64 * size_m[axis]);
            let spec = GridSpec::new([0.0; 3], max, size_m).unwrap();
            for (_, pose) in &mut cameras {
                let at = Vector3::from(max).component_mul(&pose.translation.vector);
                pose.translation.vector = at;
            }
            let matter = matter(&spec, seed);
            World { spec, matter, cameras, settings }
        },
    )
}

fn matter(spec: &GridSpec, seed: u64) -> VoxelGrid<Matter> {
    let noise = |a: i64, b: i64, c: i64| {
        let mixed = (a * 73 + b * 1_009 + c * 10_007) as u64 ^ seed;
        mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40
    };
    let at = |[x, y, z]: [i64; 3]| {
        let is_box = noise(x / 5, y / 6, 1) % 12 == 0 && z < 9;
        match z {
            _ if is_box || noise(x, y, z) % 200 == 0 => Matter::Solid,
            2 if noise(x, y, 0) % 8 != 0 => Matter::Ground,
            _ => Matter::Air,
        }
    };
    VoxelGrid::from_values(spec, spec.voxels().map(|voxel| at(voxel.0)).collect())
}

/// A camera of any model; its place counts in grids.
fn camera() -> impl Strategy<Value = (Camera, Pose)> {
    let place = [-0.1..1.1_f64, -0.1..1.1_f64, 0.2..1.0_f64];
    let turn = [-3.0..3.0_f64, -3.0..3.0_f64, -3.0..3.0_f64];
    (0..MODELS.len(), 20_u32..110, 10_u32..90, 20.0..80.0_f64, prop::bool::ANY, place, turn)
        .prop_map(|(model, width, height, focal_px, is_masked, place, turn)| {
            let covered = |at: u32| at / width > height * 3 / 4 || at == 0;
            let body_mask = is_masked.then(|| {
                BodyMask::new(width, height, (0..width * height).map(covered).collect()).unwrap()
            });
            let centre = [f64::from(width) / 2.0, f64::from(height) / 2.0];
            let model = lens(MODELS[model], focal_px, centre);
            let camera = Camera { model, width, height, body_mask, rolling_shutter: None };
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            (camera, Pose::from_parts(Vector3::from(place).into(), turn))
        })
}

fn lens(name: &str, f: f64, [cx, cy]: [f64; 2]) -> CameraModel {
    let k = [[f, 0.3, cx], [0.0, 1.1 * f, cy], [0.0, 0.0, 1.0]];
    let plane = Intrinsics::from_matrix(&k).unwrap();
    match name {
        "pinhole" => CameraModel::Pinhole(Pinhole::new(plane)),
        "brown-conrady" => {
            let bend = [-0.3, 0.1, 0.001, -0.0005, 0.0];
            CameraModel::BrownConrady(BrownConrady::new(plane, &bend).unwrap())
        }
        "kannala-brandt" => {
            let bend = [0.02, -0.005, 0.001, 0.0];
            CameraModel::KannalaBrandt(KannalaBrandt::new(plane, &bend).unwrap())
        }
        "mei" => CameraModel::Mei(Mei::new(plane, &[0.9, -0.1, 0.05, 0.0003, 0.0002]).unwrap()),
        _ => {
            let ray = [f, 0.0, -0.25 / f];
            CameraModel::Ocam(Ocam::new(&ray, [cx, cy], [1.0, 0.0, 0.0], 1.9).unwrap())
        }
    }
}

fn settings() -> impl Strategy<Value = OcclusionSettings> {
    let rays = vec![CameraRays::OccupiedCenters, CameraRays::AllCenters, CameraRays::Pixels];
    let depth_max_m = vec![0.1, 3.0, 9.0, 100.0];
    (prop::sample::select(rays), 1_usize..4, prop::sample::select(depth_max_m)).prop_map(
        |(rays, pixel_stride, depth_max_m)| OcclusionSettings {
            rays,
            occluders: Occluders::All,
            pixel_stride,
            depth_max_m,
        },
    )
}
