//! Small worlds around a small grid.

use occlabel_core::{GridSpec, Pose, Taxonomy, VoxelGrid, VoxelTruth};
use occlabel_pipeline::{parse_taxonomy, shipped_taxonomy};
use occlabel_simulate::{Drive, TrueRays, TruthAt, TruthSettings, World, keyframe_truth};
use proptest::prelude::ProptestConfig;

pub(crate) const SETTINGS: TruthSettings =
    TruthSettings { window_s: 1000.0, deformable_window_s: 0.25, sight_depth_m: Some(100.0) };

pub(crate) fn taxonomy() -> Taxonomy {
    parse_taxonomy(shipped_taxonomy("occ3d-nuscenes").unwrap(), "occ3d-nuscenes").unwrap()
}

/// Random cases that leave no files.
pub(crate) fn quiet(cases: u32) -> ProptestConfig {
    ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases) }
}

/// Two keyframes, ten sweeps, an ego that stands at the origin; `ground_m` below.
pub(crate) fn head(ground_m: f64) -> String {
    format!(
        r#"
        name = "truth"
        duration_s = 1.0
        taxonomy = "occ3d-nuscenes"
        keyframe_hz = 2.0
        [ground]
        height_m = {ground_m:?}
        bands = [{{ class = "flat.driveable_surface" }}]
        [ego]
        trajectory.straight = {{ start = {{ x_m = 0.0, y_m = 0.0 }}, speed_mps = 0.0 }}
        "#
    )
}

/// A lidar `up_m` above the ground that fires ahead, left, back and right, level.
pub(crate) fn lidar(up_m: f64) -> String {
    format!(
        r#"
        [[lidar]]
        name = "LIDAR_TOP"
        mounting = {{ position_m = [0.0, 0.0, {up_m:?}], yaw_rad = {:?} }}
        pattern.spinning = {{ beams.elevations-rad = [0.0], azimuths = 4 }}
        rate_hz = 10.0
        max_range_m = 60.0
        "#,
        -0.3 * std::f64::consts::FRAC_PI_2
    )
}

pub(crate) fn solid(class: &str, position_m: [f64; 3], shape: &str) -> String {
    format!("[[static]]\nclass = \"{class}\"\npose.position_m = {position_m:?}\nshape.{shape}\n")
}

pub(crate) fn mover(
    name: &str,
    category: &str,
    size_m: [f64; 3],
    trajectory: &str,
    parts: &str,
) -> String {
    format!(
        "[[mover]]\nname = \"{name}\"\ncategory = \"{category}\"\nsize_m = {size_m:?}\n\
         lift_m = 0.0\ntrajectory.{trajectory}\n{parts}\n"
    )
}

pub(crate) fn drive(text: &str) -> Drive {
    let world = World::parse(text, "truth.toml").unwrap_or_else(|fault| panic!("{fault}\n{text}"));
    Drive::new(world, &taxonomy()).unwrap_or_else(|fault| panic!("{fault}"))
}

pub(crate) fn grid(min_m: [f64; 3], max_m: [f64; 3], size_m: f64) -> GridSpec {
    GridSpec::new(min_m, max_m, [size_m; 3]).unwrap()
}

pub(crate) fn truth_at(
    drive: &Drive,
    keyframe: usize,
    spec: &GridSpec,
    world_from_grid: Pose,
) -> VoxelGrid<VoxelTruth> {
    let at = TruthAt { keyframe: &drive.scene().keyframes[keyframe], spec, world_from_grid };
    keyframe_truth(drive, &TrueRays::cast(drive), &at, &SETTINGS, None)
}

/// The truth of a world whose grid stands in world.
pub(crate) fn truth_of(text: &str, keyframe: usize, spec: &GridSpec) -> VoxelGrid<VoxelTruth> {
    truth_at(&drive(text), keyframe, spec, Pose::identity())
}

pub(crate) fn count(truth: &VoxelGrid<VoxelTruth>, holds: impl Fn(&VoxelTruth) -> bool) -> usize {
    truth.values().iter().filter(|voxel| holds(voxel)).count()
}
