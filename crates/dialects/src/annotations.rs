//! `annotations.json`, which goes with the files of Occ3D-nuScenes: scenes, their keyframes one after
//! the other, and how the cameras see them.
//!
//! Source: README of the occupancy challenge of CVPR 2023, "folder structure". Cameras go by their
//! channels. A camera's `extrinsic` places it as it stood when it was exposed, in the ego frame of
//! the keyframe, which is also its `ego_pose`: the product of both is the camera's pose in world, as
//! in the published file.

use std::collections::BTreeMap;

use occlabel_core::{Exposure, Fault, Keyframe, Scene};
use occlabel_labels::{RigidRecord, TreePath};
use serde::{Deserialize, Serialize};

/// All scenes of a label set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Annotations {
    /// Scenes to train with.
    pub train_split: Vec<String>,
    /// Scenes to validate with.
    pub val_split: Vec<String>,
    /// Keyframes by scene and token.
    pub scene_infos: BTreeMap<String, BTreeMap<String, KeyframeInfo>>,
}

/// A keyframe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeyframeInfo {
    /// Its time, microseconds.
    pub timestamp: String,
    /// What each camera saw, by the camera's channel.
    pub camera_sensor: BTreeMap<String, CameraInfo>,
    /// `world_from_ego`.
    pub ego_pose: RigidRecord,
    /// Its labels, from the set's root.
    pub gt_path: String,
    /// The token of the next keyframe; empty if there is none.
    pub next: String,
    /// The token of the one before; empty if there is none.
    pub prev: String,
}

/// What a camera saw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraInfo {
    /// The image, from the log's root; empty where the log has it in a larger file.
    pub img_path: String,
    /// The pinhole's matrix; none of models that have no pinhole.
    pub intrinsic: Option<[[f64; 3]; 3]>,
    /// `ego_from_camera`.
    pub extrinsic: RigidRecord,
    /// `world_from_ego`.
    pub ego_pose: RigidRecord,
}

impl Annotations {
    /// The list of these scenes. All are to train with: a log does not say which are to validate with.
    pub fn of_scenes(scene_infos: BTreeMap<String, BTreeMap<String, KeyframeInfo>>) -> Self {
        let mut annotations = Self {
            train_split: scene_infos.keys().cloned().collect(),
            val_split: Vec::new(),
            scene_infos,
        };
        annotations.scene_infos.values_mut().for_each(link);
        annotations
    }
}

/// Names the next keyframe and the one before, by time.
fn link(infos: &mut BTreeMap<String, KeyframeInfo>) {
    let mut tokens: Vec<(i64, String)> = infos
        .iter()
        .map(|(token, info)| (info.timestamp.parse().unwrap_or(0), token.clone()))
        .collect();
    tokens.sort();
    for (at, (_, token)) in tokens.iter().enumerate() {
        let name = |at: Option<usize>| {
            at.and_then(|at| tokens.get(at)).map_or(String::new(), |(_, token)| token.clone())
        };
        if let Some(info) = infos.get_mut(token) {
            (info.next, info.prev) = (name(Some(at + 1)), name(at.checked_sub(1)));
        }
    }
}

/// The keyframes of a scene, not linked yet; `path` tells where their labels stand.
///
/// # Errors
/// If `path` gives one.
pub fn scene_infos(
    scene: &Scene,
    path: impl Fn(&str) -> Result<TreePath, Fault>,
) -> Result<BTreeMap<String, KeyframeInfo>, Fault> {
    let info = |keyframe: &Keyframe| {
        let (ego_pose, camera_sensor) = sensors(scene, keyframe);
        let info = KeyframeInfo {
            timestamp: (keyframe.time.0 / 1000).to_string(),
            camera_sensor,
            ego_pose,
            gt_path: path(&keyframe.token)?.as_str().to_owned(),
            next: String::new(),
            prev: String::new(),
        };
        Ok((keyframe.token.clone(), info))
    };
    scene.keyframes.iter().map(info).collect()
}

/// The ego's pose at a keyframe, and its cameras.
fn sensors(scene: &Scene, keyframe: &Keyframe) -> (RigidRecord, BTreeMap<String, CameraInfo>) {
    let world_from_ego = scene.reference_sweep(keyframe).world_from_ego;
    let ego_pose = RigidRecord::from(&world_from_ego);
    let info = |exposure: &Exposure| {
        let named = &scene.cameras[exposure.camera];
        let info = CameraInfo {
            img_path: exposure.image.clone().unwrap_or_default(),
            intrinsic: named.camera.model.intrinsics().map(|of| of.matrix()),
            extrinsic: (&(world_from_ego.inverse() * exposure.world_from_camera)).into(),
            ego_pose,
        };
        (named.name.clone(), info)
    };
    (ego_pose, keyframe.exposures.iter().map(info).collect())
}
