//! A folder of labelled keyframes.

use std::path::{Path, PathBuf};

use occlabel_core::{Fault, GridSpec, VoxelGrid};
use occlabel_labels::{LabelTree, Manifest, TreePath, read_labels};

use crate::{Class, ClassTable, KeyframeLabels};

/// A folder of labelled keyframes.
#[derive(Clone, Debug)]
pub struct LabelSet {
    root: PathBuf,
    classes: ClassTable,
    spec: GridSpec,
    frame: String,
    keyframes: Vec<KeyframeKey>,
}

/// A keyframe of a label set.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct KeyframeKey {
    /// Its scene; empty if the dialect's folders do not tell.
    pub scene: String,
    /// Its token.
    pub token: String,
}

impl LabelSet {
    /// Opens a folder, in the dialect of its manifest, or else the one it is said to be in.
    ///
    /// # Errors
    /// If there is no manifest.
    pub fn open(folder: &Path, dialect: Option<&str>) -> Result<Self, Fault> {
        let _ = dialect;
        let place = folder.join("manifest.json");
        let absent = || {
            Fault::new("manifest", place.display().to_string(), "a finished run's manifest", "none")
        };
        let manifest = Manifest::load(&place)?.ok_or_else(absent)?;
        let keyframes = manifest.scenes.iter().flat_map(|(scene, record)| {
            let key = |token: &String| KeyframeKey { scene: scene.clone(), token: token.clone() };
            record.keyframes.iter().map(key)
        });
        Ok(Self {
            root: folder.to_owned(),
            classes: classes_of(&manifest),
            spec: manifest.grid.spec()?,
            frame: manifest.grid.frame.clone(),
            keyframes: keyframes.collect(),
        })
    }

    /// The classes of `semantics`.
    pub fn classes(&self) -> &ClassTable {
        &self.classes
    }

    /// The grid of every keyframe.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The grid's frame: `ego` or `lidar`.
    pub fn frame(&self) -> &str {
        &self.frame
    }

    /// The keyframes, scene by scene.
    pub fn keyframes(&self) -> &[KeyframeKey] {
        &self.keyframes
    }

    /// The labels of a keyframe.
    ///
    /// # Errors
    /// If a file cannot be read, or holds what the dialect does not know.
    pub fn read(&self, key: &KeyframeKey) -> Result<KeyframeLabels, Fault> {
        let place = LabelTree::new(&self.root).place(&TreePath::labels(&key.scene, &key.token)?);
        let arrays = read_labels(&place, &self.spec)?;
        let index = |id: &u8| {
            self.classes.index_of(u16::from(*id)).ok_or_else(|| {
                let found = format!("{id} in {}", place.display());
                Fault::new("class-id", place.display().to_string(), "an id of the classes", found)
            })
        };
        let semantics = arrays.semantics.values().iter().map(index).collect::<Result<_, _>>()?;
        Ok(KeyframeLabels {
            spec: self.spec.clone(),
            semantics: VoxelGrid::from_values(&self.spec, semantics),
            mask_lidar: Some(arrays.mask_lidar),
            mask_camera: Some(arrays.mask_camera),
            instances: None,
            flow: None,
        })
    }
}

fn classes_of(manifest: &Manifest) -> ClassTable {
    let class = |record: &occlabel_labels::ClassRecord| Class {
        id: record.id,
        name: record.name.clone(),
        is_ignored: false,
        concept: None,
    };
    ClassTable {
        free: manifest.free,
        no_label: None,
        list: manifest.classes.iter().map(class).collect(),
    }
}
