//! A label tree that is judged.

use std::path::Path;
use std::sync::Arc;

use occlabel_core::{Fault, GridSpec, Keyframe, Timestamp, VoxelGrid};
use occlabel_disk as disk;
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
        let manifest = Manifest::load_tree(folder)?.ok_or_else(absent)?;
        let config: Config = serde_json::from_value(manifest.config.clone()).map_err(|error| {
            Fault::new("manifest", &place, "a configuration", error.to_string()).record("config")
        })?;
        let (taxonomy, hash) = taxonomy_of(&config.taxonomy.file)?;
        if hash != manifest.taxonomy.hash {
            let expected = format!("the taxonomy of hash {}", manifest.taxonomy.hash);
            return Err(Fault::new("taxonomy", &config.taxonomy.file, expected, hash));
        }
        let mut rules = Rules::new(&config, Arc::new(taxonomy))?;
        // A pooled set stands in larger voxels than its configuration labelled.
        rules.spec = manifest.grid.spec()?;
        Ok(Self {
            name: folder.display().to_string(),
            rules,
            tree: LabelTree::new(folder),
            manifest,
        })
    }

    /// The grid of every array.
    pub(crate) fn spec(&self) -> &GridSpec {
        &self.rules.spec
    }

    /// The hash of the world that the scene's log was simulated in, if the tree knows it.
    pub(crate) fn world_hash(&self, scene: &str) -> Option<&str> {
        self.manifest.scenes.get(scene)?.world.as_deref()
    }

    /// The tree's own token of the keyframe at a time; none if it does not label it.
    pub(crate) fn token_at(&self, scene: &str, time: Timestamp) -> Option<&str> {
        let is_it = |token: &&String| Drive::time_of(token) == Some(time);
        self.manifest.scenes.get(scene)?.keyframes.iter().find(is_it).map(String::as_str)
    }

    /// The keyframes of a drive that the tree labels.
    pub(crate) fn keyframes(&self, scene: &str, drive: &Drive) -> Result<Vec<Keyframe>, Fault> {
        let record = self.manifest.scenes.get(scene);
        let tokens = record.iter().flat_map(|record| &record.keyframes);
        let keyframe = |token: &String| {
            drive.keyframe(token).ok_or_else(|| {
                let expected = format!("times of the reference lidar's sweeps in world `{scene}`");
                Fault::new("world-truth", &self.name, expected, format!("`{token}`"))
            })
        };
        tokens.map(keyframe).collect()
    }

    /// The labels of a keyframe, and its flow if the tree has evidence.
    pub(crate) fn read(&self, scene: &str, token: &str) -> Result<JudgedArrays, Fault> {
        let place = |path| self.tree.place(&path);
        let labels = read_labels(&place(TreePath::labels(scene, token)?), self.spec())?;
        let evidence = place(TreePath::evidence(scene, token)?);
        let flow = match disk::exists(&evidence) {
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
