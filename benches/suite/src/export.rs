//! A keyframe and its scene for other programs.
//!
//! | file | holds |
//! |---|---|
//! | `points.f64`, `classes.u8` | `[n][3]` world, metres; the class of each. No boxes: all is background |
//! | `origins.f64`, `starts.u64` | `[m][3]`, the lidar at each sweep; `[m + 1]`, where its points begin |
//! | `rays.f64`, `ray_starts.u64` | `[k][2][3]`, origin and end in the grid frame, of rays that end in the grid, from every fourth sweep; where each such sweep begins |
//! | `labelled.f64`, `labelled.u8` | labelled points, and their classes |
//! | `queries.f64`, `queries.u8` | unlabelled points of every twelfth sweep, and the classes that we give them |
//! | `keyframe.json` | the grid, its pose, the cameras |

use nalgebra::Point3;
use occlabel_annotate::{RelabelSettings, relabel};
use occlabel_core::camera::CameraModel;
use occlabel_core::{
    AggregatedScene, BackgroundSweep, ClassId, ClassSet, Exposure, Keyframe, PointCloud, Pose,
    RigidMap,
};
use occlabel_pipeline::Rules;
use serde_json::{Value, json};

use crate::args::Args;
use crate::exported::Exported;
use crate::peer::voted;
use crate::stages::{one_thread, sorted};
use crate::world::OpenLog;

/// Of rays, every so many-th sweep: the slowest peer has to come to an end.
const RAY_STRIDE: usize = 4;
/// Of queries.
const QUERY_STRIDE: usize = 12;

type Sorted = AggregatedScene<Option<ClassId>>;

/// Writes everything into a folder.
pub(crate) fn run(args: &Args) {
    one_thread();
    let folder = Exported::at(args.folder());
    let log = without_boxes(&args.world);
    let rules = log.rules("precise");
    let sorted = sorted(&log, &rules);
    put_neighbours(&folder, &sorted);
    let aggregated = relabel(sorted, &rules.relabel(&log.scene));
    put_points(&folder, &aggregated);
    let grid_from_world = grid_from_world(&log, &rules);
    put_rays(&folder, &aggregated, &rules, &grid_from_world);
    let text = serde_json::to_string_pretty(&describe(&log, &rules)).expect("numbers");
    folder.put("keyframe.json", text.as_bytes());
}

/// A world's log as if nothing in it had a box: other programs have no words for what moves.
pub(crate) fn without_boxes(world: &str) -> OpenLog {
    let mut log = OpenLog::open(world, &[]);
    log.scene.tracks.clear();
    log
}

/// The keyframe that is exported: the middle one.
pub(crate) fn keyframe(log: &OpenLog) -> &Keyframe {
    &log.scene.keyframes[log.scene.keyframes.len() / 2]
}

/// As `occ3d-nuscenes` has it: five neighbours, however far.
pub(crate) fn neighbours() -> RelabelSettings {
    RelabelSettings { k: 5, max_distance_m: None, unknown: None, ghosts: ClassSet::default() }
}

fn grid_from_world(log: &OpenLog, rules: &Rules) -> Pose {
    rules.world_from_grid(log.scene.reference_sweep(keyframe(log))).inverse()
}

fn put_neighbours(folder: &Exported, sorted: &Sorted) {
    let points = |sweep: &BackgroundSweep<Option<ClassId>>| -> Vec<_> {
        let cloud = &sweep.cloud;
        cloud.positions.iter().copied().zip(cloud.labels.iter().copied()).collect()
    };
    let labelled = || sorted.background.iter().flat_map(points).filter_map(|(p, l)| Some((p, l?)));
    folder.put_points("labelled.f64", labelled().map(|(position, _)| position));
    folder.put("labelled.u8", &labelled().map(|(_, class)| class.0).collect::<Vec<u8>>());
    let some = sorted.background.iter().step_by(QUERY_STRIDE).flat_map(points);
    folder.put_points("queries.f64", some.filter(|(_, l)| l.is_none()).map(|(p, _)| p));
    let classes = voted(folder);
    folder.put("queries.u8", &classes.iter().map(|class| class.0).collect::<Vec<u8>>());
}

fn put_points(folder: &Exported, scene: &AggregatedScene<ClassId>) {
    let clouds = || scene.background.iter().map(|sweep| &sweep.cloud);
    folder.put_points("points.f64", clouds().flat_map(|cloud| cloud.positions.iter().copied()));
    let classes = clouds().flat_map(|cloud| cloud.labels.iter().map(|class| class.0));
    folder.put("classes.u8", &classes.collect::<Vec<u8>>());
    folder.put_points("origins.f64", clouds().map(|cloud| cloud.origins[0]));
    folder.put_starts("starts.u64", clouds().map(PointCloud::len));
}

fn put_rays(
    folder: &Exported,
    scene: &AggregatedScene<ClassId>,
    rules: &Rules,
    grid_from_world: &Pose,
) {
    let place = RigidMap::from(grid_from_world);
    let rays_of = |sweep: &BackgroundSweep<ClassId>| -> Vec<[Point3<f64>; 2]> {
        let origin = place.apply(&sweep.cloud.origins[0]);
        let ends = sweep.cloud.positions.iter().map(|position| place.apply(position));
        ends.filter(|end| rules.spec.flat_of(end).is_some()).map(|end| [origin, end]).collect()
    };
    let rays: Vec<_> = scene.background.iter().step_by(RAY_STRIDE).map(rays_of).collect();
    folder.put_points("rays.f64", rays.iter().flatten().flatten().copied());
    folder.put_starts("ray_starts.u64", rays.iter().map(Vec::len));
}

fn describe(log: &OpenLog, rules: &Rules) -> Value {
    let (spec, grid_from_world) = (&rules.spec, grid_from_world(log, rules));
    let camera = |exposure: &Exposure| {
        let camera = &log.scene.cameras[exposure.camera].camera;
        let CameraModel::Pinhole(pinhole) = &camera.model else { panic!("pinholes only") };
        let grid_from_camera = grid_from_world * exposure.world_from_camera;
        json!({
            "matrix": pinhole.intrinsics().matrix(),
            "width": camera.width,
            "height": camera.height,
            "grid_from_camera": rows(&grid_from_camera),
        })
    };
    json!({
        "min_m": <[f64; 3]>::from(spec.min_m()),
        "voxel_size_m": spec.size_m().x,
        "shape": spec.shape(),
        "grid_from_world": rows(&grid_from_world),
        "classes": rules.taxonomy.names.len(),
        "depth_max_m": rules.occlusion.depth_max_m,
        "cameras": keyframe(log).exposures.iter().map(camera).collect::<Vec<_>>(),
    })
}

fn rows(pose: &Pose) -> [[f64; 4]; 4] {
    pose.to_homogeneous().transpose().into()
}
