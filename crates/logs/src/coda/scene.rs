//! A scene from its sequence: the reader's conductor.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{Fault, Loss, PointsOf, Pose, Scene, SweepHeader};

use super::LIDAR;
use super::cameras::read_cameras;
use super::frames::Frames;
use super::sequence::Sequence;
use super::tracks::read_tracks;
use crate::ReadOptions;
use crate::files::is_folder_name;
use crate::keyframes::keyframes;
use crate::notes::Notes;

/// Everything of a scene but its points (labels.md section 2).
///
/// A frame that has a pose but no points is a sweep all the same: a missing one. One that has no pose or
/// no time is refused.
///
/// # Errors
/// If the sequence's name cannot be that of a folder, its times or poses cannot be read, or its boxes
/// contradict themselves or the taxonomy.
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
    let mut notes = Notes::default();
    let by_frame = read_sweeps(root, sequence, &mut notes)?;
    report_turning(sequence, &mut notes);
    let (tracks, annotated) = read_tracks(root, sequence, options, &by_frame, &mut notes)?;
    let (cameras, exposures) = read_cameras(root, sequence, &by_frame, &mut notes)?;
    let mut sweeps: Vec<SweepHeader> = by_frame.into_values().collect();
    report_order(&sweeps, &mut notes);
    sweeps.sort_by(|a, b| (a.time, &a.file).cmp(&(b.time, &b.file)));
    let is_annotated = |sweep: &SweepHeader| annotated.contains(&sweep.time);
    let keyframes = keyframes(&options.keyframes, name, &sweeps, is_annotated, &exposures, &notes)?;
    let (warnings, refused) = notes.finish();
    let name = name.to_owned();
    Ok(Scene { name, sweeps, tracks, cameras, keyframes, exposures, warnings, refused })
}

/// The sweeps by frame.
fn read_sweeps(
    root: &Path,
    sequence: &Sequence,
    notes: &mut Notes,
) -> Result<BTreeMap<usize, SweepHeader>, Fault> {
    let frames = Frames::read(root, sequence)?;
    let labelled = sequence.labelled_frames(root)?;
    let mut numbers = sequence.frames(root)?;
    numbers.extend(0..frames.posed());
    let mut sweeps = BTreeMap::new();
    for frame in numbers {
        let pose = frames.world_from_lidar(frame, notes);
        let placed = pose.and_then(|pose| Ok((frames.time(frame)?, pose)));
        let Some((time, world_from_lidar)) = notes.accept(Loss::Keyframe, placed) else { continue };
        let header = SweepHeader {
            time,
            lidar: LIDAR.to_owned(),
            source_id: format!("{}/{frame}", sequence.name),
            file: sequence.points(frame),
            world_from_ego: world_from_lidar,
            ego_from_lidar: Pose::identity(),
            labelled: labelled.contains(&frame),
            points_of: PointsOf::Moment,
        };
        sweeps.insert(frame, header);
    }
    Ok(sweeps)
}

/// Notes that points stand where they were measured while the lidar turned.
fn report_turning(sequence: &Sequence, notes: &mut Notes) {
    if !sequence.is_compensated() {
        let expected = format!("3d_comp/{LIDAR}/{}", sequence.name);
        let found = "3d_raw alone: points are taken as if measured at one time";
        notes.warn(Fault::new("sweep-motion", &sequence.name, expected, found));
    }
}

/// Notes times that do not grow from frame to frame.
fn report_order(sweeps: &[SweepHeader], notes: &mut Notes) {
    for pair in sweeps.windows(2) {
        let step_s = pair[1].time.seconds_since(pair[0].time);
        if step_s <= 0.0 {
            let found = format!("a step of {step_s} s");
            let fault =
                Fault::new("sweep-order", "timestamps", "a later time at each frame", found);
            notes.warn(fault.record(&pair[1].source_id));
        }
    }
}
