//! What each sensor of a scene recorded.

use std::collections::{BTreeMap, HashSet};

use occlabel_core::{Fault, Timestamp};

use super::rows::{CalibratedSensor, SampleData};
use super::table::{Row, Table, repeated};
use super::tables::{SceneRows, Tables};
use crate::files::name_defect;

/// A row of sample_data, with what its tokens stand for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capture<'a> {
    pub(super) row: &'a Row<SampleData>,
    pub(super) calibration: &'a Row<CalibratedSensor>,
    /// The sensor's channel.
    pub(super) channel: &'a str,
    pub(super) time: Timestamp,
}

impl<'a> Capture<'a> {
    /// What sweeps are ordered by: time, lidar name, file.
    pub(super) fn order(&self) -> (Timestamp, &'a str, &'a str) {
        (self.time, self.channel, &self.row.filename)
    }

    /// Its row.
    pub(super) fn row_of(&self) -> &'a Row<SampleData> {
        self.row
    }
}

/// The captures of a scene by kind of sensor.
#[derive(Debug, Default)]
pub(super) struct Captures<'a> {
    /// Sweeps ordered by (time, lidar name, file).
    pub(super) lidars: Vec<Capture<'a>>,
    /// Images by channel, ordered by time, then token.
    pub(super) cameras: BTreeMap<&'a str, Vec<Capture<'a>>>,
}

impl<'a> Captures<'a> {
    /// Looks up and sorts a scene's captures; those of other sensors are left out.
    ///
    /// # Errors
    /// If a token is there twice, names a row that is not there, or a file lies outside the root.
    pub(super) fn of_scene(tables: &'a Tables, rows: &'a SceneRows) -> Result<Self, Fault> {
        let mut captures = Self::default();
        let mut tokens = HashSet::new();
        for row in &rows.captures {
            if !tokens.insert(&row.token) {
                return Err(row.located(repeated::<SampleData>()));
            }
            captures.add(tables, row)?;
        }
        captures.lidars.sort_by_key(Capture::order);
        for images in captures.cameras.values_mut() {
            images.sort_by_cached_key(|image| (image.time, image.row.token.to_string()));
        }
        Ok(captures)
    }

    fn add(&mut self, tables: &'a Tables, row: &'a Row<SampleData>) -> Result<(), Fault> {
        let calibration = row.follow(&tables.calibrations, &row.calibrated_sensor_token)?;
        let sensor = calibration.follow(&tables.sensors, &calibration.sensor_token)?;
        let (channel, time) = (sensor.channel.as_str(), Timestamp::from_micros(row.timestamp));
        let capture = Capture { row, calibration, channel, time };
        match sensor.modality.as_str() {
            "lidar" => {
                check_time(row)?;
                check_file(row)?;
                self.lidars.push(capture);
            }
            "camera" => self.cameras.entry(channel).or_default().push(capture),
            _ => {}
        }
        Ok(())
    }
}

fn check_file(row: &Row<SampleData>) -> Result<(), Fault> {
    file_fault(&row.filename).map_or(Ok(()), |fault| Err(row.located(fault)))
}

/// What is wrong with the name of a sweep's file, if anything.
pub(super) fn file_fault(name: &str) -> Option<Fault> {
    let defect = name_defect(name)?;
    let found = format!("`{name}`, {defect}");
    Some(Fault::new("file-name", SampleData::FILE, "a path below the log's root", found))
}

/// Later times do not fit into nanoseconds: the year 2262.
const LATEST_MICROS: u64 = i64::MAX as u64 / 1000;

fn check_time(row: &Row<SampleData>) -> Result<(), Fault> {
    if row.timestamp.unsigned_abs() <= LATEST_MICROS {
        return Ok(());
    }
    let fault =
        row.fault("timestamp", "microseconds before the year 2262", row.timestamp.to_string());
    Err(fault.hint("it looks like nanoseconds"))
}
