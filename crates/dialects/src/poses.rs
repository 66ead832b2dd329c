//! Where the lidar was over a scene, seen from one of its keyframes.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Point3;
use occlabel_core::Fault;
use occlabel_labels::{Manifest, PoseRecord};

/// Where ego and lidar stood at the keyframes of scenes.
#[derive(Clone, Debug)]
pub struct ScenePoses {
    /// Whether grids stand in the lidar's frame, not in the ego's.
    in_lidar_frame: bool,
    scenes: BTreeMap<String, Vec<PoseRecord>>,
}

impl ScenePoses {
    /// The poses that the manifest of a folder tells; `None` if there is none, or it tells none.
    ///
    /// # Errors
    /// If the manifest cannot be read.
    pub fn of_folder(folder: &Path) -> Result<Option<Self>, Fault> {
        let manifest = Manifest::load_tree(folder)?;
        Ok(manifest.as_ref().map(Self::of_manifest).filter(|poses| !poses.scenes.is_empty()))
    }

    /// The poses that a manifest tells.
    pub fn of_manifest(manifest: &Manifest) -> Self {
        let told = manifest.scenes.iter().filter(|(_, record)| !record.poses.is_empty());
        Self {
            in_lidar_frame: manifest.grid.frame == "lidar",
            scenes: told.map(|(scene, record)| (scene.clone(), record.poses.clone())).collect(),
        }
    }

    /// The reference lidar's origin at every keyframe of the scene, in order of time, in the grid
    /// frame of one of them, metres; `None` if that one's pose is not known.
    pub fn lidar_origins(&self, scene: &str, token: &str) -> Option<Vec<Point3<f64>>> {
        let poses = self.scenes.get(scene)?;
        let here = poses.iter().find(|pose| pose.token == token)?;
        let grid_from_world = here.world_from_grid(self.in_lidar_frame).inverse();
        let origin =
            |pose: &PoseRecord| grid_from_world * (pose.world_from_grid(true) * Point3::origin());
        Some(poses.iter().map(origin).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use occlabel_labels::RigidRecord;

    fn pose(token: &str, x_m: f64) -> PoseRecord {
        // The ego drives along world's y, turned to the left by a right angle.
        let half = 0.5_f64.sqrt();
        let turned = [half, 0.0, 0.0, half];
        PoseRecord {
            token: token.to_owned(),
            time_ns: 0,
            world_from_ego: RigidRecord { translation: [0.0, x_m, 0.0], rotation: turned },
            ego_from_lidar: RigidRecord {
                translation: [1.0, 0.0, 2.0],
                rotation: [1.0, 0.0, 0.0, 0.0],
            },
        }
    }

    fn poses(in_lidar_frame: bool) -> ScenePoses {
        let poses = vec![pose("a", 0.0), pose("b", 10.0)];
        ScenePoses { in_lidar_frame, scenes: [("s".to_owned(), poses)].into() }
    }

    #[test]
    fn origins_of_a_scene_lie_ahead_and_behind() {
        let close = |found: &Point3<f64>, expected: [f64; 3]| {
            assert!((found - Point3::from(expected)).norm() < 1e-12, "{found} {expected:?}");
        };
        let ego = poses(false).lidar_origins("s", "a").unwrap();
        close(&ego[0], [1.0, 0.0, 2.0]);
        close(&ego[1], [11.0, 0.0, 2.0]);
        let lidar = poses(true).lidar_origins("s", "b").unwrap();
        close(&lidar[0], [-10.0, 0.0, 0.0]);
        close(&lidar[1], [0.0; 3]);
        assert_eq!(poses(false).lidar_origins("s", "c"), None);
    }
}
