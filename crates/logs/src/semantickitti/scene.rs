//! A scene from its sequence: the reader's conductor.

use std::path::Path;

use occlabel_core::{Fault, Loss, PointsOf, Scene, SweepHeader};
use occlabel_disk as disk;

use super::LIDAR;
use super::sequences::{Sequence, label_file};
use super::tables::Tables;
use crate::ReadOptions;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;

/// Everything of a scene but its points (labels.md section 2).
///
/// A scan that has a line of poses.txt but no file is a sweep all the same: a missing one. One that
/// has no pose or no time is refused.
///
/// # Errors
/// If the sequence's name cannot be that of a folder, or one of its text files cannot be used.
pub(super) fn build_scene(
    root: &Path,
    options: &ReadOptions,
    sequence: &Sequence,
) -> Result<Scene, Fault> {
    let name = &sequence.name;
    if !is_folder_name(name) {
        let expected = "a folder's name of A-Z, a-z, 0-9, `.`, `_` and `-`";
        return Err(Fault::new("scene-name", name, expected, format!("`{name}`")));
    }
    let tables = Tables::read(root, sequence)?;
    let mut notes = Notes::default();
    let mut scans = sequence.scans(root)?;
    scans.extend(0..tables.posed());
    let header = |scan| sweep_header(root, sequence, &tables, scan);
    let mut sweeps: Vec<SweepHeader> =
        scans.into_iter().filter_map(|scan| notes.accept(Loss::Keyframe, header(scan))).collect();
    report_order(&sweeps, &sequence.times(), &mut notes);
    sweeps.sort_by(|a, b| (a.time, &a.file).cmp(&(b.time, &b.file)));
    let keyframes = keyframes(&options.keyframes, name, &sweeps, |_| false, &[], &notes)?;
    let (warnings, refused) = notes.finish();
    Ok(Scene { name: name.clone(), sweeps, keyframes, warnings, refused, ..Scene::default() })
}

fn sweep_header(
    root: &Path,
    sequence: &Sequence,
    tables: &Tables,
    scan: usize,
) -> Result<SweepHeader, Fault> {
    let mut header = SweepHeader {
        time: tables.time(scan)?,
        lidar: LIDAR.to_owned(),
        source_id: format!("{}/{scan:06}", sequence.name),
        file: sequence.scan(scan),
        world_from_ego: tables.world_from_ego(scan)?,
        ego_from_lidar: tables.ego_from_lidar,
        labelled: false,
        points_of: PointsOf::Moment,
    };
    header.labelled = label_file(&header).is_some_and(|file| disk::is_file(&root.join(file)));
    Ok(header)
}

/// Notes times that do not grow from scan to scan.
fn report_order(sweeps: &[SweepHeader], file: &str, notes: &mut Notes) {
    for pair in sweeps.windows(2) {
        let step_s = pair[1].time.seconds_since(pair[0].time);
        if step_s <= 0.0 {
            let found = format!("a step of {step_s} s");
            let fault = Fault::new("sweep-order", file, "a later time at each scan", found);
            notes.warn(fault.record(&pair[1].source_id));
        }
    }
}
