//! What label files look like, told.

use std::path::{Path, PathBuf};

use occlabel_core::{Fault, GridSpec};
use occlabel_disk as disk;
use occlabel_labels::GridRecord;
use serde::Serialize;

use crate::describe::fit::Fit;
use crate::describe::{Examined, SeenArray, Sight, Suspicion, VoxelTally, suspicion};
use crate::{Dialect, LabelSet};

/// What label files look like, what they hold, and what is odd about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Description {
    /// The file or folder.
    pub place: String,
    /// The arrays of a file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrays: Vec<SeenArray>,
    /// The dialects that it may be in, the likeliest first.
    pub dialects: Vec<String>,
    /// What it holds, taken for the first of them.
    pub contents: Option<Contents>,
    /// What looks wrong.
    pub suspicions: Vec<Suspicion>,
    /// What the files cannot tell.
    pub notes: Vec<String>,
}

/// What label files hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contents {
    /// How many keyframes.
    pub keyframes: u64,
    /// Their grid, as far as the files and the dialect tell.
    pub grid: GridRecord,
    /// The id of free voxels.
    pub free: u16,
    /// The height at which most ground near the grid frame's origin lies, metres.
    pub ground_m: Option<f64>,
    /// All voxels.
    pub voxels: u64,
    /// Voxels by state.
    pub states: States,
    /// The classes that occur, by how many voxels they have.
    pub classes: Vec<ClassCount>,
}

/// Voxels by state; they add up to all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct States {
    /// Of a class.
    pub occupied: u64,
    /// Free: observed to be, where the files tell.
    pub free: u64,
    /// Labelled free, and not observed; `None` if the files do not tell.
    pub unobserved: Option<u64>,
    /// Without a label.
    pub no_label: u64,
}

/// A class that occurs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ClassCount {
    /// Its id in the files.
    pub id: u16,
    /// Its name.
    pub name: String,
    /// Its voxels.
    pub voxels: u64,
}

impl Description {
    /// A file, taken for the dialect that it is said to be in, or else the one that it looks like.
    ///
    /// # Errors
    /// If it cannot be read, or no dialect has that name.
    pub fn of_file(path: &Path, dialect: Option<&str>) -> Result<Self, Fault> {
        let sight = Sight::of(path)?;
        let likely = match dialect {
            Some(name) => vec![Dialect::named(name)?],
            None => Fit::best(path, &sight),
        };
        let place = path.display().to_string();
        let told = match (dialect, tree_of(path), likely.first()) {
            (None, Some((set, at)), _) => {
                let examined = Examined::of_keyframe(&set, at)?;
                Self::new(place, &[set.dialect().clone()], set.spec(), &examined)
            }
            (_, _, Some(first)) => {
                let places = |name: &str| beside(path, first, name);
                let spec = first.told_spec(&places)?;
                let examined = Examined::of(first, &places, &spec, 0)?;
                Self::new(place, &likely, &spec, &examined)
            }
            (_, _, None) => Self::unknown(place),
        };
        Ok(Self { arrays: sight.arrays, ..told })
    }

    /// All keyframes of a set, as they were examined.
    pub fn of_set(place: String, set: &LabelSet, examined: &Examined) -> Self {
        Self::new(place, &[set.dialect().clone()], set.spec(), examined)
    }

    /// What was examined as the first of some dialects.
    fn new(place: String, likely: &[Dialect], spec: &GridSpec, examined: &Examined) -> Self {
        let dialect = &likely[0];
        Self {
            place,
            arrays: Vec::new(),
            dialects: likely.iter().map(|dialect| dialect.name.clone()).collect(),
            contents: Some(Contents::of(dialect, spec, &examined.tally)),
            suspicions: suspicion::all(dialect, spec, examined),
            notes: notes(likely),
        }
    }

    /// A file that no dialect is like.
    fn unknown(place: String) -> Self {
        Self {
            place,
            arrays: Vec::new(),
            dialects: Vec::new(),
            contents: None,
            suspicions: Vec::new(),
            notes: vec!["the arrays are those of no dialect".to_owned()],
        }
    }
}

/// What files of these dialects cannot tell.
fn notes(likely: &[Dialect]) -> Vec<String> {
    let mut notes = Vec::new();
    if likely[0].unobserved == "none" {
        let name = &likely[0].name;
        notes.push(format!("unobserved-as-free: {name} does not tell what nobody observed"));
    }
    let is_other = |other: &&Dialect| other.layout.order() != likely[0].layout.order();
    if let Some(other) = likely.iter().find(is_other) {
        let name = &other.name;
        notes.push(format!("axes: {name} has other axes, and one file does not tell which it is"));
    }
    notes
}

/// Where another array of the keyframe of a file stands.
fn beside(path: &Path, dialect: &Dialect, name: &str) -> PathBuf {
    let pattern = dialect.layout.path().rsplit('/').next().unwrap_or_default();
    let semantics = dialect.layout.semantics_name();
    let (before, after) = pattern.split_once("{token}").unwrap_or((pattern, ""));
    let ending = after.replace("{name}", semantics);
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let token = file.strip_prefix(before).and_then(|rest| rest.strip_suffix(&ending));
    match token {
        Some(token) if pattern.contains("{name}") => {
            path.with_file_name(format!("{before}{token}{}", after.replace("{name}", name)))
        }
        _ => path.to_owned(),
    }
}

/// The tree with a manifest that a file belongs to, and which of its keyframes.
fn tree_of(path: &Path) -> Option<(LabelSet, usize)> {
    let path = disk::canonicalize(path).ok()?;
    let is_root = |folder: &&Path| disk::is_file(&folder.join("manifest.json"));
    let set = LabelSet::open(path.ancestors().skip(1).find(is_root)?, None).ok()?;
    let semantics = set.dialect().layout.semantics_name().to_owned();
    let is_it = |key: &crate::KeyframeKey| set.place(key, &semantics) == path;
    let at = set.keyframes().iter().position(is_it)?;
    Some((set, at))
}

impl Contents {
    fn of(dialect: &Dialect, spec: &GridSpec, tally: &VoxelTally) -> Self {
        let classes = &dialect.classes;
        let count = |(at, class): (usize, &crate::Class)| ClassCount {
            id: class.id,
            name: class.name.clone(),
            voxels: tally.by_index[at],
        };
        let mut counts: Vec<_> = classes.list.iter().enumerate().map(count).collect();
        counts.retain(|class| class.voxels > 0);
        counts.sort_by_key(|class| (std::cmp::Reverse(class.voxels), class.id));
        let unobserved = tally.lidar.map(|lidar| lidar.unobserved);
        Self {
            keyframes: tally.keyframes,
            grid: GridRecord::new(&dialect.grid.frame, spec),
            free: classes.free,
            ground_m: tally.ground.height_m(spec),
            voxels: tally.voxels,
            states: States {
                occupied: tally.occupied(classes),
                free: tally.free(classes) - unobserved.unwrap_or_default(),
                unobserved,
                no_label: tally.ignored(),
            },
            classes: counts,
        }
    }
}
