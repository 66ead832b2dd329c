//! A dialect: everything in which label sets differ, as data.

use serde::{Deserialize, Serialize};

use crate::ClassTable;

/// Everything in which a label set differs from another.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dialect {
    /// Its published grid.
    pub grid: DialectGrid,
    /// Its classes.
    pub classes: ClassTable,
    /// Where a keyframe's files stand, and what is in them.
    pub layout: toml::Table,
}

/// The grid that a dialect's files were published with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DialectGrid {
    /// `ego` or `lidar`.
    pub frame: String,
    /// Lower corner, metres.
    pub min_m: [f64; 3],
    /// Upper corner, metres.
    pub max_m: [f64; 3],
    /// Voxel size, metres.
    pub voxel_size_m: [f64; 3],
}
