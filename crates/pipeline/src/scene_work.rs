//! What there is to do for a scene, as far as its tables tell: what the cost model counts.

use std::f64::consts::TAU;

use nalgebra::Point3;
use occlabel_annotate::{BoxSource, box_at};
use occlabel_core::camera::CameraModel;
use occlabel_core::{Box3, BoxTrack, GridSpec, Keyframe, Scene, SweepHeader, Timestamp};
use occlabel_occlusion::{CameraRays, Eye, in_view};
use occlabel_raycast::{Crossings, ObjectRays, RaySettings, RaySource};
use serde::{Deserialize, Serialize};

use crate::Rules;
use crate::label_keyframe::open_eyes;

/// As far as most rays go, metres: a lidar this far outside a grid hardly looks into it.
const REACH_M: f64 = 40.0;

/// Of a lidar that stands in a grid half as wide as this, a ray stays for half of its length, metres.
const HALF_OUT_M: f64 = 20.0;

/// What a lidar looks at, steradian: all around, 34 degrees from its lowest to its highest beam.
const LIDAR_SR: f64 = TAU * 0.6;

/// No thing is taken to be nearer to a lidar than this, metres.
const NEAREST_M: f64 = 3.0;

/// How much of its box a thing that changes shape fills, as a lidar sees it.
const BODY_FILL: f64 = 0.5;

/// Blocks of a grid, of which it is asked whether a camera looks there.
const LOOKS: [usize; 3] = [20, 20, 4];

/// A scene in one grid. Amounts are expected ones, summed over the keyframes that are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneWork {
    /// Sweeps.
    pub sweeps: f64,
    /// Points of all sweeps.
    pub points: f64,
    /// Those of sweeps that carry labels.
    pub labelled_points: f64,
    /// How many are labelled.
    pub keyframes: f64,
    /// Points that serve a keyframe.
    pub rays: f64,
    /// The same, each by how near its lidar stands to the grid: from 1 in the middle to 0.
    pub near_rays: f64,
    /// How far from the middle of the grid the lidars of near rays stand, metres.
    pub spread_m: f64,
    /// Voxels that near rays enter.
    pub steps: f64,
    /// Of the rays, those to points of tracks that stand in the grid then.
    pub object_rays: f64,
    /// How they are cast.
    pub objects: ObjectRays,
    /// What the rays keep of their crossings.
    pub casting: CastingCost,
    /// The size of a voxel, metres: the geometric mean of its edges.
    pub voxel_size_m: f64,
    /// Width times length of the grid, square metres.
    pub area_m2: f64,
    /// Voxels of the grids.
    pub voxels: f64,
    /// Voxels that cameras without distortion look at, once for each camera.
    pub looks: f64,
    /// The same of cameras with distortion or wide lenses.
    pub curved_looks: f64,
    /// Rays that cameras cast.
    pub camera_rays: CameraRays,
    /// Pixels that are asked for, where rays go by pixels.
    pub pixels: f64,
    /// Whether evidence is written.
    pub evidence: bool,
}

/// What is kept of crossings: each costs more than the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CastingCost {
    /// Nothing: no ray is cast.
    Nothing,
    /// Whether there were any.
    Marks,
    /// How many there were.
    Counts,
    /// How many there were, not counting those near a ray's ends or above flat ground.
    RuledCounts,
}

impl SceneWork {
    /// Of so many points, the sweeps taken to be alike, and of the keyframes that are wanted.
    pub fn new(
        scene: &Scene,
        points: u64,
        wanted: &[&Keyframe],
        rules: &Rules,
        evidence: bool,
    ) -> Self {
        let (points, keyframes) = (points as f64, wanted.len() as f64);
        let a_sweep = points / scene.sweeps.len().max(1) as f64;
        let labelled = scene.sweeps.iter().filter(|sweep| sweep.labelled).count() as f64;
        let [rays, near_rays, spread_m] = rays(scene, wanted, rules);
        let (size, extent) = (rules.spec.size_m(), rules.spec.max_m() - rules.spec.min_m());
        let middle = wanted.get(wanted.len() / 2);
        let [looks, curved_looks] = middle.map_or([0.0; 2], |at| looks(scene, at, rules));
        Self {
            sweeps: scene.sweeps.len() as f64,
            points,
            labelled_points: a_sweep * labelled,
            keyframes,
            rays: a_sweep * rays,
            near_rays: a_sweep * near_rays,
            spread_m,
            steps: a_sweep * near_rays * steps_a_ray(&rules.spec),
            object_rays: a_sweep * object_rays(scene, wanted, rules),
            objects: rules.rays().settings.object_rays,
            casting: casting(rules, evidence),
            voxel_size_m: libm::cbrt(size.product()),
            area_m2: extent.x * extent.y,
            voxels: keyframes * rules.spec.len() as f64,
            looks: keyframes * looks,
            curved_looks: keyframes * curved_looks,
            camera_rays: rules.occlusion.rays,
            pixels: keyframes * pixels(scene, rules),
            evidence,
        }
    }
}

/// Pairs of a keyframe and a sweep that serves it, the same by how near they are, and how far from the
/// middle of the grid the near ones are.
fn rays(scene: &Scene, wanted: &[&Keyframe], rules: &Rules) -> [f64; 3] {
    let lidars: Vec<_> = scene.sweeps.iter().map(|sweep| sweep.world_from_lidar()).collect();
    let (mut pairs, mut near, mut away_m) = (0.0, 0.0, 0.0);
    for keyframe in wanted {
        let world_from_grid = rules.world_from_grid(scene.reference_sweep(keyframe));
        let grid_from_world = world_from_grid.inverse();
        for (sweep, lidar) in scene.sweeps.iter().zip(&lidars) {
            if sweep.time.seconds_apart(keyframe.time) <= rules.window.window_s {
                let at = grid_from_world * Point3::from(lidar.translation.vector);
                let nearness = nearness(&rules.spec, &at);
                pairs += 1.0;
                near += nearness;
                away_m += nearness * off_middle_m(&rules.spec, &at);
            }
        }
    }
    [pairs, near, if near > 0.0 { away_m / near } else { 0.0 }]
}

/// 1 in the middle of a grid, 0 where no ray comes from: linear in the distance along x or y.
fn nearness(spec: &GridSpec, at: &Point3<f64>) -> f64 {
    (1.0 - off_middle_m(spec, at) / (half_m(spec) + REACH_M)).max(0.0)
}

/// How far from the middle of a grid, along x or y.
fn off_middle_m(spec: &GridSpec, at: &Point3<f64>) -> f64 {
    let away = (at - nalgebra::center(&spec.min_m(), &spec.max_m())).abs();
    away.x.max(away.y)
}

/// Rays to points of tracks that stand in the grid, in points of a mean sweep.
fn object_rays(scene: &Scene, wanted: &[&Keyframe], rules: &Rules) -> f64 {
    scene.tracks.iter().map(|track| rays_of_track(scene, wanted, track, rules)).sum()
}

fn rays_of_track(scene: &Scene, wanted: &[&Keyframe], track: &BoxTrack, rules: &Rules) -> f64 {
    let Some(class) = track.class() else { return 0.0 };
    let deforms = rules.window.deformable.contains(class);
    let (window_s, fill) = match deforms {
        true => (rules.window.deformable_window_s.min(rules.window.window_s), BODY_FILL),
        false => (rules.window.window_s, 1.0),
    };
    let seen = |sweep: &SweepHeader| {
        Some((sweep.time, share(sweep, &box_at(track, sweep.time, &rules.boxes)?.0)))
    };
    let seen: Vec<(Timestamp, f64)> = scene.sweeps.iter().filter_map(seen).collect();
    let standing = wanted.iter().filter(|keyframe| is_in_grid(scene, keyframe, track, rules));
    let of_keyframe = |keyframe: &&Keyframe| -> f64 {
        let serves = |time: Timestamp| time.seconds_apart(keyframe.time) <= window_s;
        seen.iter().filter(|(time, _)| serves(*time)).map(|(_, share)| share).sum()
    };
    standing.map(of_keyframe).sum::<f64>() * fill
}

/// The share of a lidar's view that a box takes.
fn share(sweep: &SweepHeader, boxed: &Box3) -> f64 {
    let lidar = sweep.world_from_lidar().translation.vector;
    let away_m = (boxed.world_from_box.translation.vector - lidar).norm().max(NEAREST_M);
    let (width, height) = ((boxed.size_m.x + boxed.size_m.y) / 2.0, boxed.size_m.z);
    width * height / (away_m * away_m) / LIDAR_SR
}

/// Whether a track stands in the grid of a keyframe.
fn is_in_grid(scene: &Scene, keyframe: &Keyframe, track: &BoxTrack, rules: &Rules) -> bool {
    let at = box_at(track, keyframe.time, &rules.boxes);
    let Some((boxed, _)) = at.filter(|(_, source)| *source != BoxSource::Extrapolated) else {
        return false;
    };
    let grid_from_world = rules.world_from_grid(scene.reference_sweep(keyframe)).inverse();
    let at = grid_from_world * Point3::from(boxed.world_from_box.translation.vector);
    off_middle_m(&rules.spec, &at) <= half_m(&rules.spec)
}

/// Voxels that a ray enters whose lidar stands in the middle of the grid.
fn steps_a_ray(spec: &GridSpec) -> f64 {
    let (half, size) = (half_m(spec), spec.size_m());
    half * HALF_OUT_M / (half + HALF_OUT_M) * (1.0 / size.x + 1.0 / size.y) / 2.0
}

/// Half of the mean of width and length.
fn half_m(spec: &GridSpec) -> f64 {
    let extent = spec.max_m() - spec.min_m();
    (extent.x + extent.y) / 4.0
}

fn casting(rules: &Rules, evidence: bool) -> CastingCost {
    let RaySettings { source, ignore_near_hit_m, ignore_near_origin_m, flat_ignore_dz_m, .. } =
        *rules.rays().settings;
    if source == RaySource::Camera {
        CastingCost::Nothing
    } else if ignore_near_hit_m.max(ignore_near_origin_m).max(flat_ignore_dz_m) > 0.0 {
        CastingCost::RuledCounts
    } else if evidence || rules.states.crossings() == Crossings::HowMany {
        CastingCost::Counts
    } else {
        CastingCost::Marks
    }
}

/// Voxels that the cameras of a keyframe have in view, by the middles of some blocks: of cameras without
/// distortion, and of the others.
fn looks(scene: &Scene, keyframe: &Keyframe, rules: &Rules) -> [f64; 2] {
    let (spec, [nx, ny, nz]) = (&rules.spec, LOOKS.map(|n| n as f64));
    let extent = spec.max_m() - spec.min_m();
    let size = [extent.x / nx, extent.y / ny, extent.z / nz];
    let Ok(blocks) = GridSpec::new(spec.min_m().into(), spec.max_m().into(), size) else {
        return [0.0; 2];
    };
    let grid_from_world = rules.world_from_grid(scene.reference_sweep(keyframe)).inverse();
    let mut looks = [0.0; 2];
    for eye in open_eyes(scene, keyframe, &grid_from_world) {
        let seen = in_view(std::slice::from_ref(&eye), &blocks, rules.occlusion.depth_max_m);
        let count: f64 = seen.values().iter().map(|&seen| f64::from(seen)).sum();
        looks[usize::from(is_curved(&eye))] += count * spec.len() as f64 / blocks.len() as f64;
    }
    looks
}

fn is_curved(eye: &Eye) -> bool {
    !matches!(eye.camera.model, CameraModel::Pinhole(_))
}

/// Pixels of all cameras that rays are cast through.
fn pixels(scene: &Scene, rules: &Rules) -> f64 {
    if rules.occlusion.rays != CameraRays::Pixels {
        return 0.0;
    }
    let cameras = scene.cameras.iter().map(|named| &named.camera);
    let all = cameras.map(|camera| f64::from(camera.width) * f64::from(camera.height));
    let stride = rules.occlusion.pixel_stride as f64;
    all.sum::<f64>() / (stride * stride)
}
