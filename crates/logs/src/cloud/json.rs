//! JSON files of a scene.

use std::path::Path;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use occlabel_core::{Fault, Pose};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::files::read_file;
use crate::transform::is_place;

/// A quaternion's norm may be off by this much; more tells no rotation.
const LARGEST_NORM_ERROR: f64 = 1e-2;

/// What every placement has to be.
pub(super) const A_PLACEMENT: &str = "metres up to 1e9, and a quaternion of norm 1";

/// A place and a turn, as nuScenes writes them: metres, and w, x, y, z.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Placement {
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
}

/// Reads a file.
///
/// # Errors
/// If it is absent, no JSON, or of another shape.
pub(super) fn read_json<T: DeserializeOwned>(root: &Path, file: &str) -> Result<T, Fault> {
    let bytes = read_file(root, file)?;
    serde_json::from_slice(&bytes).map_err(|error| {
        Fault::new("cloud-json", file, "JSON as docs/cloud.md has it", error.to_string())
    })
}

impl Placement {
    /// As a pose, its rotation made exactly one.
    ///
    /// # Errors
    /// What was found, if it is none.
    pub(super) fn pose(&self) -> Result<Pose, String> {
        let [w, x, y, z] = self.rotation;
        let turn = Quaternion::new(w, x, y, z);
        if !is_place(&self.translation) {
            return Err(format!("a place {:?}", self.translation));
        }
        if (turn.norm() - 1.0).abs() <= LARGEST_NORM_ERROR {
            let turn = UnitQuaternion::new_normalize(turn);
            return Ok(Pose::from_parts(Translation3::from(self.translation), turn));
        }
        Err(format!("a quaternion of norm {}", turn.norm()))
    }
}
