//! The tracks of a scene.

use std::collections::HashSet;

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss};

use super::NuScenesLog;
use super::keyframes::KeySweeps;
use super::number::plain;
use super::pose::QuaternionOrder;
use super::rows::{Category, SampleAnnotation};
use super::table::{Row, Table, repeated};
use super::tables::SceneRows;
use crate::notes::Notes;
use crate::tracks::{TrackBox, TrackBoxes, checked_size};

/// The tracks of a scene, 1..N in byte order of their instances' tokens. A box that is none is
/// refused; a track that has no other is left out.
///
/// # Errors
/// If a token names no row or is there twice, a track has two boxes at one time, a category is
/// unknown, or there are more than 65535 tracks.
pub(super) fn scene_tracks(
    log: &NuScenesLog,
    rows: &SceneRows,
    keys: &KeySweeps<'_>,
    notes: &mut Notes,
) -> Result<Vec<BoxTrack>, Fault> {
    let tracks = boxes_by_instance(log, rows, keys, notes)?;
    let tracks = tracks.tracks(&log.options.read, Category::FILE, notes);
    tracks.map_err(|fault| fault.record(&rows.name))
}

fn boxes_by_instance(
    log: &NuScenesLog,
    rows: &SceneRows,
    keys: &KeySweeps<'_>,
    notes: &mut Notes,
) -> Result<TrackBoxes, Fault> {
    let tables = &log.tables;
    let mut tracks = TrackBoxes::default();
    let mut tokens = HashSet::new();
    for row in &rows.annotations {
        if !tokens.insert(&row.token) {
            return Err(row.located(repeated::<SampleAnnotation>()));
        }
        let instance = row.follow(&tables.instances, &row.instance_token)?;
        let category = &instance.follow(&tables.categories, &instance.category_token)?.name;
        let Some(time) = keys.time(&row.sample_token) else { continue };
        let boxed = read_box(row, log.options.quaternion_order, notes);
        if let Some(boxed) = notes.accept(Loss::Annotation, boxed) {
            let row_of = TrackBox { track: &row.instance_token.to_string(), category, time, boxed };
            tracks.add(row_of, notes, |rule, expected, found| row.fault(rule, expected, found))?;
        }
    }
    Ok(tracks)
}

/// A box as it stands in the table: width, length, height on disk.
fn read_box(
    row: &Row<SampleAnnotation>,
    order: QuaternionOrder,
    notes: &mut Notes,
) -> Result<Box3, Fault> {
    let [width, length, height] = plain(&row.size);
    let size_m = checked_size(Vector3::new(length, width, height)).map_err(|_| {
        let found = format!("{width} x {length} x {height} m");
        row.fault("box-size", "width, length and height above 0", found)
    })?;
    Ok(Box3 { world_from_box: row.pose(order, notes)?, size_m })
}
