//! A label tree that is judged.

use std::path::Path;
use std::sync::Arc;

use occlabel_core::{Fault, GridSpec, Keyframe, VoxelGrid};
use occlabel_evaluate::JudgedLabels;
use occlabel_labels::{LabelArrays, LabelTree, Manifest, TreePath, read_evidence, read_labels};
use occlabel_pipeline::{Config, Rules};
use occlabel_simulate::Drive;

use crate::input::taxonomy_of;

/// A label tree, and the rules it was made by.
pub(crate) struct JudgedTree {
    /// The folder, as the user named it.
    pub(crate) name: String,
    pub(crate) manifest: Manifest,
    pub(crate) rules: Rules,
    tree: LabelTree,
}

/// The arrays of a keyframe.
pub(crate) struct JudgedArrays {
    labels: LabelArrays,
    flow: Option<VoxelGrid<[f32; 3]>>,
}

impl JudgedTree {
    /// Opens a tree by its manifest.
    pub(crate) fn open(folder: &Path) -> Result<Self, Fault> {
        let place = folder.join("manifest.json").display().to_string();
        let absent = || Fault::new("manifest", &place, "the manifest of a finished run", "none");
        let manifest = Manifest::load(&folder.join("manifest.json"))?.ok_or_else(absent)?;
        let config: Config = serde_json::from_value(manifest.config.clone()).map_err(|error| {
            Fault::new("manifest", &place, "a configuration", error.to_string()).record("config")
        })?;
        let (taxonomy, hash) = taxonomy_of(&config.taxonomy.file)?;
        if hash != manifest.taxonomy.hash {
            let expected = format!("the taxonomy of hash {}", manifest.taxonomy.hash);
            return Err(Fault::new("taxonomy", &config.taxonomy.file, expected, hash));
        }
        Ok(Self {
            name: folder.display().to_string(),
            rules: Rules::new(&config, Arc::new(taxonomy))?,
            tree: LabelTree::new(folder),
            manifest,
        })
    }

    /// The grid of every array.
    pub(crate) fn spec(&self) -> &GridSpec {
        &self.rules.spec
    }

    /// The tree's own token of a keyframe of the drive; none if it does not label it.
    pub(crate) fn token_of(&self, scene: &str, drive: &Drive, keyframe: &Keyframe) -> Option<&str> {
        let is_it = |token: &&String| {
            drive.keyframe(token).is_some_and(|known| known.time == keyframe.time)
        };
        self.manifest.scenes.get(scene)?.keyframes.iter().find(is_it).map(String::as_str)
    }

    /// Refuses tokens that are no keyframe of the drive.
    pub(crate) fn check_tokens(&self, scene: &str, drive: &Drive) -> Result<(), Fault> {
        let Some(record) = self.manifest.scenes.get(scene) else { return Ok(()) };
        match record.keyframes.iter().find(|token| drive.keyframe(token).is_none()) {
            None => Ok(()),
            Some(token) => {
                let expected =
                    format!("keyframes of the world `{scene}`, as its keyframe_hz has them");
                let fault = Fault::new("world-truth", &self.name, expected, format!("`{token}`"));
                Err(fault.hint("label with keyframes.source = \"annotated\""))
            }
        }
    }

    /// The labels of a keyframe, and its flow if the tree has evidence.
    pub(crate) fn read(&self, scene: &str, token: &str) -> Result<JudgedArrays, Fault> {
        let place = |path| self.tree.place(&path);
        let labels = read_labels(&place(TreePath::labels(scene, token)?), self.spec())?;
        let evidence = place(TreePath::evidence(scene, token)?);
        let flow = match evidence.exists() {
            true => Some(read_evidence(&evidence, self.spec())?.flow),
            false => None,
        };
        Ok(JudgedArrays { labels, flow })
    }
}

impl JudgedArrays {
    /// As the judge wants them.
    pub(crate) fn judged(&self) -> JudgedLabels<'_> {
        JudgedLabels {
            semantics: &self.labels.semantics,
            mask_lidar: &self.labels.mask_lidar,
            mask_camera: &self.labels.mask_camera,
            flow: self.flow.as_ref(),
        }
    }
}
