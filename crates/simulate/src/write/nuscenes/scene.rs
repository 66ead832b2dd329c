//! One drive as a scene of the log.

use occlabel_core::{Fault, Keyframe, Timestamp};
use serde_json::json;

use crate::Drive;
use crate::write::files::Output;
use crate::write::raw_names::RawNames;
use crate::write::written::{Images, Written};

use super::calibrations::push_calibrations;
use super::captures::write_sweeps;
use super::images::write_images;
use super::shared::push_log;
use super::tables::{Tables, neighbours};
use super::tracks::push_tracks;

pub(super) fn write_scene(
    drive: &Drive,
    names: &RawNames,
    images: Images,
    tables: &mut Tables,
    output: &Output,
) -> Result<Written, Fault> {
    let scene = drive.scene();
    push_log(tables, &scene.name)?;
    push_samples(tables, drive)?;
    push_calibrations(tables, drive, output)?;
    let swept = write_sweeps(drive, names, tables, output)?;
    let boxes = push_tracks(tables, drive, &swept.hits)?;
    let images = write_images(drive, images, tables, output)?;
    Ok(Written {
        scenes: 1,
        sweeps: scene.sweeps.len(),
        labelled: scene.sweeps.iter().filter(|sweep| sweep.labelled).count(),
        points: swept.points,
        keyframes: scene.keyframes.len(),
        boxes,
        images,
    })
}

/// A keyframe's token: its time in nanoseconds ends it.
pub(in crate::write) fn sample_token(scene: &str, keyframe: &Keyframe) -> String {
    format!("{scene}-{}", keyframe.time.0)
}

/// The sample that something between keyframes belongs to: the next one, at last the last one.
pub(super) fn sample_at(drive: &Drive, time: Timestamp) -> String {
    let scene = drive.scene();
    let next = scene.keyframes.partition_point(|keyframe| keyframe.time < time);
    sample_token(&scene.name, &scene.keyframes[next.min(scene.keyframes.len() - 1)])
}

pub(super) fn micros(time: Timestamp) -> i64 {
    time.0 / 1000
}

fn push_samples(tables: &mut Tables, drive: &Drive) -> Result<(), Fault> {
    let scene = drive.scene();
    let (Some(first), Some(last)) = (scene.keyframes.first(), scene.keyframes.last()) else {
        return Err(Fault::new("world", "keyframe_hz", "at least one keyframe", "none"));
    };
    let token = |at: usize| sample_token(&scene.name, &scene.keyframes[at]);
    let row = json!({
        "token": scene.name, "log_token": scene.name, "nbr_samples": scene.keyframes.len(),
        "first_sample_token": sample_token(&scene.name, first),
        "last_sample_token": sample_token(&scene.name, last), "name": scene.name,
        "description": "a drive through an exactly known world",
    });
    tables.push("scene", &row)?;
    for (at, keyframe) in scene.keyframes.iter().enumerate() {
        let [prev, next] = neighbours(at, scene.keyframes.len(), token);
        let row = json!({
            "token": token(at), "timestamp": micros(keyframe.time), "prev": prev, "next": next,
            "scene_token": scene.name,
        });
        tables.push("sample", &row)?;
    }
    Ok(())
}
