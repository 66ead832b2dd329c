//! The table files, written row by row: however large they grow, none is held in memory.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use occlabel_core::{Fault, Pose};
use serde_json::Value;

use crate::write::files::{Output, OutputFile};

use super::VERSION;

/// The tables that every log has.
const TABLES: [&str; 13] = [
    "attribute",
    "calibrated_sensor",
    "category",
    "ego_pose",
    "instance",
    "log",
    "map",
    "sample",
    "sample_annotation",
    "sample_data",
    "scene",
    "sensor",
    "visibility",
];

/// nuScenes' own add-on: there is none in a log without point labels.
const LIDARSEG: &str = "lidarseg";

/// The open tables: a JSON array each, a row a line.
pub(super) struct Tables {
    files: BTreeMap<&'static str, (OutputFile, &'static str)>,
}

impl Tables {
    pub(super) fn create(output: &Output, labels: bool) -> Result<Self, Fault> {
        let names = TABLES.into_iter().chain(labels.then_some(LIDARSEG));
        let open = |name| Ok((name, (output.stream(&format!("{VERSION}/{name}.json"))?, "[\n")));
        Ok(Self { files: names.map(open).collect::<Result<_, Fault>>()? })
    }

    /// Adds a row to a table; does nothing if the log has no such table.
    pub(super) fn push(&mut self, table: &str, row: &Value) -> Result<(), Fault> {
        let Some((file, separator)) = self.files.get_mut(table) else { return Ok(()) };
        file.write(separator.as_bytes())?;
        *separator = ",\n";
        file.write(row.to_string().as_bytes())
    }

    pub(super) fn finish(self) -> Result<(), Fault> {
        self.files.into_values().try_for_each(|(mut file, separator)| {
            file.write(if separator == "[\n" { b"[]\n" } else { b"\n]\n" })?;
            file.finish()
        })
    }
}

/// A translation as tables have it.
pub(super) fn translation(pose: &Pose) -> [f64; 3] {
    pose.translation.vector.into()
}

/// A rotation as tables have it: w, x, y, z.
pub(super) fn rotation(pose: &Pose) -> [f64; 4] {
    let [x, y, z, w] = pose.rotation.coords.into();
    [w, x, y, z]
}

/// A box's size as tables have it: width, length, height.
pub(super) fn size(size_m: &Vector3<f64>) -> [f64; 3] {
    [size_m.y, size_m.x, size_m.z]
}

/// The tokens before and after the `at`-th of so many, empty at the ends.
pub(super) fn neighbours(at: usize, count: usize, token: impl Fn(usize) -> String) -> [String; 2] {
    let prev = at.checked_sub(1).map(&token).unwrap_or_default();
    let next = if at + 1 < count { token(at + 1) } else { String::new() };
    [prev, next]
}
