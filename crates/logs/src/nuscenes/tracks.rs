//! The tracks of a scene.

use std::collections::{BTreeMap, HashSet};

use nalgebra::Vector3;
use occlabel_core::{Box3, BoxTrack, Fault, Loss, Timestamp, TrackId};

use super::NuScenesLog;
use super::keyframes::KeySweeps;
use super::number::plain;
use super::pose::QuaternionOrder;
use super::rows::{Category, Instance, SampleAnnotation};
use super::table::{Row, Table, repeated};
use super::tables::SceneRows;
use crate::notes::Notes;

/// An instance's boxes, as they come.
struct Boxes<'a> {
    category: &'a str,
    boxes: Vec<(Timestamp, Box3, &'a Row<SampleAnnotation>)>,
}

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
    let instances = boxes_by_instance(log, rows, keys, notes)?;
    check_categories(log, &rows.name, &instances, notes)?;
    let mut tracks = Vec::with_capacity(instances.len());
    for (source_id, instance) in instances {
        let id = TrackId(track_number(tracks.len() + 1, &rows.name)?);
        let category = instance.category.to_owned();
        let Some(meaning) = log.options.read.box_meaning(&category) else { continue };
        let boxes = in_order(instance.boxes)?;
        tracks.push(BoxTrack { id, source_id, category, meaning, boxes });
    }
    Ok(tracks)
}

fn boxes_by_instance<'a>(
    log: &'a NuScenesLog,
    rows: &'a SceneRows,
    keys: &KeySweeps<'_>,
    notes: &mut Notes,
) -> Result<BTreeMap<String, Boxes<'a>>, Fault> {
    let tables = &log.tables;
    let mut instances: BTreeMap<String, Boxes<'a>> = BTreeMap::new();
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
            let track = instances.entry(row.instance_token.to_string());
            let track = track.or_insert_with(|| Boxes { category, boxes: Vec::new() });
            track.boxes.push((time, boxed, row));
        }
    }
    Ok(instances)
}

/// A box as it stands in the table: width, length, height on disk.
fn read_box(
    row: &Row<SampleAnnotation>,
    order: QuaternionOrder,
    notes: &mut Notes,
) -> Result<Box3, Fault> {
    let [width, length, height] = plain(&row.size);
    if ![width, length, height].iter().all(|side| side.is_finite() && *side > 0.0) {
        let found = format!("{width} x {length} x {height} m");
        return Err(row.fault("box-size", "width, length and height above 0", found));
    }
    let size_m = Vector3::new(length, width, height);
    Ok(Box3 { world_from_box: row.pose(order, notes)?, size_m })
}

fn in_order(
    mut boxes: Vec<(Timestamp, Box3, &Row<SampleAnnotation>)>,
) -> Result<Vec<(Timestamp, Box3)>, Fault> {
    boxes.sort_by_key(|(time, _, row)| (*time, row.offset));
    if let Some(pair) = boxes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let (first, second) = (pair[0].2, pair[1].2);
        let found = format!("`{}` at the same time", first.token);
        return Err(second.fault("track-time", "one box of a track at a time", found));
    }
    Ok(boxes.into_iter().map(|(time, boxed, _)| (time, boxed)).collect())
}

fn track_number(number: usize, scene: &str) -> Result<u16, Fault> {
    u16::try_from(number).map_err(|_| {
        let expected = format!("at most {} tracks in a scene", u16::MAX);
        Fault::new("track-count", Instance::FILE, expected, "more").record(scene)
    })
}

/// Refuses or notes the categories that the taxonomy does not name, with how many boxes are theirs.
fn check_categories(
    log: &NuScenesLog,
    scene: &str,
    instances: &BTreeMap<String, Boxes<'_>>,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let mut unknown: BTreeMap<&str, usize> = BTreeMap::new();
    let is_unknown =
        |track: &&Boxes<'_>| !log.options.read.taxonomy.boxes.contains_key(track.category);
    for track in instances.values().filter(is_unknown) {
        *unknown.entry(track.category).or_default() += track.boxes.len();
    }
    if unknown.is_empty() {
        return Ok(());
    }
    let list = |(name, count): (&&str, &usize)| format!("`{name}` of {count} boxes");
    let found = unknown.iter().map(list).collect::<Vec<_>>().join(", ");
    let fault = Fault::new("unknown-category", Category::FILE, "categories of the taxonomy", found);
    notes.warn(log.options.read.unknown(fault.record(scene))?);
    Ok(())
}
