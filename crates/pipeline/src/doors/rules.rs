//! Any configuration that is let pass, over a small grid.

use std::sync::LazyLock;

use occlabel_annotate::GhostClasses;
use occlabel_occlusion::{CameraRays, Occluders};
use occlabel_raycast::{Conflict, ObjectRays, Outside, RaySource};
use occlabel_voxelize::Vote;

use super::bytes::Bytes;
use super::texts::TAXONOMY;
use crate::config::{EgoBox, EgoWord, NoLimit};
use crate::{Config, GridFrame, Limit, Rules, VoxelSize, check, preset};

static BASE: LazyLock<Config> =
    LazyLock::new(|| Config::parse(preset("precise").unwrap(), "").unwrap());

/// What decides the labels.
pub(super) fn any_rules(bytes: &mut Bytes) -> Option<Rules> {
    let mut config = BASE.clone();
    put_grid(&mut config, bytes);
    put_points(&mut config, bytes);
    put_rays(&mut config, bytes);
    put_cameras(&mut config, bytes);
    check::check(&config).ok()?;
    Rules::new(&config, TAXONOMY.clone()).ok()
}

fn put_grid(config: &mut Config, bytes: &mut Bytes) {
    let grid = &mut config.grid;
    let sizes = [(); 3].map(|()| bytes.of([0.4, 0.25, 1.0, 3.0, 0.1]));
    let shape = [(); 3].map(|()| 1.0 + bytes.below(14) as f64);
    grid.frame = bytes.of([GridFrame::Ego, GridFrame::Lidar]);
    grid.voxel_size_m = VoxelSize::Sides(sizes);
    grid.min_m = std::array::from_fn(|axis| -sizes[axis] * bytes.below(16) as f64);
    grid.max_m = std::array::from_fn(|axis| grid.min_m[axis] + sizes[axis] * shape[axis]);
}

fn put_points(config: &mut Config, bytes: &mut Bytes) {
    config.boxes.max_gap_s = bytes.of([1.6, 0.0, 1e9]);
    config.boxes.extrapolate_s = bytes.of([0.6, 0.0, 1e9]);
    let aggregate = &mut config.aggregate;
    aggregate.ego_box_m = match bytes.flag() {
        true => EgoBox::Corners { min: [-1.0; 3], max: [1.0, 1.0, 2.0] },
        false => EgoBox::Word(EgoWord::None),
    };
    aggregate.max_range_m = bytes.of([1000.0, 5.0, 1e5]);
    aggregate.box_scale = bytes.of([1.0, 1.1, 1e-3, 1e3]);
    aggregate.box_margin_m = bytes.of([0.1, 0.0, 10.0]);
    aggregate.window_s = bytes.of([1000.0, 0.0, 0.3]);
    aggregate.deformable_window_s = bytes.of([0.25, 0.0, 1000.0]);
    aggregate.radius_m =
        bytes.of([Limit::Lifted(NoLimit::None), Limit::AtMost(0.0), Limit::AtMost(10.0)]);
    let relabel = &mut config.relabel;
    relabel.k = bytes.of([5, 1, 2, 300]);
    relabel.max_distance_m =
        bytes.of([Limit::AtMost(1.0), Limit::AtMost(0.0), Limit::Lifted(NoLimit::None)]);
    relabel.unknown_class = bytes.of(["drop", "car", "driveable_surface"]).into();
    relabel.drop_ghosts =
        bytes.of([GhostClasses::Movers, GhostClasses::Things, GhostClasses::None]);
    config.voxelize.vote = bytes.of([Vote::Majority, Vote::MoversFirst]);
}

fn put_rays(config: &mut Config, bytes: &mut Bytes) {
    let rays = &mut config.raycast;
    rays.source = bytes.of([RaySource::Lidar, RaySource::Camera]);
    rays.outside = bytes.of([Outside::Clip, Outside::Drop]);
    rays.ignore_near_hit_m = bytes.of([0.0, 0.5, 1e6]);
    rays.ignore_near_origin_m = bytes.of([0.0, 0.5, 1e6]);
    rays.flat_ignore_dz_m = bytes.of([0.0, 0.3, 1e6]);
    rays.object_rays = bytes.of([ObjectRays::Own, ObjectRays::Current, ObjectRays::Hits]);
    rays.same_time_s = bytes.of([0.05, 0.0, 1e6]);
    let states = &mut config.states;
    states.occupied_min_hits = bytes.of([1, 2, u32::MAX]);
    states.free_min_crossings = bytes.of([1, 3, u32::MAX]);
    states.conflict = bytes.of([Conflict::OccupiedWins, Conflict::Ratio]);
    states.min_hit_ratio = bytes.of([0.1, 0.0, 1.0]);
}

fn put_cameras(config: &mut Config, bytes: &mut Bytes) {
    let occlusion = &mut config.occlusion;
    let rays = [CameraRays::AllCenters, CameraRays::OccupiedCenters, CameraRays::Pixels];
    occlusion.rays = bytes.of(rays);
    occlusion.occluders = bytes.of([Occluders::All, Occluders::NonFlat]);
    occlusion.pixel_stride = bytes.of([1, 2, 7, usize::MAX]);
    occlusion.depth_max_m = bytes.of([100.0, 1.0, 1e5, 1e-3]);
}
