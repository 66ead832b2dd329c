//! Where the rays of RayIoU begin.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Point3;
use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, ScenePoses};
use occlabel_evaluate::rays::choose_origins;

/// Where rays begin, keyframe by keyframe.
pub(crate) enum RayOrigins {
    /// Where the lidar was over the scene.
    Poses(ScenePoses),
    /// As a file says, by token.
    Told(BTreeMap<String, Vec<[f64; 3]>>),
}

impl RayOrigins {
    /// The origins of a file, or else those that the manifest of a label set tells; `None` if neither
    /// is there.
    pub(crate) fn find(file: Option<&Path>, set: &Path) -> Result<Option<Self>, Fault> {
        match file {
            Some(file) => Ok(Some(Self::Told(read(file)?))),
            None => Ok(ScenePoses::of_folder(set)?.map(Self::Poses)),
        }
    }

    /// Of a keyframe, in its grid frame, metres: those near enough, and of these as many as RayIoU
    /// takes.
    pub(crate) fn of(&self, key: &KeyframeKey) -> Result<Vec<Point3<f64>>, Fault> {
        let origins = match self {
            Self::Poses(poses) => poses.lidar_origins(&key.scene, &key.token),
            Self::Told(told) => {
                told.get(&key.token).map(|of| of.iter().map(|&p| p.into()).collect())
            }
        };
        let unknown = || {
            let found = format!("none of `{}`", key.token);
            Fault::new("ray-origins", "RayIoU", "origins of rays for every keyframe", found)
        };
        origins.map(|origins| choose_origins(&origins)).ok_or_else(unknown)
    }
}

fn read(file: &Path) -> Result<BTreeMap<String, Vec<[f64; 3]>>, Fault> {
    let fault = |found: String| {
        let expected = "JSON {\"TOKEN\": [[x, y, z], ...]}";
        Fault::new("ray-origins", file.display().to_string(), expected, found)
    };
    let text = std::fs::read_to_string(file).map_err(|error| fault(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| fault(error.to_string()))
}
