//! A keyframe, stage by stage.

use std::ops::ControlFlow;

use nalgebra::Point3;
use occlabel_aggregate::{Moment, TrackBox, compose};
use occlabel_annotate::{BoxSource, box_at};
use occlabel_core::{
    AggregatedScene, BoxTrack, ClassId, GridSpec, Instant, Keyframe, RayCounts, RigidMap, Scene,
    VoxelGrid, walk,
};
use occlabel_occlusion::{Eye, Matter, matter};
use occlabel_pipeline::Rules;
use occlabel_raycast::{Casting, classify, count};
use occlabel_voxelize::voxelize;

/// The keyframe's instant.
pub(crate) fn instant<'a>(
    scene: &Scene,
    aggregated: &'a AggregatedScene<ClassId>,
    keyframe: &Keyframe,
    rules: &Rules,
) -> Instant<'a> {
    let reference = scene.reference_sweep(keyframe);
    let grid_from_world = rules.world_from_grid(reference).inverse();
    let stands = |track: &BoxTrack| {
        let (boxed, source) = box_at(track, keyframe.time, &rules.boxes)?;
        let standing = TrackBox { track: track.id, class: track.class(), boxed };
        (source != BoxSource::Extrapolated).then_some(standing)
    };
    let moment = Moment {
        time: keyframe.time,
        grid_from_world,
        ego: reference.world_from_ego * Point3::origin(),
        reference_lidar: grid_from_world * reference.world_from_lidar() * Point3::origin(),
        standing: &scene.tracks.iter().filter_map(stands).collect::<Vec<_>>(),
    };
    compose(aggregated, &moment, &rules.window)
}

/// What stops the sight of cameras.
pub(crate) fn matter_at(instant: &Instant, rules: &Rules) -> VoxelGrid<Matter> {
    let ground = &rules.taxonomy.flat;
    let votes = voxelize(instant, &rules.spec, &rules.votes());
    let counts = cast(instant, rules);
    matter(&classify(&counts, &votes, ground, &rules.states), &votes, ground)
}

/// Counts the rays on one thread, as far as the labels need it.
pub(crate) fn cast(instant: &Instant, rules: &Rules) -> RayCounts {
    cast_into(instant, &rules.spec, rules)
}

/// The same into another grid than that of the rules.
pub(crate) fn cast_into(instant: &Instant, spec: &GridSpec, rules: &Rules) -> RayCounts {
    count(instant, spec, &rules.rays(), &Casting::new(rules.states.crossings(), 1))
}

/// The keyframe's cameras.
pub(crate) fn eyes<'a>(scene: &'a Scene, keyframe: &Keyframe, instant: &Instant) -> Vec<Eye<'a>> {
    let eye = |exposure: &occlabel_core::Exposure| Eye {
        bit: exposure.camera,
        camera: &scene.cameras[exposure.camera].camera,
        grid_from_camera: instant.grid_from_world * exposure.world_from_camera,
    };
    keyframe.exposures.iter().map(eye).collect()
}

/// Counts the rays of the background one by one, as a world without near rules has it.
pub(crate) fn walk_background(instant: &Instant, spec: &GridSpec) -> RayCounts {
    let place = RigidMap::from(&instant.grid_from_world);
    let (mut hits, mut crossings) = (VoxelGrid::filled(spec, 0), VoxelGrid::filled(spec, 0));
    for sweep in &instant.background {
        for (i, position) in sweep.cloud.positions.iter().enumerate() {
            let end = spec.snap(&place.apply(position));
            let origin = spec.snap(&place.apply(&sweep.cloud.origin(i)));
            if let Some(flat) = spec.flat(end.voxel()) {
                hits.values_mut()[flat] += 1;
            }
            walk(spec, end, origin, |flat, _| {
                crossings.values_mut()[flat] += 1;
                ControlFlow::Continue(())
            });
        }
    }
    RayCounts { hits, crossings }
}

/// How often rays entered a voxel of the grid, hits included.
pub(crate) fn visits(counts: &RayCounts) -> u64 {
    let all = counts.hits.values().iter().chain(counts.crossings.values());
    all.map(|&count| u64::from(count)).sum()
}
