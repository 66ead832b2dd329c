//! The points of a file, as stages want them.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Point3;
use occlabel_core::{Fault, PointCloud, PointLabel, TrackId};

use super::classes::Classes;
use super::columns::{Column, Row};
use super::point_file::PointFile;
use super::surfels::{Covered, SurfelRules};
use crate::raw_labels::RawLabels;
use crate::{ReadOptions, SweepPoints, UnknownLabels};

/// How a scene's files of points are read.
pub(super) struct PointRules<'a> {
    pub(super) options: &'a ReadOptions,
    pub(super) surfels: &'a SurfelRules,
    pub(super) classes: &'a Classes,
    /// By their numbers in files: the tracks of the scene; none for those that it lacks.
    pub(super) tracks: &'a [Option<TrackId>],
}

/// What a file holds: points of no track, and of each track.
#[derive(Clone, Debug)]
pub(super) struct FilePoints {
    pub(super) of_none: PointCloud<PointLabel>,
    pub(super) of_tracks: BTreeMap<TrackId, PointCloud<PointLabel>>,
    warnings: Vec<Fault>,
    unknown: UnknownLabels,
}

/// Surfels that were left out, of how many.
#[derive(Default)]
struct LeftOut {
    thin: u64,
    huge: u64,
    of: u64,
}

impl FilePoints {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, or its points have labels or tracks that nothing names.
    pub(super) fn read(root: &Path, file: &str, rules: &PointRules) -> Result<Self, Fault> {
        let mut labels = RawLabels::new(rules.options, |raw| rules.classes.name(raw));
        let (mut points, mut left_out, mut stray) = (Self::none(), LeftOut::default(), None);
        PointFile::open(root, file)?.read(|row| {
            let covered = rules.surfels.covered(row);
            left_out.count(&covered);
            let label = match rules.classes.raw(row.get(Column::Class)) {
                Some(raw) => labels.label(raw),
                None => PointLabel::Unlabelled,
            };
            match rules.track(row) {
                Ok(track) => points.cloud_of(track).take(covered, label),
                Err(number) => stray = stray.or(Some(number)),
            }
        })?;
        if let Some(number) = stray {
            let expected = format!("0, or the place of a track of {}", rules.tracks.len());
            return Err(Fault::new("cloud-track", file, expected, number.to_string()));
        }
        points.unknown = labels.finish(file, &mut points.warnings)?;
        points.warnings.extend(left_out.faults(file, rules.surfels));
        Ok(points)
    }

    fn none() -> Self {
        let (warnings, unknown) = (Vec::new(), UnknownLabels::default());
        Self { of_none: empty(), of_tracks: BTreeMap::new(), warnings, unknown }
    }

    /// The points of no track, and all that was odd.
    pub(super) fn background(self) -> SweepPoints {
        SweepPoints { cloud: self.of_none, warnings: self.warnings, unknown: self.unknown }
    }

    fn cloud_of(&mut self, track: Option<TrackId>) -> &mut PointCloud<PointLabel> {
        match track {
            None => &mut self.of_none,
            Some(track) => self.of_tracks.entry(track).or_insert_with(empty),
        }
    }
}

fn empty() -> PointCloud<PointLabel> {
    PointCloud::with_origins(vec![Point3::origin()])
}

/// How many points a file becomes at most; none if it cannot be read, which reading will tell.
pub(super) fn count_points(root: &Path, file: &str, surfels: &SurfelRules) -> u64 {
    let Ok(points) = PointFile::open(root, file) else { return 0 };
    if surfels.spacing_m.is_none() || !points.has(Column::Scale0) {
        return points.most_points();
    }
    let mut count = 0;
    let read = points.read(|row| {
        count += match surfels.covered(row) {
            Covered::Point(_) => 1,
            Covered::Ellipse(ellipse) => ellipse.count(),
            Covered::Thin | Covered::Huge => 0,
        }
    });
    read.map_or(0, |()| count)
}

impl PointRules<'_> {
    /// Whose point it is; the number that is nobody's.
    fn track(&self, row: &Row) -> Result<Option<TrackId>, f64> {
        let number = row.get(Column::Track);
        if number.is_nan() || number <= 0.0 {
            return Ok(None);
        }
        match self.tracks.get(number as usize - 1).filter(|_| number.fract() == 0.0) {
            Some(Some(track)) => Ok(Some(*track)),
            _ => Err(number),
        }
    }
}

/// What takes the points that a row of a file stands for.
trait Take {
    fn take(&mut self, covered: Covered, label: PointLabel);
}

impl Take for PointCloud<PointLabel> {
    fn take(&mut self, covered: Covered, label: PointLabel) {
        match covered {
            Covered::Point(position) => self.push(position, label, 0),
            Covered::Ellipse(ellipse) => {
                ellipse.points().for_each(|position| self.push(position, label, 0));
            }
            Covered::Thin | Covered::Huge => {}
        }
    }
}

impl LeftOut {
    fn count(&mut self, covered: &Covered) {
        self.of += 1;
        match covered {
            Covered::Thin => self.thin += 1,
            Covered::Huge => self.huge += 1,
            Covered::Point(_) | Covered::Ellipse(_) => {}
        }
    }

    fn faults(&self, file: &str, rules: &SurfelRules) -> Vec<Fault> {
        let least = rules.settings.min_opacity;
        let told = [
            (self.thin, "surfel-opacity", format!("an opacity of at least {least}")),
            (self.huge, "surfel-size", "surfels that reach at most 20 m".to_owned()),
        ];
        let fault = |(count, rule, expected): (u64, &'static str, String)| {
            let found = format!("less of {count} of {} surfels, which are left out", self.of);
            let found =
                if rule == "surfel-size" { found.replacen("less", "more", 1) } else { found };
            (count > 0).then(|| Fault::new(rule, file, expected, found))
        };
        told.into_iter().filter_map(fault).collect()
    }
}
