//! Poses from columns of a table.

use std::collections::BTreeMap;
use std::path::Path;

use occlabel_core::{Fault, Pose};

use super::table::Table;
use crate::transform::pose_from_quaternion;

/// Rotation, w first, and place, metres.
const COLUMNS: [&str; 7] = ["qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"];

/// Where the sensors of a log are mounted.
#[derive(Debug)]
pub(super) struct Mountings {
    file: String,
    by_name: BTreeMap<String, Result<Pose, String>>,
}

impl Mountings {
    /// Reads them from the log's calibration.
    ///
    /// # Errors
    /// If the file cannot be used.
    pub(super) fn read(root: &Path, file: String) -> Result<Self, Fault> {
        let table = Table::read(root, &file)?;
        let by_name = table.texts("sensor_name")?.into_iter().zip(poses(&table)?).collect();
        Ok(Self { file, by_name })
    }

    /// `ego_from_sensor`.
    ///
    /// # Errors
    /// If the sensor is not named, or its pose is none.
    pub(super) fn pose(&self, name: &str) -> Result<Pose, Fault> {
        let pose = self.by_name.get(name).cloned().unwrap_or_else(|| Err("none".into()));
        let expected = format!("a pose of {name}");
        pose.map_err(|found| Fault::new("av2-sensor", &self.file, expected, found))
    }
}

/// The poses of a table's rows: each, or what was found in its place.
pub(super) fn poses(table: &Table) -> Result<Vec<Result<Pose, String>>, Fault> {
    let columns: Vec<Vec<f64>> =
        COLUMNS.iter().map(|name| table.reals(name)).collect::<Result<_, _>>()?;
    let row = |at: usize| {
        let [w, x, y, z, tx, ty, tz] = [0, 1, 2, 3, 4, 5, 6].map(|column| columns[column][at]);
        pose_from_quaternion([w, x, y, z], [tx, ty, tz])
    };
    Ok((0..columns[0].len()).map(row).collect())
}
