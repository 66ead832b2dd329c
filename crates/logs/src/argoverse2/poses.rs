//! Poses from columns of a table.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Fault, Pose};

use super::table::Table;

/// How far a quaternion's norm may be off 1.
const LARGEST_ERROR: f64 = 1e-2;
/// Rotation, w first, and place, metres.
const COLUMNS: [&str; 7] = ["qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m"];

/// The poses of a table's rows: each, or what was found in its place.
pub(super) fn poses(table: &Table) -> Result<Vec<Result<Pose, String>>, Fault> {
    let columns: Vec<Vec<f64>> =
        COLUMNS.iter().map(|name| table.reals(name)).collect::<Result<_, _>>()?;
    let row = |at: usize| pose([0, 1, 2, 3, 4, 5, 6].map(|column| columns[column][at]));
    Ok((0..columns[0].len()).map(row).collect())
}

fn pose([w, x, y, z, tx, ty, tz]: [f64; 7]) -> Result<Pose, String> {
    let rotation = Quaternion::new(w, x, y, z);
    let norm = rotation.norm();
    if ![tx, ty, tz, norm].iter().all(|number| number.is_finite()) {
        return Err("a number that is not finite".into());
    }
    if (norm - 1.0).abs() > LARGEST_ERROR {
        return Err(format!("a quaternion of norm {norm}"));
    }
    Ok(Pose::from_parts(Translation3::new(tx, ty, tz), UnitQuaternion::new_normalize(rotation)))
}
