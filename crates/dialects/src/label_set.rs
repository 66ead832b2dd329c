//! A folder of labelled keyframes.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use occlabel_core::{Fault, GridSpec, VoxelGrid};
use occlabel_disk as disk;
use occlabel_labels::{Manifest, NpzFile};

use crate::decode::fault;
use crate::path_pattern::Filling;
use crate::{
    Class, ClassTable, Dialect, DialectGrid, KeyframeLabels, PathPattern, Wanted, guess, values,
};

/// A folder of labelled keyframes.
#[derive(Clone, Debug)]
pub struct LabelSet {
    root: PathBuf,
    dialect: Dialect,
    spec: GridSpec,
    keyframes: Vec<KeyframeKey>,
    /// The folder of each keyframe that the pattern calls `{split}`.
    splits: BTreeMap<KeyframeKey, String>,
    /// How many folders of the pattern lie above the root.
    start: usize,
    is_ours: bool,
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
    /// Opens a folder, in the dialect that it is said to be in, or else that of its manifest, or else
    /// the only one that its files fit.
    ///
    /// The root of a dialect's files may be given, or any folder below it that the dialect has a
    /// place for: `gts` will do for Occ3D.
    ///
    /// # Errors
    /// If no dialect has that name, there is no keyframe, or several dialects fit.
    pub fn open(folder: &Path, dialect: Option<&str>) -> Result<Self, Fault> {
        let manifest = Manifest::load_tree(folder)?;
        match (dialect, manifest) {
            (Some(name), manifest) => Self::in_dialect(folder, Dialect::named(name)?, manifest),
            (None, Some(manifest)) => Self::of_manifest(folder, &manifest),
            (None, None) => guess::only_one(folder),
        }
    }

    /// A tree of ours: its keyframes, grid and classes stand in its manifest.
    fn of_manifest(folder: &Path, manifest: &Manifest) -> Result<Self, Fault> {
        let keyframes = manifest.scenes.iter().flat_map(|(scene, record)| {
            let key = |token: &String| KeyframeKey { scene: scene.clone(), token: token.clone() };
            record.keyframes.iter().map(key)
        });
        let mut keyframes: Vec<_> = keyframes.collect();
        keyframes.sort();
        Ok(Self {
            root: folder.to_owned(),
            dialect: dialect_of(manifest)?,
            spec: manifest.grid.spec()?,
            keyframes,
            splits: BTreeMap::new(),
            start: 0,
            is_ours: true,
        })
    }

    /// The keyframes that a dialect finds in a folder.
    pub(crate) fn in_dialect(
        folder: &Path,
        dialect: Dialect,
        manifest: Option<Manifest>,
    ) -> Result<Self, Fault> {
        let absent = || {
            let expected = format!("files {}", dialect.layout.path());
            Fault::new("label-set", folder.display().to_string(), expected, "none")
        };
        let (start, found) = find(folder, &dialect, usize::MAX)?.ok_or_else(absent)?;
        let mut set = Self::of_found(folder, dialect, start, found)?;
        set.is_ours = manifest.is_some();
        match manifest {
            Some(manifest) => set.spec = manifest.grid.spec()?,
            None => set.adopt_told_spec()?,
        }
        Ok(set)
    }

    /// A set of found keyframes, with the published grid.
    pub(crate) fn of_found(
        folder: &Path,
        dialect: Dialect,
        start: usize,
        found: Vec<Filling>,
    ) -> Result<Self, Fault> {
        let mut splits = BTreeMap::new();
        for Filling { scene, token, split } in found {
            let key = KeyframeKey { scene, token };
            if let Some(other) = splits.insert(key.clone(), split.clone()) {
                let found = format!("scene `{}`, token `{}` there twice", key.scene, key.token);
                let fault =
                    Fault::new("label-set", folder.display().to_string(), "keyframes", found);
                return Err(fault.hint(format!("give one of the folders `{other}`, `{split}`")));
            }
        }
        Ok(Self {
            root: folder.to_owned(),
            spec: dialect.grid.spec()?,
            dialect,
            keyframes: splits.keys().cloned().collect(),
            splits,
            start,
            is_ours: false,
        })
    }

    /// Takes the grid that the first keyframe's file tells.
    pub(crate) fn adopt_told_spec(&mut self) -> Result<(), Fault> {
        let key = &self.keyframes[0];
        self.spec = self.dialect.told_spec(&|name| self.place(key, name))?;
        self.dialect.grid.voxel_size_m = self.spec.size_m().into();
        Ok(())
    }

    /// The dialect: its published name, this set's classes and grid.
    pub fn dialect(&self) -> &Dialect {
        &self.dialect
    }

    /// The classes of `semantics`.
    pub fn classes(&self) -> &ClassTable {
        &self.dialect.classes
    }

    /// The grid of every keyframe.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// The grid's frame: `ego` or `lidar`.
    pub fn frame(&self) -> &str {
        &self.dialect.grid.frame
    }

    /// The keyframes, by scene, then by token.
    pub fn keyframes(&self) -> &[KeyframeKey] {
        &self.keyframes
    }

    /// The classes and masks of a keyframe.
    ///
    /// # Errors
    /// If a file cannot be read, or holds what the dialect does not know.
    pub fn read(&self, key: &KeyframeKey) -> Result<KeyframeLabels, Fault> {
        self.read_with(key, &Wanted::default())
    }

    /// The labels of a keyframe. In our own trees, instances and flow are those of `evidence.npz`.
    ///
    /// # Errors
    /// If a file cannot be read, or holds what the dialect does not know.
    pub fn read_with(&self, key: &KeyframeKey, wanted: &Wanted) -> Result<KeyframeLabels, Fault> {
        let mut labels = self.dialect.decode(&|name| self.place(key, name), &self.spec, wanted)?;
        if self.is_ours && (wanted.instances || wanted.flow) && self.has_evidence(key) {
            self.add_evidence(&mut labels, &self.evidence(key), wanted)?;
        }
        Ok(labels)
    }

    /// Whether a keyframe of our own trees has its evidence beside it.
    pub fn has_evidence(&self, key: &KeyframeKey) -> bool {
        self.is_ours && disk::is_file(&self.evidence(key))
    }

    /// Where the file of an array stands; arrays that share a file have one place.
    pub fn place(&self, key: &KeyframeKey, array: &str) -> PathBuf {
        let filling = Filling {
            scene: key.scene.clone(),
            token: key.token.clone(),
            split: self.splits.get(key).cloned().unwrap_or_default(),
        };
        let pattern = PathPattern::new(self.dialect.layout.path(), array);
        pattern.from(self.start).place(&self.root, &filling)
    }

    /// Where the evidence of a keyframe stands, if it is there ([`LabelSet::has_evidence`]).
    pub fn evidence(&self, key: &KeyframeKey) -> PathBuf {
        self.place(key, "").with_file_name("evidence.npz")
    }

    fn add_evidence(
        &self,
        labels: &mut KeyframeLabels,
        place: &Path,
        wanted: &Wanted,
    ) -> Result<(), Fault> {
        let voxels = self.spec.len() as u64;
        let mut file = NpzFile::open(place, voxels * 64 + (1 << 20))?;
        let [x, y, z] = self.spec.shape();
        let mut array = |name: &str, bytes: u64, shape: &[usize]| {
            let read = file.array(name, voxels * bytes)?;
            read.filter(|array| array.shape == shape).ok_or_else(|| {
                fault(place, name, ("an array of the grid's shape", "none".to_owned()))
            })
        };
        if wanted.instances {
            let numbers = values::instances(&array("instances", 2, &[x, y, z])?);
            let numbers = numbers.map_err(|refusal| fault(place, "instances", refusal))?;
            labels.instances = Some(VoxelGrid::from_values(&self.spec, numbers));
        }
        if wanted.flow {
            let flow = values::flow(&array("flow", 12, &[x, y, z, 3])?, 3);
            labels.flow = Some(VoxelGrid::from_values(&self.spec, flow));
        }
        Ok(())
    }
}

/// The keyframes of a dialect in a folder, at most so many, from the first folder of its pattern on
/// that has any; and which one that is.
pub(crate) fn find(
    folder: &Path,
    dialect: &Dialect,
    most: usize,
) -> Result<Option<(usize, Vec<Filling>)>, Fault> {
    let layout = &dialect.layout;
    let pattern = PathPattern::new(layout.path(), layout.semantics_name());
    for start in 0..=pattern.folders() {
        let mut found = Vec::new();
        let outer = pattern.filling_of(folder, start)?;
        let inner = pattern.from(start);
        let _ = inner.walk(folder, &outer, layout.except(), &mut |filling| {
            found.push(filling);
            if found.len() < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        if !found.is_empty() {
            return Ok(Some((start, found)));
        }
    }
    Ok(None)
}

/// The dialect of a tree of ours: the one that its manifest names, with the manifest's grid, or the
/// layout of Occ3D-nuScenes with the manifest's classes.
fn dialect_of(manifest: &Manifest) -> Result<Dialect, Fault> {
    let record = &manifest.grid;
    let grid = DialectGrid {
        frame: record.frame.clone(),
        min_m: record.min_m,
        max_m: record.max_m,
        voxel_size_m: record.voxel_size_m,
    };
    if let Some(name) = &manifest.dialect {
        return Ok(Dialect { grid, ..Dialect::named(name)? });
    }
    let classes = classes_of(manifest);
    classes.check("manifest.json")?;
    Ok(Dialect {
        name: "occlabel".to_owned(),
        title: "occlabel".to_owned(),
        cannot_say: Vec::new(),
        grid,
        classes,
        ..Dialect::named("occ3d-nuscenes")?
    })
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
