//! Once per scene: every sweep sorted, every point labelled.

use occlabel_aggregate::{SplitSweep, TrackBox, accumulate, keep_timeless, split_sweep};
use occlabel_annotate::{BoxSettings, BoxSource, box_at, relabel};
use occlabel_core::{
    AggregatedScene, BoxTrack, ClassId, PointCloud, PointLabel, PointsOf, Scene, Sweep,
    SweepHeader, Timestamp,
};
use rayon::prelude::*;

use crate::{MaskedExposures, Rules, Stage, paint_scene};

/// Reads, sorts, sums and relabels the sweeps of a scene. Parallel over sweeps, then over points.
///
/// `read` gives the points of a sweep, or none if the sweep is to be left out; `enter` is told which
/// stage begins.
///
/// # Errors
/// The first error of `read`, in the order of sweeps.
pub fn aggregate_scene<E: Send>(
    scene: &Scene,
    rules: &Rules,
    read: impl Fn(&SweepHeader) -> Result<Option<PointCloud<PointLabel>>, E> + Sync,
    enter: impl FnMut(Stage),
) -> Result<AggregatedScene<ClassId>, E> {
    aggregate_painted_scene(scene, rules, read, &MaskedExposures::none(), enter)
}

/// The same for a scene whose cameras have masks: its points are painted before they are relabelled.
///
/// # Errors
/// The first error of `read`, in the order of sweeps, else that of reading a mask.
pub fn aggregate_painted_scene<E: Send>(
    scene: &Scene,
    rules: &Rules,
    read: impl Fn(&SweepHeader) -> Result<Option<PointCloud<PointLabel>>, E> + Sync,
    masks: &MaskedExposures<E>,
    mut enter: impl FnMut(Stage),
) -> Result<AggregatedScene<ClassId>, E> {
    enter(Stage::Aggregate);
    let accumulated = sort_scene(scene, rules, read)?;
    enter(Stage::Relabel);
    let painted = paint_scene(scene, accumulated, rules, masks)?;
    Ok(relabel(painted, &rules.relabel(scene)))
}

/// Reads, sorts and sums the sweeps of a scene; labels are as logged. Parallel over sweeps.
///
/// # Errors
/// The first error of `read`, in the order of sweeps.
pub fn sort_scene<E: Send>(
    scene: &Scene,
    rules: &Rules,
    read: impl Fn(&SweepHeader) -> Result<Option<PointCloud<PointLabel>>, E> + Sync,
) -> Result<AggregatedScene<Option<ClassId>>, E> {
    let split_one = |header| -> Result<_, E> {
        Ok(read(header)?.map(|cloud| split_one(scene, rules, &Sweep { header, cloud })))
    };
    let sorted: Vec<_> = scene.sweeps.par_iter().map(split_one).collect();
    let sorted = sorted.into_iter().collect::<Result<Vec<_>, E>>()?;
    Ok(accumulate(sorted.into_iter().flatten()))
}

fn split_one(scene: &Scene, rules: &Rules, sweep: &Sweep) -> SplitSweep {
    let header = sweep.header;
    match header.points_of {
        PointsOf::Moment | PointsOf::Nothing => {
            split_sweep(sweep, &boxes_at(&scene.tracks, header, rules), &rules.split)
        }
        PointsOf::World => keep_timeless(sweep, None),
        PointsOf::Track(id) => keep_timeless(sweep, Some(&scene.tracks[usize::from(id.0) - 1])),
    }
}

/// The boxes that sort a sweep's points, extrapolated ones included.
pub fn boxes_at(tracks: &[BoxTrack], header: &SweepHeader, rules: &Rules) -> Vec<TrackBox> {
    track_boxes(tracks, header.time, &rules.boxes).map(|(boxed, _)| boxed).collect()
}

/// The boxes of the tracks that stand at a time: annotated or interpolated.
pub(crate) fn standing_boxes(tracks: &[BoxTrack], time: Timestamp, rules: &Rules) -> Vec<TrackBox> {
    track_boxes(tracks, time, &rules.boxes)
        .filter(|(_, source)| *source != BoxSource::Extrapolated)
        .map(|(boxed, _)| boxed)
        .collect()
}

pub(crate) fn track_boxes(
    tracks: &[BoxTrack],
    time: Timestamp,
    settings: &BoxSettings,
) -> impl Iterator<Item = (TrackBox, BoxSource)> {
    tracks.iter().filter_map(move |track| {
        let (boxed, source) = box_at(track, time, settings)?;
        Some((TrackBox { track: track.id, class: track.class(), boxed }, source))
    })
}
