//! What a scene does not have, and what that makes of its labels.

use std::collections::BTreeSet;

use occlabel_core::{Fault, Scene};
use occlabel_pipeline::{Config, PaintTable, RaySource};

/// A word about each kind of record that a scene goes without: none of them keeps it from being
/// labelled.
pub(crate) fn lacks(scene: &Scene, config: &Config) -> Vec<Fault> {
    let lacks = [no_labels(scene, config), few_boxes(scene, config), few_exposures(scene, config)];
    lacks.into_iter().flatten().collect()
}

fn no_labels(scene: &Scene, config: &Config) -> Option<Fault> {
    let class = &config.relabel.unknown_class;
    let found = format!("none: what no box covers becomes `{class}`");
    let fault = Fault::new("no-labels", "point labels", "labels on some sweeps", found);
    let is_painted = config.paint.masks != PaintTable::NONE;
    (!scene.has_point_labels() && !is_painted).then_some(fault)
}

fn few_boxes(scene: &Scene, config: &Config) -> Option<Fault> {
    let times: BTreeSet<_> =
        scene.tracks.iter().flat_map(|track| &track.boxes).map(|(time, _)| time).collect();
    let expected = "boxes of tracks at several times";
    match times.len() {
        0 => {
            let found = "none: what moves stays where each sweep saw it";
            let fault = Fault::new("no-boxes", "boxes", expected, found);
            Some(fault.hint(
                "aggregate.window_s shortens trails, states.conflict = \"ratio\" clears them",
            ))
        }
        1 if scene.sweeps.len() > 1 => {
            let span_s = config.boxes.extrapolate_s;
            let found =
                format!("one: they serve the sweeps within {span_s} s (boxes.extrapolate_s)");
            Some(Fault::new("boxes-at-one-time", "boxes", expected, found))
        }
        _ => None,
    }
}

fn few_exposures(scene: &Scene, config: &Config) -> Option<Fault> {
    let blind = scene.keyframes.iter().filter(|keyframe| keyframe.exposures.is_empty()).count();
    let all = scene.keyframes.len();
    let found = match config.raycast.source {
        _ if blind == all => "none at any keyframe: mask_camera is all 0".to_owned(),
        RaySource::Camera if blind > 0 => {
            format!("none at {blind} of {all} keyframes, of which nothing is observed")
        }
        RaySource::Camera | RaySource::Lidar => return None,
    };
    Some(Fault::new("no-cameras", "cameras", "exposures of cameras", found))
}
