//! The log that shown labels were made of.

use occlabel_core::{Fault, Keyframe, Pose, Scene};
use occlabel_logs::SceneSource;
use occlabel_pipeline::{Config, Rules};

use crate::args::{ConfigArgs, LogArgs};
use crate::exit::Stop;
use crate::input::{Stead, open, open_by};
use crate::shown_set::ShownSet;

/// A scene of labels as its log has it.
pub(crate) struct LoggedScene {
    pub(crate) source: Box<dyn SceneSource>,
    pub(crate) scene: Scene,
    /// What the log is read by.
    pub(crate) rules: Rules,
    /// Whether grids stand in the lidar's frame, not in the ego's.
    in_lidar_frame: bool,
}

impl LoggedScene {
    /// Opens the log and loads the scene. The log is read by the configuration that the labels were made
    /// by, if their manifest tells it and the command line names none.
    ///
    /// # Errors
    /// If the log cannot be opened, or does not have the scene.
    pub(crate) fn open(
        log: &LogArgs,
        config: &ConfigArgs,
        labels: &ShownSet,
        scene: &str,
    ) -> Result<Self, Stop> {
        let opened = match config_of(labels).filter(|_| config.is_empty()) {
            Some(made_by) => open_by(log, made_by, &Stead::default())?,
            None => open(log, config)?,
        };
        let scene = opened.source.load(scene)?;
        let in_lidar_frame = labels.set.frame() == "lidar";
        Ok(Self { source: opened.source, scene, rules: opened.rules, in_lidar_frame })
    }

    /// The keyframe of a token.
    ///
    /// # Errors
    /// If the log has no such keyframe.
    pub(crate) fn keyframe(&self, token: &str) -> Result<&Keyframe, Fault> {
        let found = self.scene.keyframes.iter().find(|keyframe| keyframe.token == token);
        found.ok_or_else(|| {
            let expected = "the keyframes of the labels";
            Fault::new("keyframe", &self.scene.name, expected, format!("no `{token}` in the log"))
        })
    }

    /// Where the grid of a keyframe stands.
    pub(crate) fn world_from_grid(&self, keyframe: &Keyframe) -> Pose {
        let reference = self.scene.reference_sweep(keyframe);
        match self.in_lidar_frame {
            true => reference.world_from_lidar(),
            false => reference.world_from_ego,
        }
    }
}

/// The configuration that a label tree of ours was made by.
fn config_of(labels: &ShownSet) -> Option<Config> {
    serde_json::from_value(labels.manifest.as_ref()?.config.clone()).ok()
}
