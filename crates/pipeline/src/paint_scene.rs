//! Once per scene: points without a label take the classes that masks show.

use std::collections::BTreeMap;
use std::sync::Arc;

use occlabel_annotate::{PaintSettings, View, paint};
use occlabel_core::{
    AggregatedScene, BackgroundSweep, ClassId, ClassMask, Exposure, ObjectSweep, Scene, Timestamp,
    nearest_exposure_within,
};
use rayon::prelude::*;

use crate::Rules;
use crate::aggregate_scene::track_boxes;

/// Reads the mask of an exposure, from any thread; none if it is to be left out.
type ReadMask<'a, E> = dyn Fn(&Exposure) -> Result<Option<Arc<ClassMask>>, E> + Sync + 'a;

/// The exposures that have a mask, and how to read it.
pub struct MaskedExposures<'a, E> {
    /// Of each camera its exposures that have a mask, in order of time.
    pub exposures: Vec<Vec<Exposure>>,
    /// Reads the mask of one.
    pub read: Box<ReadMask<'a, E>>,
}

impl<E> MaskedExposures<'_, E> {
    /// No camera has any.
    pub fn none() -> Self {
        Self { exposures: Vec::new(), read: Box::new(|_| Ok(None)) }
    }
}

/// Paints the background of a scene, each sweep by the exposures nearest to it in time. Parallel over
/// sweeps. Nothing happens without `[paint]`, nor to points that are of no time.
///
/// # Errors
/// The first error of reading a mask, in the order of sweeps.
pub fn paint_scene<E: Send>(
    scene: &Scene,
    sorted: AggregatedScene<Option<ClassId>>,
    rules: &Rules,
    masks: &MaskedExposures<E>,
) -> Result<AggregatedScene<Option<ClassId>>, E> {
    let Some(settings) = &rules.paint else { return Ok(sorted) };
    let mut objects: BTreeMap<Option<Timestamp>, Vec<&ObjectSweep>> = BTreeMap::new();
    sorted.objects.iter().for_each(|object| objects.entry(object.time).or_default().push(object));
    let paint_one = |sweep: BackgroundSweep<_>| {
        let Some(time) = sweep.time else { return Ok(sweep) };
        let objects = objects.get(&sweep.time).map_or(&[][..], Vec::as_slice);
        let seen = exposures_at(time, &masks.exposures, settings);
        let masks =
            seen.iter().map(|exposure| (masks.read)(exposure)).collect::<Result<Vec<_>, E>>()?;
        let masked =
            seen.iter().zip(&masks).filter_map(|(seen, mask)| Some((*seen, mask.as_deref()?)));
        let views: Vec<View> = masked.map(|(seen, mask)| view(scene, seen, mask, rules)).collect();
        Ok(paint(sweep, objects, &views, settings))
    };
    let painted: Vec<Result<_, E>> = sorted.background.into_par_iter().map(paint_one).collect();
    let background = painted.into_iter().collect::<Result<_, E>>()?;
    Ok(AggregatedScene { background, ..sorted })
}

/// Of each camera the exposure nearest to a time, if it is near enough.
fn exposures_at<'a>(
    time: Timestamp,
    exposures: &'a [Vec<Exposure>],
    settings: &PaintSettings,
) -> Vec<&'a Exposure> {
    let nearest = |of_camera: &'a Vec<Exposure>| {
        nearest_exposure_within(of_camera, |exposure| exposure.time, time, settings.max_dt_s)
    };
    exposures.iter().filter_map(nearest).collect()
}

fn view<'a>(scene: &'a Scene, seen: &Exposure, mask: &'a ClassMask, rules: &Rules) -> View<'a> {
    let boxes = track_boxes(&scene.tracks, seen.time, &rules.boxes);
    View {
        camera: &scene.cameras[seen.camera].camera,
        camera_from_world: seen.world_from_camera.inverse(),
        mask,
        world_from_box: boxes.map(|(at, _)| (at.track, at.boxed.world_from_box)).collect(),
    }
}
