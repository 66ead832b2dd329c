//! The boxes of a scene.

use std::collections::BTreeMap;

use occlabel_core::{Box3, BoxTrack, Fault, Keyframe};
use serde_json::json;

use crate::Drive;

use super::scene::sample_token;
use super::shared::VISIBLE;
use super::tables::{Tables, neighbours, rotation, size, translation};

/// Adds the rows of all tracks; `hits` tells by sweep and mover how many returns it has. Gives the
/// number of boxes.
pub(super) fn push_tracks(
    tables: &mut Tables,
    drive: &Drive,
    hits: &BTreeMap<(usize, usize), usize>,
) -> Result<usize, Fault> {
    let scene = drive.scene();
    let mut count = 0;
    for track in &scene.tracks {
        let mover = drive.world().movers.iter().position(|mover| mover.name == track.source_id);
        let returns = |keyframe: &Keyframe| {
            mover.and_then(|mover| hits.get(&(keyframe.sweep, mover))).copied().unwrap_or_default()
        };
        push_track(tables, drive, track, returns)?;
        count += track.boxes.len();
    }
    Ok(count)
}

/// A keyframe's token and returns, and the box there.
struct Annotation<'a> {
    token: String,
    sample: String,
    returns: usize,
    boxed: &'a Box3,
}

fn push_track(
    tables: &mut Tables,
    drive: &Drive,
    track: &BoxTrack,
    returns: impl Fn(&Keyframe) -> usize,
) -> Result<(), Fault> {
    let scene = drive.scene();
    // Byte order of tokens is that of the movers' names.
    let instance = format!("{}-{}", scene.name, track.source_id);
    let annotations = track.boxes.iter().filter_map(|(time, boxed)| {
        let keyframe = scene.keyframes.iter().find(|keyframe| keyframe.time == *time)?;
        let token = format!("{instance}-{}", time.0);
        let sample = sample_token(&scene.name, keyframe);
        Some(Annotation { token, sample, returns: returns(keyframe), boxed })
    });
    let annotations: Vec<_> = annotations.collect();
    let (Some(first), Some(last)) = (annotations.first(), annotations.last()) else {
        return Ok(());
    };
    let row = json!({
        "token": instance, "category_token": track.category, "nbr_annotations": annotations.len(),
        "first_annotation_token": first.token, "last_annotation_token": last.token,
    });
    tables.push("instance", &row)?;
    push_annotations(tables, &instance, &annotations)
}

fn push_annotations(
    tables: &mut Tables,
    instance: &str,
    annotations: &[Annotation<'_>],
) -> Result<(), Fault> {
    let token = |at: usize| annotations[at].token.clone();
    for (at, annotation) in annotations.iter().enumerate() {
        let [prev, next] = neighbours(at, annotations.len(), token);
        let world_from_box = &annotation.boxed.world_from_box;
        let row = json!({
            "token": annotation.token, "sample_token": annotation.sample,
            "instance_token": instance, "visibility_token": VISIBLE, "attribute_tokens": [],
            "translation": translation(world_from_box), "rotation": rotation(world_from_box),
            "size": size(&annotation.boxed.size_m), "prev": prev, "next": next,
            "num_lidar_pts": annotation.returns, "num_radar_pts": 0,
        });
        tables.push("sample_annotation", &row)?;
    }
    Ok(())
}
