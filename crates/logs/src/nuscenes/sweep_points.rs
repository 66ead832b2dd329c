//! The points of a sweep with their labels.

use std::io::BufReader;

use occlabel_core::{Fault, LIDAR_ORIGIN, PointCloud, PointLabel, SweepHeader};

use super::NuScenesLog;
use super::label_files::{LabelEncoding, LabelFile};
use super::label_names::label_names;
use super::npz::{NpzDefect, read_data};
use super::token::Token;
use crate::files::{open_file, read_file};
use crate::points::decode_points;
use crate::raw_labels::RawLabels;
use crate::{SweepPoints, UnknownLabels};

/// A panoptic label is this many times the raw label, plus an instance's number.
const PANOPTIC_STEP: u16 = 1000;

/// The points of a sweep as logged, with what their raw labels mean. Lidar frame.
///
/// # Errors
/// If a file is absent, is no whole number of points, or has another number of labels than there are
/// points; or if a label has no meaning.
pub(super) fn read_sweep_points(
    log: &NuScenesLog,
    sweep: &SweepHeader,
) -> Result<SweepPoints, Fault> {
    let located = |fault: Fault| match fault.record {
        None => fault.record(sweep_name(log, sweep)),
        Some(_) => fault,
    };
    Ok(labelled_points(log, sweep).map_err(located)?.located(located))
}

fn sweep_name(log: &NuScenesLog, sweep: &SweepHeader) -> String {
    let scene = log.tables.scene_of(&Token::from(sweep.source_id.as_str()));
    format!("{}, sweep {}", scene.unwrap_or("no scene"), sweep.source_id)
}

fn labelled_points(log: &NuScenesLog, sweep: &SweepHeader) -> Result<SweepPoints, Fault> {
    let bytes = read_file(&log.root, &sweep.file)?;
    let (positions, mut warnings) = decode_points(&bytes, &sweep.file, log.options.columns)?;
    let (labels, unknown) = match log.label_file(sweep) {
        Some(file) => read_labels(log, file, positions.len(), &mut warnings)?,
        None => (vec![PointLabel::Unlabelled; positions.len()], UnknownLabels::default()),
    };
    let cloud = PointCloud::from_one_origin(LIDAR_ORIGIN, positions, labels);
    Ok(SweepPoints { cloud, warnings, unknown })
}

/// One label for each of `count` points, and the unknown ones among them.
fn read_labels(
    log: &NuScenesLog,
    file: &LabelFile,
    count: usize,
    warnings: &mut Vec<Fault>,
) -> Result<(Vec<PointLabel>, UnknownLabels), Fault> {
    let known = label_names(log)?;
    let name = |raw| u16::try_from(raw).ok().and_then(|raw| known.get(&raw).copied());
    let name = |raw| Some(name(raw).unwrap_or("no category").to_owned());
    let mut names = RawLabels::new(&log.options.read, name);
    let raw = read_raw(log, file, count)?;
    Ok((names.labels(raw), names.finish(&file.file, warnings)?))
}

fn read_raw(log: &NuScenesLog, file: &LabelFile, count: usize) -> Result<Vec<u16>, Fault> {
    match file.encoding {
        LabelEncoding::Lidarseg => {
            let bytes = read_file(&log.root, &file.file)?;
            match bytes.len() == count {
                true => Ok(bytes.into_iter().map(u16::from).collect()),
                false => Err(wrong_count(file, count, bytes.len())),
            }
        }
        LabelEncoding::Panoptic => {
            let npz = open_file(&log.root.join(&file.file), &file.file)?;
            let values = read_data(BufReader::new(npz), count);
            let values = values.map_err(|defect| bad_npz(file, count, defect))?;
            Ok(values.into_iter().map(|value| value / PANOPTIC_STEP).collect())
        }
    }
}

fn wrong_count(file: &LabelFile, points: usize, labels: usize) -> Fault {
    let expected = format!("{points} labels for {points} points");
    Fault::new("label-count", &file.file, expected, format!("{labels} labels"))
}

fn bad_npz(file: &LabelFile, points: usize, defect: NpzDefect) -> Fault {
    match defect {
        NpzDefect::Count(labels) => wrong_count(file, points, labels),
        NpzDefect::Format(found) => {
            Fault::new("label-file", &file.file, "an npz with a 16-bit array `data`", found)
        }
    }
}
